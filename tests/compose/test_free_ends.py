"""The finished spring: nothing holds it, so that no end has a reaction and no section a force but that of its coils."""

import math

import numpy as np
import pytest
from mpi4py import MPI
from scipy.spatial.transform import Rotation

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.summary import summarise
from coilset.model.core.case import check, read_case
from coilset.model.core.equilibrium.path.free_ends import mean_rotation, nearest_rotation
from coilset.model.core.results.files.checkpoint import Checkpoint
from coilset.model.physics.uniform_coil.rod import press

MADE = ["mesh.elements_per_turn=8", "mesh.section.radial=3", "mesh.section.angular=8", "accuracy=none"]
PRESSED = "{to: {travel: 16}, steps: 8}, {to: {force: 0}, steps: 3}"
TORSION = {
    "spring": {
        "wire_diameter": 2.0,
        "inner_diameter": 14.0,
        "turns": 4.25,
        "pitch": 2.6,
        "arms": {"bottom": {"length": 20.0}, "top": {"length": 20.0}},
    },
    "material": {"wire": "EN 10270-1 SH"},
    "ends": "clamped",
    "heads": {"top": {"sideways": "free"}},
    "mesh": {"elements_per_turn": 12, "section": {"radial": 4, "angular": 12}},
    "accuracy": "none",
    "loading": [
        {"to": {"force": 0, "top": {"turn": 160}}, "steps": 8},
        {"to": {"force": 0, "top": {"torque": 0}}, "steps": 3},
    ],
}
EXTENSION = {
    "spring": {
        "wire_diameter": 3.0,
        "mean_diameter": 24.0,
        "turns": 4,
        "initial_tension": 25.0,
        "hooks": {"bottom": {"shape": "german"}, "top": {"shape": "german"}},
    },
    "material": {"wire": "EN 10270-1 SH"},
    "ends": "clamped",
    "mesh": {"elements_per_turn": 12, "section": {"radial": 3, "angular": 8}},
    "accuracy": "none",
    "loading": [
        {"to": {"force": -20}, "steps": 2},
        {"to": {"travel": -25}, "steps": 10},
        {"to": {"force": 0}, "steps": 5},
    ],
}


def pressed(example, *settings, loading=PRESSED):
    return Analysis(read_case(example, [*MADE, f"loading=[{loading}]", *settings]), MPI.COMM_SELF)


def run(analysis):
    analysis.run()
    return analysis


def forces(analysis):
    """Greatest reactions of both ends under load and in the free spring, and of its section forces, N and N mm / mm."""
    seen, end = [], analysis._end_phase

    def watched(name):
        control = analysis.control
        seen.append(np.abs([*control.tip_forces().values(), *control.reactions("equilibrium")]).max())
        end(name)

    analysis._end_phase = watched
    analysis.run()
    free = analysis.result.snapshots[-1]
    assert free.free
    with analysis.continuation.excursion():
        analysis.free_ends.let_go()
        internal = analysis.layout.values(analysis.system.internal, analysis.layout.station_dofs)
        ends = np.abs(internal[analysis.control.held_stations]).max()
    return max(seen), ends, free, analysis.result.snapshots[-2]


@pytest.mark.parametrize("settings", [["ends=clamped"], [], ["seats={hold: groove}"], ["contact={arbor: 34}"]])
def test_no_end_and_no_section_carries_anything(example, settings):
    loaded, ends, free, before = forces(pressed(example, *settings))
    assert ends < 1e-6 * loaded
    assert np.abs(free.resultants).max() < 1e-6 * np.abs(before.resultants).max()


@pytest.mark.parametrize("case", [TORSION, EXTENSION], ids=["torsion", "extension"])
def test_springs_that_are_turned_or_pulled_are_let_go_too(case):
    loaded, ends, free, before = forces(Analysis(check(case), MPI.COMM_SELF))
    assert ends < 1e-6 * loaded
    if case is TORSION:
        assert np.abs(free.resultants).max() < 1e-6 * np.abs(before.resultants).max()
    else:  # closed coils press on each other: the wire of the hooks beyond them carries nothing
        assert np.abs(free.resultants[0]).max() < 1e-6 * np.abs(before.resultants).max()
        assert np.abs(free.resultants).max() > 1e-3 * np.abs(before.resultants).max()


def test_the_residual_stress_is_that_of_a_coil_without_ends(example):
    """A long spring between clamped ends, in the middle, against the uniform coil without force and torque; its own
    ends, while they hold it, change that stress by 7 MPa of 57."""
    free, held = (
        run(
            pressed(
                example,
                "spring.turns=8",
                "ends=clamped",
                f"release={release}",
                "mesh.section.radial=6",
                "mesh.section.angular=16",
                "mesh.elements_per_turn=12",
                loading="{to: {travel: 50}, steps: 15}, {to: {force: 0}, steps: 3}",
            )
        )
        for release in ("free", "held")
    )
    coil = np.array([5.0, 40.0, 12.0, 8.0])
    _, state = press(coil, free.law, travels=np.linspace(0.0, 50.0, 16)[1:])
    travel, _ = press(state, free.law, forces=np.linspace(state.force[0], 0.0, 4)[1:], free_ends=True)
    assert summarise(free.setup, free.result)["set_mm"] == pytest.approx(travel[0, -1], rel=5e-3)

    def inside(analysis):
        shot = analysis.result.snapshots[-1]
        around = analysis.setup.inside.shear(shot.surface_state, shot.components).mean(axis=1)
        middle = np.abs(analysis.setup.section_turns.mean(axis=1) - 4.0) < 1.0
        return around[middle]

    assert np.ptp(inside(free)) < 0.01 * abs(inside(free).mean())
    assert np.ptp(inside(held)) > 0.04 * abs(inside(held).mean())


def test_the_path_goes_on_from_the_spring_between_its_ends(example):
    """What follows a release depends on the load program alone, and the held state is as it was before."""
    cycles = f"{PRESSED}, {{to: {{travel: 17}}, steps: 4}}, {{to: {{force: 0}}, steps: 3}}"
    free, held = (run(pressed(example, f"release={one}", loading=cycles)) for one in ("free", "held"))
    assert free.result.steps == held.result.steps
    assert [shot.free for shot in free.result.snapshots] == [False, False, True, False, True]
    found, other = (summarise(one.setup, one.result) for one in (free, held))
    assert found["set_held_mm"] == pytest.approx(other["set_mm"], abs=1e-9)
    assert other["set_held_mm"] is None
    assert abs(found["set_mm"] - other["set_mm"]) > 1e-3 * other["set_mm"]
    for one, twin in zip(free.result.snapshots, held.result.snapshots, strict=True):
        assert one.free or np.array_equal(one.point_state, twin.point_state)


def test_an_elastic_spring_comes_back_to_its_shape(example):
    free = run(pressed(example, "material=elastic"))
    assert summarise(free.setup, free.result)["set_mm"] == pytest.approx(0.0, abs=1e-6)
    np.testing.assert_allclose(free.result.snapshots[-1].x, free.rod.line.stations, atol=2e-6)


def test_a_torsion_spring_keeps_the_angle_of_its_legs():
    free = run(Analysis(check(TORSION), MPI.COMM_SELF))
    held = run(Analysis(check({**TORSION, "release": "held"}), MPI.COMM_SELF))
    found, other = (summarise(one.setup, one.result)["turn_set_deg"] for one in (free, held))
    assert found == pytest.approx(other, abs=0.5)
    assert math.degrees(free.control.turn) == pytest.approx(other, abs=1e-9)


def test_its_place_follows_from_its_end_coils():
    rng = np.random.default_rng(3)
    points = rng.normal(size=(30, 3))
    turns = Rotation.from_rotvec(rng.normal(scale=0.3, size=(2, 3)))
    for R in turns.as_matrix():
        np.testing.assert_allclose(nearest_rotation(points, points @ R.T + 5.0), R, atol=1e-12)
    half = (turns[0] * (turns[0].inv() * turns[1]) ** 0.5).as_matrix()
    np.testing.assert_allclose(mean_rotation(list(turns.as_matrix())), half, atol=1e-12)
    flat = points * [1.0, 1.0, 0.0]
    np.testing.assert_allclose(nearest_rotation(flat, flat @ half.T), half, atol=1e-12)


def test_a_resumed_run_has_the_same_free_spring(example, tmp_path):
    cycles = f"{PRESSED}, {{to: {{travel: 17}}, steps: 4}}, {{to: {{force: 0}}, steps: 3}}"
    whole = run(pressed(example, loading=cycles))
    first = pressed(example, loading=cycles)
    checkpoint = Checkpoint(tmp_path, first.case)

    class Stop(Exception):
        pass

    def stop(step):
        if step.number == 13:
            raise Stop

    with pytest.raises(Stop):
        first.run(stop, checkpoint.save)
    again = pressed(example, loading=cycles)
    again.resume(Checkpoint(tmp_path, again.case).load(MPI.COMM_SELF))
    again.run()
    for one, other in zip(whole.result.snapshots, again.result.snapshots, strict=True):
        assert (one.free, one.height, one.turn) == (other.free, other.height, other.turn)
        np.testing.assert_array_equal(one.point_state, other.point_state)


@pytest.mark.mpi
def test_ranks_agree(example):
    case = read_case(example, [*MADE, f"loading=[{PRESSED}]"])
    alone, together = Analysis(case, MPI.COMM_SELF), Analysis(case, MPI.COMM_WORLD)
    one, other = (run(analysis).result.snapshots[-1] for analysis in (alone, together))
    assert one.height == pytest.approx(other.height, abs=1e-9)
    np.testing.assert_allclose(one.x, other.x, atol=1e-9)
