"""Extension springs: F0 + R s once open, the step of the rate, and the set of a wire in torsion."""

import numpy as np
import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.summary import summarise
from coilset.model.core.base.errors import InputError
from coilset.model.core.case import check, read_case
from coilset.model.physics.uniform_coil.estimate import estimate
from coilset.model.tools.sheet.case_sheet import case_sheet
from coilset.model.tools.sheet.rows import sections
from coilset.model.tools.standards import en13906
from coilset.verification.spring_references.coil_by_coil import shear_curve

WIRE, MEAN, TURNS, TENSION = 3.0, 30.0, 8.0, 25.0
SPRING = {"wire_diameter": WIRE, "mean_diameter": MEAN, "turns": TURNS, "initial_tension": TENSION}
MESH = {"elements_per_turn": 12, "section": {"radial": 4, "angular": 12}}
PULLED = [{"to": {"force": -force}, "steps": 1} for force in (5, 20, 30, 45, 60)]


def data(loading, **entries):
    common = {"spring": SPRING, "material": "elastic", "ends": "clamped", "mesh": MESH, "loading": loading}
    return common | {"accuracy": "none"} | entries


def solved(loading, **entries):
    analysis = Analysis(check(data(loading, **entries)), MPI.COMM_SELF)
    return analysis, summarise(analysis.setup, analysis.run())


@pytest.mark.parametrize("hand", ["right", "left"])
def test_force_and_travel_of_an_elastic_spring(hand):
    """F0 + R s within 1 % of the force at 30, 45 and 60 N; closed coils are more than a hundred times as stiff."""
    loading = [*PULLED, {"to": {"force": 0}, "steps": 4}]
    analysis, summary = solved(loading, spring=SPRING | {"hand": hand})
    R = en13906.rate(analysis.law.G, WIRE, MEAN, TURNS)
    steps = analysis.result.steps
    travel, force = (-np.array([getattr(step, name) for step in steps]) for name in ("travel_mm", "force_N"))
    np.testing.assert_allclose(force[2:5], TENSION + R * travel[2:5], rtol=0.01)
    assert (force[1] - force[0]) / (travel[1] - travel[0]) > 100.0 * R
    assert (force[4] - force[3]) / (travel[4] - travel[3]) == pytest.approx(R, rel=0.01)
    assert [step.contacts > 0 for step in steps[:5]] == [True, True, False, False, False]
    assert summary["initial_tension_after_N"] == pytest.approx(TENSION, rel=0.01)
    assert abs(summary["set_mm"]) < 0.01 * WIRE  # by which coils under F0 sink into each other from the drawing


@pytest.mark.parametrize(("steps", "said"), [(1, "cannot be determined"), (2, "has no known error"), (4, None)])
def test_too_few_open_steps_have_a_warning(steps, said):
    analysis, summary = solved([{"to": {"force": -60}, "steps": steps}])
    analysis.recorder.end(analysis.result)
    warnings = [one["message"] for one in summarise(analysis.setup, analysis.result)["warnings"]]
    found = [one for one in warnings if "initial tension" in one]
    assert [said in one for one in found] == [True] * (said is not None)
    assert (summary["initial_tension_N"] is None) == (steps == 1)


def test_the_set_is_that_of_a_wire_in_torsion(ck15):
    """Beyond yield, by the law's curve in shear: s(F) = n 2π r² (κ(F) − κ(F0)), then elastic; 2 % are asked for."""
    loading = [{"to": {"force": -52}, "steps": 12}, {"to": {"force": 0}, "steps": 2}]
    analysis, summary = solved(loading, material="ck15")
    shear, stress = shear_curve(ck15)
    x, w = np.polynomial.legendre.leggauss(40)
    x, w, a, r = 0.5 * (x + 1), 0.5 * w, 0.5 * WIRE, 0.5 * MEAN
    torque = a**3 * 2 * np.pi * np.interp(np.outer(shear, x), shear, stress) @ (w * x**2)
    twist = np.interp([52.0 * r, TENSION * r], torque, shear / a)
    extension = TURNS * 2 * np.pi * r**2 * (twist[0] - twist[1])
    expected = extension - (52.0 - TENSION) / en13906.rate(ck15.G, WIRE, MEAN, TURNS)
    pulled = analysis.result.steps[11]
    assert -pulled.travel_mm == pytest.approx(extension, rel=0.02)
    left = -summary["set_mm"]
    closed = TENSION / en13906.rate(ck15.G, WIRE, MEAN, TURNS)
    assert left == pytest.approx(expected - closed, rel=0.03)
    assert summary["initial_tension_after_N"] == 0.0
    assert summary["residual_shear_inside_MPa"] > 0.0  # against the pull


def test_a_restart_goes_on_to_the_same_bits(resumed_after):
    program = check(data([{"to": {"force": -40}, "steps": 3}]))
    whole = Analysis(program, MPI.COMM_SELF)
    whole.run()
    resumed = resumed_after(program, 1)
    resumed.run()
    assert resumed.result.steps == whole.result.steps


def test_the_sheet_has_the_formulas_of_part_2():
    case = check(data([{"to": {"travel": -20}, "steps": 1}]))
    made = case_sheet(case, case.spring.build(), None)
    (_, _), (title, rows) = sections(made)
    found = {row.label.strip(): row.value for row in rows}
    assert "13906-2" in title
    assert found["force at 47 mm"] == pytest.approx(TENSION + 20.0 * made.rate)
    assert found["stress τ0"] == pytest.approx(8 * MEAN * TENSION / (np.pi * WIRE**3))


def test_force_and_set_by_the_uniform_rod_have_the_sign_of_a_pull(ck15):
    """Else a design searches on the wrong side."""
    case = check(data([{"to": {"travel": -40}}, {"to": {"force": 0}}], material="ck15"))
    numbers = estimate(case, case.spring.build(), ck15).numbers
    assert max(numbers["force_max_N"], numbers["set_mm"]) < -1.0


@pytest.mark.parametrize(
    ("entries", "words"),
    [
        ({"ends": "seats"}, "give ends: clamped"),
        ({"spring": SPRING | {"pitch": 3.5}}, "leave pitch"),
        ({"spring": SPRING | {"end_coils": "closed"}}, "end_coils out"),
        ({"spring": SPRING | {"initial_tension": 0}}, "initial_tension"),
        ({"mesh": {"section": {"kind": "warping"}}}, "initial_tension needs sections of fibres"),
    ],
)
def test_wrong_combinations_are_refused_in_one_line(entries, words):
    with pytest.raises(InputError, match=words) as error:
        check(data(PULLED, **entries))
    assert "\n" not in str(error.value)


def test_the_example_loses_part_of_its_tension(example):
    settings = ["loading.1.steps=8", "loading.2.steps=3", "mesh.elements_per_turn=10", "mesh.section.radial=4"]
    case = read_case(example.parent / "springs" / "extension.yaml", [*settings, "mesh.section.angular=12"])
    analysis = Analysis(case, MPI.COMM_SELF, estimates=False)
    summary = summarise(analysis.setup, analysis.run())
    assert 0.0 < summary["initial_tension_after_N"] < 0.9 * summary["initial_tension_N"]
