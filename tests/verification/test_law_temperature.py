"""Temperature: tables, thermal strain, adiabatic heating. The table is synthetic: Ck 15 is known at one temperature.

The reference is the integration of the rate equations in conftest.py, with the temperature as one more of them.
"""

import math

import numpy as np
import pytest
import yaml

from coilset.model.core.base.errors import InputError
from coilset.model.core.material import library
from coilset.model.core.material.point import points
from coilset.model.physics.solid.points import MaterialPoints
from coilset.model.tools.identification import programs
from coilset.verification.references import heun

TEMPERATURES = (293.15, 393.15, 593.15)
CHANGES = (  # of Ck 15's constants, at the three temperatures
    {"alpha": 1.2e-5},
    {"alpha": 1.3e-5, "k0": 18000, "a1": 76000, "a5": 5.0, "G": 80000, "nu": 0.295, "kinf": 140000, "a": 0.001},
    {"alpha": 1.5e-5, "k0": 9000, "a1": 50000, "a5": 3.0, "G": 70000, "nu": 0.31, "kinf": 95000, "a": 0.0005},
)
DENSITY, SPECIFIC_HEAT, DISSIPATED = 7.85e-9, 1e8, 0.9  # a quarter of steel's specific heat, to make much of it
HEATING = DISSIPATED / (DENSITY * SPECIFIC_HEAT)  # K mm²/N: Ṫ = dissipated · ḃ* / (density · specific heat)
NAMES = {"k0": "k0_squared", "kinf": "k_inf_squared"}


@pytest.fixture
def material_file(tmp_path):
    """Writes the material file; `changes` of its top level."""

    def write(name="synthetic", **changes):
        content = yaml.safe_load((library.FOLDER / "ck15.yaml").read_text(encoding="utf-8"))
        first, content["temperatures"] = content["temperatures"][0], []
        for temperature, change in zip(TEMPERATURES, CHANGES, strict=True):
            entry = yaml.safe_load(yaml.safe_dump(first))
            entry["temperature"] = temperature
            sections = [*entry.values(), entry["isotropic"]["saturation"]]
            for key, value in change.items():
                key = NAMES.get(key, key)
                section = next((s for s in sections if isinstance(s, dict) and key in s), entry["elasticity"])
                section[key] = value
            k = entry["isotropic"]
            b1 = k["saturation"]["b1"]
            k1 = k["k0_squared"] + k["a1"] * (1 + k["a2"] * b1 - math.exp(-k["a3"] * b1))
            k["saturation"]["k1_squared"] = k1
            content["temperatures"].append(entry)
        path = tmp_path / f"{name}.yaml"
        path.write_text(yaml.safe_dump(content | changes), encoding="utf-8")
        return path

    return write


HEAT = {"dissipated": DISSIPATED, "density": DENSITY, "specific_heat": SPECIFIC_HEAT}
ROD_PATHS = {
    "tension": [(0.12, 0, 0)],
    "reversed torsion": [(0, 0.10, 0), (0, -0.12, 0)],
    "tension, torsion": [(0.05, 0, 0), (0.01, 0.08, -0.02)],
}
SOLID_PATH = np.random.default_rng(4).normal(size=(3, 6)) * 0.03


@pytest.fixture
def reference_of(reference):
    def make(heating, **options):
        materials = [reference.ck15(**change) for change in CHANGES]
        return reference.Reference(reference.table(TEMPERATURES, materials, heating), **options)

    return make


def follow(law, path, integrator, n, warming=None, **tolerance):
    """States at the end of every segment, n increments each; `warming` as in the reference."""
    path = np.array(path, float)
    state, states = points.initial_state(law, 1, path.shape[1]), []
    temperature = law.reference_temperature
    for i, segment in enumerate(path):
        step = warming[i] / n if warming else 0.0
        for _ in range(n):
            at = (temperature, temperature + step) if warming else None
            state, _, _ = heun.UPDATES[integrator](law, state, segment[None] / n, at, **tolerance)
            temperature += step
        states.append(state[0])
    return np.array(states)


def error(law, states, exact, reference):
    """Maximum difference of a stress component over the flow stress."""
    components = (states.shape[1] - 1) // 2
    held = [0, 3, 4] if components == 3 else range(6)
    flow = np.sqrt([1.5 * reference.k2(y) for y in exact])
    return (np.abs(states[:, :components] - exact[:, held]).max(axis=1) / flow).max()


def test_points_of_a_solid_begin_at_its_temperature(material_file):
    law, warm = library.load(material_file(heating=HEAT)), TEMPERATURES[0] + 20.0
    assert MaterialPoints(law, warm).initial_state(3)[:, -1] == pytest.approx(warm)


@pytest.mark.parametrize("name", [*ROD_PATHS, "full stress state"])
def test_adiabatic_heating(name, material_file, reference_of):
    """Heated by 34 to 59 K: stress and temperature; Heun within 1e-4, the point problem of second order in the rod.

    The moduli are those of the increment's start, which makes the pressure one of first order in the full form.
    """
    law = library.load(material_file(heating=HEAT), spin=False)
    path, rod = (ROD_PATHS[name], True) if name in ROD_PATHS else (SOLID_PATH, False)
    reference = reference_of(HEATING, rod=rod)
    exact = reference.path(path)
    assert exact[-1, 13] - TEMPERATURES[0] > 30
    heuns = follow(law, path, "heun", 300)
    assert error(law, heuns[:, :-1], exact, reference) < 1e-4
    np.testing.assert_allclose(heuns[:, -1], exact[:, 13], atol=0.02)
    np.testing.assert_allclose(heuns[:, -1] - TEMPERATURES[0], HEATING * heuns[:, -2], rtol=1e-10)
    mapped = [follow(law, path, "return_mapping", n) for n in (200, 400)]
    coarse, fine = (error(law, states[:, :-1], exact, reference) for states in mapped)
    assert fine < (2e-5 if rod else 2e-4)
    assert coarse / fine == (pytest.approx(4, abs=0.6) if rod else pytest.approx(2, rel=0.05))
    np.testing.assert_allclose(mapped[1][:, -1] - TEMPERATURES[0], HEATING * mapped[1][:, -2], rtol=1e-10)


def test_the_digest_of_a_material_knows_its_heat_capacity_and_its_validity(material_file):
    """With half of the density, and of the part that becomes heat, a point warms as before, but conducts faster."""
    half = {**HEAT, "dissipated": 0.5 * DISSIPATED, "density": 0.5 * DENSITY}
    other = {"plastic_work": 50.0, "remark": "as far as the tests went"}
    laws = [library.load(material_file(**more)) for more in ({"heating": HEAT}, {"heating": half})]
    assert laws[0].parameters().tobytes() == laws[1].parameters().tobytes()
    laws += [library.load(material_file(heating=HEAT, validity=other))]
    assert len({law.content() for law in laws}) == 3


def test_heating_matters(material_file):
    """The flow stress after adiabatic tension is lower than after isothermal tension, by the table's softening."""
    hot, cold = (library.load(material_file(**more), spin=False) for more in ({"heating": HEAT}, {}))
    path = ROD_PATHS["tension"]
    warm, same = follow(hot, path, "heun", 200)[-1], follow(cold, path, "heun", 200)[-1]
    flow = np.sqrt(1.5 * hot.functions(warm[6], warm[7])[0]) / np.sqrt(1.5 * hot.functions(same[6])[0])
    assert warm[0] / same[0] == pytest.approx(flow, rel=0.02)
    assert flow < 0.97


@pytest.mark.parametrize("name", [*ROD_PATHS, "full stress state"])
def test_prescribed_temperature(name, material_file, reference_of):
    """Strain and temperature together, through a knee of the table and back: at least of second order."""
    law = library.load(material_file(), spin=False)
    path, rod = (ROD_PATHS[name], True) if name in ROD_PATHS else (SOLID_PATH, False)
    warming = [250.0, -150.0, 60.0][: len(path)]
    reference = reference_of(0.0, rod=rod)
    exact = reference.path(path, warming=warming)
    assert error(law, follow(law, path, "heun", 300, warming), exact, reference) < 1e-4
    coarse, fine = (error(law, follow(law, path, "return_mapping", n, warming), exact, reference) for n in (200, 400))
    assert fine < 2e-5
    assert coarse / fine > 3.0


@pytest.mark.parametrize("integrator", heun.UPDATES)
def test_heating_a_held_rod(integrator, material_file, reference_of):
    """A rod held at both ends and heated by 200 K: compression by thermal strain, then yielding of the hot rod."""
    law = library.load(material_file(), spin=False)
    reference = reference_of(0.0)
    exact = reference.path([(0, 0, 0)] * 4, warming=[40.0, 40.0, 60.0, 60.0])
    elastic, yielded = exact[0], exact[-1]
    # Elastic: ∫E α dT with both linear over 40 K of the table's first 100 K.
    E = np.interp([0, 20, 40], [0, 100], [law.E, 2 * 80000 * 1.295])
    alpha = np.interp([0, 20, 40], [0, 100], [1.2e-5, 1.3e-5])
    assert elastic[0] == pytest.approx(-40 / 6 * (E * alpha) @ [1, 4, 1], rel=1e-9)
    assert yielded[12] > 0.05
    states = follow(law, [(0, 0, 0)] * 4, integrator, 200, [40.0, 40.0, 60.0, 60.0])
    assert error(law, states, exact, reference) < (2e-3 if integrator == "return_mapping" else 1e-4)


@pytest.mark.parametrize("integrator", heun.UPDATES)
def test_free_thermal_strain(integrator, material_file):
    """Nothing holds the point: the strain is ∫α dT of the table's trapezoids, no stress, no plastic work."""
    law = library.load(material_file())
    for form, normal in (("rod", 1), ("solid", 3)):
        steps = [{"temperature": 393.15, "increments": 5}, {"temperature": 593.15, "increments": 10}]
        program = programs.Program.model_validate({"name": "free", "form": form, "steps": steps})
        history = heun.RUNS[integrator](law, program)
        expected = 100 * 0.5 * (1.2e-5 + 1.3e-5) + 200 * 0.5 * (1.3e-5 + 1.5e-5)
        np.testing.assert_allclose(history.strain[-1, :normal], expected, rtol=1e-9)
        np.testing.assert_allclose(history.strain[-1, normal:], 0, atol=1e-12)
        np.testing.assert_allclose(history.stress, 0, atol=1e-9)
        assert history.work[-1] == 0
        assert history.temperature[-1] == 593.15


def test_the_tables_own_temperatures_are_met(material_file):
    """At a temperature of the table the law is that of a file with this one alone; elsewhere it lies between."""
    path = material_file()
    law = library.load(path)
    content = yaml.safe_load(path.read_text(encoding="utf-8"))
    D = np.array([[0.01, 0.02, 0.005]])
    stress = []
    for entry in content["temperatures"]:
        alone = path.with_name("alone.yaml")
        alone.write_text(yaml.safe_dump(content | {"temperatures": [entry]}), encoding="utf-8")
        single = library.load(alone)
        expected = points.update(single, points.initial_state(single, 1), D)[0]
        stress.append(expected[0, 1])
        got = points.update(law, points.initial_state(law, 1), D, temperature=entry["temperature"])[0]
        np.testing.assert_allclose(got, expected, rtol=1e-12)
    between = points.update(law, points.initial_state(law, 1), D, temperature=343.15)[0]
    assert stress[1] < between[0, 1] < stress[0]


@pytest.mark.parametrize("components", [3, 6])
@pytest.mark.parametrize("temperature", [None, (380.0, 350.0), (350.0, 450.0)])
def test_tangent(components, temperature, material_file):
    """Taylor test, adiabatic, cooled and heated: the second-order rest falls a hundredfold with a tenth of the step."""
    law = library.load(material_file(**({} if temperature else {"heating": HEAT})))
    rng = np.random.default_rng(3)
    state = points.initial_state(law, 30, components)
    for _ in range(3):
        state, _, count = points.update(law, state, rng.normal(size=(30, components)) * 4e-3)
    D = rng.normal(size=(30, components)) * 4e-3
    v = rng.normal(size=(30, components)) * 4e-3
    new, C, count = points.update(law, state, D, temperature=temperature)
    assert (count > 0).sum() > 25
    rests = []
    for h in (1e-2, 1e-3):
        moved = points.update(law, state, D + h * v, temperature=temperature)[0]
        rest = moved[:, :components] - new[:, :components] - h * np.einsum("pij,pj->pi", C, v)
        rests.append(np.linalg.norm(rest, axis=1))
    slopes = np.log10(rests[0] / rests[1])[count > 0]
    assert np.median(slopes) == pytest.approx(2, abs=0.02)
    assert (slopes > 1.8).all()


def test_too_hot(material_file):
    """Plastic work that heats the point out of the table is refused, by both integrators; so is a program's target."""
    law = library.load(material_file(heating=HEAT | {"specific_heat": 1e7}))
    steps = [{"to": {"eps11": 0.2}, "increments": 20}]
    for integrator in heun.UPDATES:
        with pytest.raises(InputError, match=r"plastic work heats the point out of the table of 293\.15 to 593\.15 K"):
            heun.RUNS[integrator](law, programs.Program.model_validate({"name": "hot", "steps": steps}))
    law = library.load(material_file())
    with pytest.raises(InputError, match=r"700 K is outside the table of 'ck15', known for 293.15 to 593.15 K"):
        points.update(law, points.initial_state(law, 1), np.zeros((1, 3)), temperature=700)
    with pytest.raises(InputError, match="outside the table"):
        points.update(law, points.initial_state(law, 1), np.zeros((1, 3)), temperature=(300, 700))


def test_program_starts_hot(material_file):
    """Hot tension: the first yield stress is that of the table at 593.15 K, sqrt(1.5 · 9000)."""
    law = library.load(material_file())
    steps = [{"to": {"eps11": 1.1e-3}, "increments": 110}]
    program = programs.Program.model_validate({"name": "hot", "temperature": 593.15, "steps": steps})
    history = programs.run(law, program)
    first = np.flatnonzero(history.work > 0)[0]
    assert history.stress[first - 1, 0] < math.sqrt(1.5 * 9000) * (1 + 1e-9)
    assert history.stress[first, 0] == pytest.approx(math.sqrt(1.5 * 9000), rel=0.02)
    assert (history.temperature == 593.15).all()


def test_a_rod_starts_at_the_reference_temperature(make_rod, material_file):
    """The rod's history rows of a material that heats itself hold its first temperature, and nothing else."""
    rod = make_rod([[0, 0, 0], [10, 0, 0], [20, 0, 0]], law=library.load(material_file(heating=HEAT)))
    assert rod.point_state.shape[-1] == 8
    assert (rod.point_state[..., 7] == TEMPERATURES[0]).all()
    assert (rod.point_state[..., :7] == 0).all()
