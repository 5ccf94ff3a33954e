"""Springs of any shape, solved: rates and characteristics against closed formulas, and round trips through files."""

import numpy as np
import pytest
from mpi4py import MPI

from coilset.meshes.drawings.export import write_mesh
from coilset.meshes.measured.measured import MeasuredSpec
from coilset.meshes.springs.spring import SpringSpec
from coilset.model.compose.analysis import Analysis
from coilset.model.core.case import check
from coilset.model.core.material import library
from coilset.verification.spring_references import progressive, representation
from coilset.verification.spring_references.curved_rod import clamped_rate

CURVED = "curved"


@pytest.fixture(scope="module")
def law():
    return library.load("ck15")


def test_sections_on_the_curved_axis_reach_the_rate(tmp_path):
    """The inscribed polygon is 3.5 % too stiff at 16 elements a turn, sections on the axis less than 0.3 %.

    A chord over the angle 2α lies R cos α from the axis; its length is 2 R sin α. Torque F R cos α, and bending F s at
    the distance s from its middle, store the energy of its arc times q sinc α, q = cos² α + sin² α/(3 (1 + ν)), for
    G I_p/E I = 1/(1 + ν). Stretched to the arc's length, the polygon is larger by 1/sinc α and softer by its cube.
    """
    errors = representation.study()
    representation.figure(errors, tmp_path / "representation.png")
    sixteen, α, nu = representation.ELEMENTS.index(16), np.pi / 16, library.load("ck15").nu
    q, sinc = np.cos(α) ** 2 + np.sin(α) ** 2 / (3 * (1 + nu)), np.sin(α) / α
    for by_key in errors.values():
        assert by_key["points"][sixteen] == pytest.approx(1 / (q * sinc) - 1, abs=3e-4)
        assert by_key["length"][sixteen] == pytest.approx(sinc**2 / q - 1, abs=3e-4)
        assert abs(by_key["compliance"][sixteen]) < 3e-4
        assert abs(by_key[CURVED][sixteen]) < 3e-5
        for key in ("points", "length", CURVED):
            orders = np.log2(by_key[key][1:-1] / by_key[key][2:])
            np.testing.assert_allclose(orders, 2, atol=0.05)


def test_plastic_force_and_set_need_few_elements_on_the_curved_axis():
    """10 mm down and released: 16 elements a turn against 64, in force and set; plane sections, which chords have."""

    def force_and_set(per_turn, axis):
        case = {
            "spring": {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 2.5, "pitch": 12.0},
            "ends": "clamped",
            "accuracy": "none",
            "mesh": {"elements_per_turn": per_turn, "axis": axis, "section": {"kind": "plane"}},
            "loading": [{"to": {"travel": 10}, "steps": 10}, {"to": {"force": 0}, "steps": 2}],
        }
        steps = Analysis(check(case), MPI.COMM_SELF).run().steps
        return np.array([steps[9].force_N, steps[-1].travel_mm])

    fine = force_and_set(64, CURVED)
    np.testing.assert_allclose(force_and_set(16, CURVED), fine, rtol=2e-4)
    # the inscribed polygon: 1.7 % in force, 1.3 % in set
    assert np.all(force_and_set(16, "chords") / fine - 1 > 0.01)


def test_conical_spring_meets_the_closed_formula(law):
    # Wahl, Mechanical Springs, conical springs: R = G d⁴/(16 n (r1 + r2)(r1² + r2²)); it leaves out pitch, bending and
    # shear, so the cone is slender (D/d from 10 to 20) with small pitch, and long enough for the heads not to matter
    r1, r2, n, d = 30.0, 15.0, 10.0, 3.0
    cone = SpringSpec(
        wire_diameter=d, mean_diameter={"shape": "cone", "bottom": 2 * r1, "top": 2 * r2}, turns=n, pitch=7.0
    ).build()
    rate = representation.rate(cone, cone.stations(16), CURVED, law)
    assert rate == pytest.approx(law.G * d**4 / (16 * n * (r1 + r2) * (r1**2 + r2**2)), rel=0.01)
    # and the curved rod with bending, shear and heads much closer
    assert rate == pytest.approx(clamped_rate(cone, law.E, law.G), rel=1e-4)


@pytest.mark.parametrize(
    ("name", "within"),
    [
        # the formula closes a coil at once, a seat from its tip on: 2.2 % where the first coil lies down; 0.5 %; 1.7 %
        ("telescoping cone on a seat", 0.03),
        ("barrel", 0.01),
        ("variable pitch", 0.02),
    ],
)
def test_progressive_springs(name, within):
    found = progressive.solve(name)
    assert found.work == 0.0  # elastic, so that the formula holds
    np.testing.assert_allclose(found.travel, found.formula, rtol=within)
    # stiffer in the end by the formula's ratio, which is 3.05, 2.79 and 2.30; 1.3, 3.0 and 0.7 % are found
    by_formula = np.diff(found.force, prepend=0.0) / np.diff(found.formula, prepend=0.0)
    assert found.rates[-1] / found.rates[0] == pytest.approx(by_formula[-1] / by_formula[0], rel=0.04)
    # stiffer from step to step, but for the first coil's lying down
    assert np.all(np.diff(found.rates) > -0.02 * found.rates[:-1])


@pytest.mark.parametrize("suffix", [".msh", ".vtu"])
def test_round_trip_keeps_the_rate(law, tmp_path, suffix):
    ends = {"form": "closed and ground"}
    drawn = SpringSpec(
        wire_diameter=4.0,
        mean_diameter={"shape": "barrel", "ends": 30.0, "middle": 44.0},
        turns=7.25,
        free_length=90.0,
        hand="left",
        end_coils=ends,
    ).build()
    write_mesh(drawn, drawn.stations(16), tmp_path / f"spring{suffix}")
    measured = MeasuredSpec(file=str(tmp_path / f"spring{suffix}"), end_coils=ends).build()
    rates = [representation.rate(spring, spring.stations(16), CURVED, law) for spring in (drawn, measured)]
    assert rates[1] == pytest.approx(rates[0], rel=1e-3)  # measured: 2.5e-9


@pytest.mark.parametrize("hand", ["right", "left"])
def test_hand_does_not_change_the_rate(law, hand):
    spring = SpringSpec(wire_diameter=5.0, mean_diameter=40.0, turns=2.5, pitch=12.0, hand=hand).build()
    assert representation.rate(spring, spring.stations(16), CURVED, law) == pytest.approx(
        clamped_rate(spring, law.E, law.G), rel=2e-5
    )
