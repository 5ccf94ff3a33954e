"""The estimated hardening of a wire: the tensile test of its law gives back the numbers it was made from."""

import numpy as np
import pytest

from coilset.model.core.base.errors import InputError
from coilset.model.core.case import check
from coilset.model.core.case.material import case_law
from coilset.model.core.material.point.points import initial_state, update
from coilset.model.tools.sweep.keys import Keys
from coilset.model.tools.wires import wire
from coilset.model.tools.wires.law import wire_law


def tensile_test(law, strain_end=0.04, steps=4000):
    """Logarithmic plastic strain and test stress of a rod point that is pulled, by the return mapping."""
    state, rows = initial_state(law, 1), []
    increment = np.array([[strain_end / steps, 0.0, 0.0]])
    for step in range(1, steps + 1):
        state = update(law, state, increment)[0]
        stress = state[0, 0]
        plastic = step * strain_end / steps - stress / law.E
        # section: exp(−εp) by plastic strain, (1 − ν σ/E)² by elastic strain, written otherwise than in the curve
        rows.append((plastic, stress * np.exp(-plastic) * (1 - law.nu * stress / law.E) ** 2))
    return np.array(rows).T


@pytest.mark.parametrize(("name", "diameter"), [("EN 10270-1 SH", 3.0), ("EN 10270-2 VDSiCr", 4.0)])
def test_tensile_test_of_the_law(name, diameter):
    law, known = wire_law(name, diameter), wire(name)
    plastic, stress = tensile_test(law)
    strength = known.strength(diameter)
    assert stress.max() == pytest.approx(strength, rel=1e-3)
    assert np.interp(0.002, plastic, stress) == pytest.approx(known.entry.proof_stress.value * strength, rel=1e-3)
    first = stress[plastic > 1e-9][0]
    assert first == pytest.approx(known.entry.elastic_limit.value * strength, rel=5e-3)


def test_validity_ends_with_the_uniform_strain():
    law = wire_law("EN 10270-1 DM", 2.0)
    plastic, stress = tensile_test(law)
    peak = stress.argmax()
    # ∫ σ dεp up to the maximum force, with the true stress σ = s exp(εp) (1 + …)
    true = stress[:peak] * np.exp(plastic[:peak]) / (1 - law.nu * stress[:peak] / law.E) ** 2
    assert law.data.validity.plastic_work == pytest.approx(np.trapezoid(true, plastic[:peak]), rel=2e-2)


def test_law_is_marked_as_an_estimate():
    law = wire_law("EN 10270-1 SH", 3.0)
    assert law.data.validity.remark.startswith("estimate")
    assert (law.G, round(law.E)) == (81500.0, 206000)
    assert law.name == "EN 10270-1 SH, 3 mm"


def test_stronger_wire_yields_later():
    assert wire_law("EN 10270-1 SH", 1.0).yield_stress > wire_law("EN 10270-1 SH", 5.0).yield_stress


SPRING = {"wire_diameter": 4.0, "mean_diameter": 32.0, "turns": 7.5, "free_length": 75.0, "end_coils": "closed"}


def case(material, **entries):
    return check({"spring": SPRING | entries, "material": material, "loading": [{"to": "block"}]})


def test_wire_of_a_case_takes_its_diameter_from_the_spring():
    for d in (4.0, 3.0):
        asked = case({"wire": "EN 10270-1 SH"}, wire_diameter=d)
        law = case_law(asked, asked.spring.build())
        assert law.name == f"EN 10270-1 SH, {d:g} mm"
        assert law.parameters().tolist() == wire_law("EN 10270-1 SH", d).parameters().tolist()
    named = case("ck15")
    assert case_law(named, named.spring.build()).name == "ck15"


def test_cases_of_a_sweep_are_distinguished_by_their_wires():
    keys = [Keys()(case(material)) for material in ({"wire": "EN 10270-1 SH"}, {"wire": "EN 10270-1 SM"}, "ck15")]
    assert len(set(keys)) == 3
    assert Keys()(case({"wire": "EN 10270-1 SH"})) == keys[0]


def test_wire_that_changes_its_diameter_has_no_law():
    table = {"turns": [0, 7.5], "values": [3.0, 5.0], "interpolation": "linear"}
    asked = case({"wire": "EN 10270-1 SH"}, wire_diameter=table)
    with pytest.raises(InputError, match="a wire of a standard has one diameter; this spring's goes from 3 to 5 mm"):
        case_law(asked, asked.spring.build())


def test_wrong_entry_of_a_wire():
    with pytest.raises(InputError, match=r"material\.wires: unknown entry; is wire meant\?"):
        case({"wires": "EN 10270-1 SH"})


def test_unknown_diameter_is_refused():
    with pytest.raises(InputError, match=r"is unknown at 30 mm; it is given for 0\.3 to 20 mm"):
        wire_law("EN 10270-1 SH", 30.0)


def test_a_warm_wire_is_softer_by_the_slope_of_its_standard_and_as_strong():
    """EN 10270-1: 0.25 ‰ per kelvin; at 393.15 K 2.5 % less, E as G."""
    cold, warm = wire_law("EN 10270-1 SH", 4.0), wire_law("EN 10270-1 SH", 4.0, temperature=393.15)
    assert pytest.approx(0.975 * cold.G) == warm.G
    assert pytest.approx(0.975 * cold.E) == warm.E
    assert warm.yield_stress == cold.yield_stress
    assert warm.reference_temperature == 393.15
    with pytest.raises(InputError, match=r"temperature: 500 K: the slope of G is used from 233.15 to 473.15 K only"):
        wire_law("EN 10270-1 SH", 4.0, temperature=500.0)
