"""Working lengths of the finished spring: they change nothing, and agree with a load program that goes there."""

import numpy as np
import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.summary import summarise
from coilset.model.core.base.errors import InputError
from coilset.model.core.case import check, read_case
from coilset.model.physics.uniform_coil.estimate import estimate
from coilset.model.physics.working.working import is_working_number, names_of
from coilset.model.tools.standards import en13906

MADE = ["mesh.elements_per_turn=8", "mesh.section.radial=3", "mesh.section.angular=8", "accuracy=none"]
PRESSED = "{to: {travel: 12}, steps: 6}, {to: {force: 0}, steps: 2}"


def run(example, loading, *settings):
    analysis = Analysis(read_case(example, [*MADE, f"loading=[{loading}]", *settings]), MPI.COMM_SELF)
    analysis.run()
    return analysis


@pytest.fixture(scope="module")
def there(example):
    return run(example, PRESSED, "working={lengths: [24, 26], forces: [60]}")


def test_they_change_nothing_of_the_run(example, there):
    alone = run(example, PRESSED)
    assert alone.result.steps == there.result.steps
    assert alone.continuation.number == there.continuation.number
    for name, field in alone.system.state.items():
        np.testing.assert_array_equal(field.equilibrium, there.system.state[name].equilibrium, name)


def test_a_load_program_that_goes_there_finds_the_same(example):
    """By its own phases, two steps each, between ends that are not let go; then the stresses from its snapshots."""
    there = run(example, PRESSED, "working={lengths: [24, 26], forces: [60]}", "release=held")
    found = summarise(there.setup, there.result)
    other = run(example, PRESSED + ", {to: {height: 26}, steps: 2}, {to: {height: 24}, steps: 2}")
    for height, snapshot in ((26, 3), (24, 4)):
        force = other.result.snapshots[snapshot].force
        assert found[f"force_at_{height}_N"] == pytest.approx(force, rel=1e-4)
        assert found[f"shear_at_{height}_MPa"] == pytest.approx(en13906.stress(force, 5.0, 40.0), rel=1e-4)
    entry = found["working"][0]
    inside = there.setup.inside.shear(other.result.snapshots[4].surface_state, there.rod.sections.components)
    here = np.abs(there.setup.section_turns - entry["shear_inside_turn"]) < 1e-12
    assert entry["shear_inside_MPa"] == pytest.approx(inside[here][0], rel=1e-3)
    assert entry["length_mm"] == pytest.approx(24.0)
    # between the two lengths, which it passed before, the spring is elastic: the rates are the slope
    slope = (found["force_at_24_N"] - found["force_at_26_N"]) / 2.0
    assert found["rate_at_26_N_per_mm"] == pytest.approx(slope, rel=0.05)
    assert found["rate_at_24_N_per_mm"] == pytest.approx(slope, rel=0.05)
    at_60 = np.interp(60.0, [found["force_at_26_N"], found["force_at_24_N"]], [26.0, 24.0])
    assert found["length_at_60_mm"] == pytest.approx(at_60, abs=0.2)
    assert abs(found["working_set_mm"]) < 1e-4 * 35.0


def test_the_force_at_a_length_has_the_whole_error_of_the_force_there(example):
    """That of the maximum force at the same height: most of it by few section points."""
    settings = [*MADE[:-1], f"loading=[{PRESSED}]", "ends=clamped", "release=held", "accuracy=50 %"]
    settings.append("working={lengths: [23, 26]}")
    analysis = Analysis(read_case(example, settings), MPI.COMM_SELF)
    analysis.run()
    found = summarise(analysis.setup, analysis.result)
    entry = found["working"][0]
    assert entry["force_N"] == pytest.approx(found["force_max_N"], rel=1e-3)
    assert entry["estimated_error"] == pytest.approx(found["estimated_force_error_N"], rel=0.5)
    mesh = found["estimated_errors"]["mesh"]["force_N"]
    assert entry["estimated_error"] > 3.0 * mesh


def test_a_length_beyond_the_presetting_flows_again_and_one_above_the_free_length_is_not_reached(example):
    analysis = run(example, "{to: {travel: 8}, steps: 4}, {to: {force: 0}, steps: 2}", "working={lengths: [34.9, 20]}")
    found = summarise(analysis.setup, analysis.result)
    assert found["set_mm"] > 0.2
    assert found["force_at_34.9_N"] is None
    assert "free" in found["working"][0]["reason"]
    assert found["working_set_mm"] > 1.0
    names = [warning["name"] for warning in found["warnings"]]
    assert {"working length", "working set"} <= set(names)


def test_the_uniform_rod_estimates_them(example, there):
    numbers = estimate(there.case, there.spring, there.law).numbers
    found = summarise(there.setup, there.result)
    assert numbers["force_at_24_N"] == pytest.approx(found["force_at_24_N"], rel=0.25)  # without ends and contact
    assert numbers["length_at_60_mm"] == pytest.approx(found["length_at_60_mm"], abs=1.0)


def test_names_say_the_length():
    names = names_of({"lengths": [47, 37.5], "forces": [250.0]})
    assert {"force_at_47_N", "safety_at_37.5", "length_at_250_mm"} <= set(names)
    assert all(is_working_number(name) for name in names)
    assert not is_working_number("force_at_47")
    assert not is_working_number("force_at_N")


@pytest.mark.parametrize(
    ("working", "place"),
    [
        ({"lengths": [9]}, "working.lengths.0"),
        ({"lengths": [20, 36]}, "working.lengths.1"),
        ({"forces": [-5]}, "working.forces.0"),
        ({}, "working"),
        ({"lengths": [20, 20.0]}, "working"),
    ],
)
def test_what_no_spring_can_have_is_refused(example, working, place):
    data = read_case(example).model_dump(mode="json") | {"working": working}
    with pytest.raises(InputError) as caught:
        Analysis(check(data), MPI.COMM_SELF)
    assert caught.value.place == place


ENDURANCE = {"torsion": 150.0, "bending": 250.0, "mean_stress_sensitivity": 0.3, "slope": 8.0, "source": "a test"}


def test_fatigue_is_that_of_the_stress_between_the_outermost_states(example):
    """At each point σ and τ of the surface alone; the residual stress is in both states and counts once."""
    made = "{" + ", ".join(f"{name}: {value}" for name, value in ENDURANCE.items()) + "}"
    analysis = run(example, PRESSED, "working={lengths: [26, 24]}", f"endurance={made}")
    found = summarise(analysis.setup, analysis.result)
    entries = {entry["criterion"]: entry for entry in found["fatigue"]}
    assert set(entries) == {"Haigh", "Smith-Watson-Topper", "Findley", "Dang Van"}
    # by hand: J₂ = σ²/3 + τ² of a bar's stress
    low, high = (one.snapshot.surface_state[..., :3] for one in analysis.result.working.states)
    mean, swing = 0.5 * (high + low), 0.5 * (high - low)
    measure = [np.sqrt(part[..., 0] ** 2 / 3.0 + part[..., 1] ** 2 + part[..., 2] ** 2) for part in (mean, swing)]
    beyond = 1.3 / 1.1 * (measure[1] + 0.1 * measure[0])
    loads = np.where(measure[0] <= measure[1], measure[1] + 0.3 * measure[0], beyond)
    top = entries["Haigh"]
    assert analysis.rod.sections.components[:3] == ("s11", "t12", "t13")
    assert top["amplitude_MPa"] == pytest.approx(loads.max(), rel=0.01)  # a parabola between the points
    there = np.isclose(analysis.setup.section_turns, top["turn"])  # halves of the spring are alike
    assert loads[there].max() == pytest.approx(loads.max(), rel=1e-6)
    assert top["safety"] == pytest.approx(150.0 / top["amplitude_MPa"])
    named = [warning for warning in found["warnings"] if warning["name"] == "fatigue"]
    assert len(named) == sum(entry["safety"] < 1.0 for entry in entries.values())
    for entry in entries.values():
        assert (entry["lives"] is None) == (entry["safety"] >= 1.0)


def test_endurance_needs_two_states(example):
    data = read_case(example).model_dump(mode="json") | {"endurance": ENDURANCE, "working": {"lengths": [20]}}
    with pytest.raises(InputError, match="two working states"):
        check(data)
