"""Unstable equilibria are no answer: pivots against eigenvalues, long springs with few and many steps, what is said."""

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI
from scipy.linalg import eigh, eigvalsh_tridiagonal, ldl

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.summary import summarise
from coilset.model.core.case import Case
from coilset.model.core.equilibrium.path.continuation import Continuation
from coilset.model.core.equilibrium.settings import StepControl
from coilset.model.core.equilibrium.system.load import Drag
from coilset.model.core.equilibrium.system.system import Evaluation
from coilset.model.core.results.records.axis import axis_offset
from coilset.model.core.results.records.record import Step
from coilset.model.physics.stability.branch_switching import Snap
from coilset.model.physics.stability.buckling import buckling, leaning
from coilset.model.physics.stability.stability import mode_in_words, negative_pivots
from coilset.scripts.terminal.progress import Lines

LONG = {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 40, "pitch": 12.0}
HARINGX = 39.16  # mm, of this spring between clamped heads; coilset.verification.references.stability


def pressed(travel, steps, comm=MPI.COMM_SELF, mesh=8, **more):
    """The long elastic spring between clamped heads."""
    data = {
        "spring": LONG,
        "material": "elastic",
        "ends": "clamped",
        "accuracy": "none",
        "mesh": {"elements_per_turn": mesh, "section": {"kind": "plane"}},
        "loading": [{"to": {"travel": travel}, "steps": steps}],
        **more,
    }
    return Analysis(Case.model_validate(data), comm)


def dense(analysis):
    """Symmetric part of the tangent of the free unknowns at the last equilibrium."""
    system, load, matrix = analysis.system, analysis.newton.iteration.load, analysis.newton.iteration.matrix
    system.tangent(system.layout.vector(), load, matrix)
    n = system.layout.size
    K = matrix.mat.getValues(range(n), range(n))
    free = np.setdiff1d(np.arange(n), load.held)
    return 0.5 * (K + K.T)[np.ix_(free, free)]


@pytest.mark.parametrize("travel", [20.0, 60.0])
def test_negative_pivots_are_negative_eigenvalues(travel):
    """On a path whose states are not judged: none before Haringx's travel, some far beyond it."""
    analysis = pressed(travel, 1, mesh=4)
    analysis.program.continuation = analysis.continuation = Continuation(analysis.newton)
    analysis.program.begin(0)
    analysis.run()
    blocks = ldl(dense(analysis))[1]  # of one or two rows; by Sylvester's law as many are negative
    expected = int((eigvalsh_tridiagonal(np.diag(blocks), np.diag(blocks, -1)) < 0.0).sum())
    assert (expected > 0) == (travel > HARINGX)
    with analysis.stability._factorised(analysis.newton.iteration.load) as (_matrix, factors):
        assert negative_pivots(factors) == expected


def edge(analysis):
    """The load of a spring with a negative stiffness at a node half way up, as of a coil on the edge of another."""
    layout, load = analysis.system.layout, analysis.newton.iteration.load
    stiffness = np.zeros(layout.size_local)
    here = int(layout.station_dofs[len(layout.station_dofs) // 2, 0]) - layout.start
    if 0 <= here < len(stiffness):
        stiffness[here] = -1e6
    return load.resisted(Drag(stiffness, np.zeros_like(stiffness)))


def test_the_weakest_mode_is_the_lowest_and_not_the_nearest_to_zero():
    """Against the eigenvalues of the dense matrix."""
    analysis = pressed(1.0, 1, mesh=4)
    analysis.run()
    K, load = dense(analysis), edge(analysis)
    free = np.setdiff1d(np.arange(len(load.is_held)), load.held)
    weights = np.diag(analysis.stability.weights(load)[free])
    lowest = [eigh(K + part * np.diag(load.resistance.stiffness[free]), weights, eigvals_only=True) for part in (0, 1)]
    assert [int((values < 0.0).sum()) for values in lowest] == [0, 1]
    assert lowest[1][0] < -1e3 < 0.0 < lowest[1][1]
    for values, at in zip(lowest, (load.resisted(None), load), strict=True):
        weakest = analysis.stability.weakest(at)
        assert weakest.negative == (values[0] < 0.0)
        assert weakest.value == pytest.approx(values[0], rel=1e-6)


@pytest.mark.parametrize("has_stress", [False, True])
def test_a_state_without_a_tangent_has_no_weakest_mode(has_stress):
    """Where the law finds no stress nothing touches the seats either, and a head that is free to move resists nothing:
    a pivot of zero, after which LAPACK was given numbers that are none. A release went on from such a state."""
    analysis = pressed(2.0, 1, mesh=4, ends="seats", spring=LONG | {"turns": 3})
    analysis.run()
    analysis.system.restore()
    load = analysis.control.to_force(1.0)
    assert np.isfinite(analysis.stability.weakest(load).value)
    analysis.system.last = Evaluation(analysis.system.last.increments, has_stress, [])
    weakest = analysis.stability.weakest(load)
    assert weakest.negative == analysis.stability.negative_pivots(load) == 0
    assert np.isnan(weakest.value)
    assert not np.isfinite(analysis.stability.displacements(weakest.mode)).any()


def test_what_gives_way_is_named():
    """A slender spring as a whole, at mid height; else the coils that move against each other."""
    analysis = pressed(1.0, 1, mesh=4)
    analysis.run()
    assert analysis._gives_way() == "the spring as a whole gives way sideways, most at turn 20.00"
    turns = np.linspace(0.0, 5.0, 51)
    near = np.exp(-((turns - 2.5) ** 2) / 0.1)
    words = "the coils at turns 1.50 and 2.50 give way against each other, "
    assert mode_in_words(np.outer(near, [1.0, 0.0, 0.5]), turns) == words + "sideways"
    assert mode_in_words(np.outer(near, [0.0, 0.5, 1.0]), turns) == words + "up and down"


def test_a_law_that_deviates_from_normality_is_named_once_wire_yields():
    """κ is zero before, and in other laws."""
    for material, travel, named in (("ck15", 1.0, False), ("ck15", 15.0, True), ("mixed", 15.0, False)):
        analysis = pressed(travel, 2, mesh=4, material=material, spring=LONG | {"turns": 3})
        analysis.run()
        assert ("; ck15 deviates from normality" in analysis._gives_way()) is named
        found = (D := analysis.rod.coefficients.D).copy()
        with analysis.rod.judged():
            assert np.linalg.eigvalsh(D + np.swapaxes(D, -1, -2)).min() > 0.0
        np.testing.assert_array_equal(D, found)


def test_factors_of_other_libraries_show_no_pivots():
    """PETSc cannot ask MUMPS for them: the symmetric part is factorised as with methods that keep a matrix."""
    analysis = pressed(20.0, 1, mesh=4, solver={"options": {"pc_factor_mat_solver_type": "mumps"}})
    force = analysis.run().steps[-1].force_N
    assert analysis.newton.iteration.negative_pivots() is None
    assert force == pytest.approx(pressed(20.0, 1, mesh=4).run().steps[-1].force_N, rel=1e-9)


def test_few_steps_end_on_the_stable_branch():
    """One and four steps to one and a half times the critical travel: the same force, and no word of doubt."""
    forces = []
    for steps in (1, 4):
        result = pressed(60.0, steps, mesh=6).run()
        assert result.steps[-1].negative_pivots == 0
        forces.append(result.steps[-1].force_N)
    np.testing.assert_allclose(forces, forces[-1], rtol=1e-6)


def test_critical_travel_is_haringxs(capsys):
    """Steps of 4 mm; 1.5 % since Haringx leaves out the pitch, and what 8 rods a turn leave. The last lines say it."""
    analysis = pressed(44.0, 11)
    summary = summarise(analysis.setup, analysis.run())
    assert summary["buckled"]
    assert summary["buckling_travel_mm"] == pytest.approx(HARINGX, rel=0.02)
    assert summary["buckling_force_N"] == pytest.approx(96.51, rel=0.02)
    assert summary["buckling_travel_EN_13906_1_mm"] == pytest.approx(HARINGX, rel=0.02)
    (told,) = (one for one in summary["warnings"] if one["name"] == "buckled")
    assert told["value"] == summary["buckling_travel_mm"]
    assert f"buckled at a travel of {told['value']:.4g} mm" in told["message"]
    Lines().conclude(summary, [], Path("out"))
    printed = " ".join(capsys.readouterr().out.split())
    assert printed.rindex(told["message"]) > printed.index("results in")


def test_a_short_spring_does_not_buckle(example):
    from coilset.model.core.case import read_case

    settings = ["mesh.section.rule=abramowitz9", "loading.0.steps=6", "loading.1.steps=3", "accuracy=none"]
    analysis = Analysis(read_case(example, settings), MPI.COMM_SELF)
    result = analysis.run()
    assert buckling(result.steps, 40.0) is None
    assert all(step.negative_pivots == 0 for step in result.steps)
    assert all(step.least_eigenvalue is None for step in result.steps)


ON_SEATS = {"wire_diameter": 1, "mean_diameter": 8, "turns": 10, "free_length": 64, "end_coils": "closed and ground"}
HINGED = {"wire_diameter": 2, "mean_diameter": 20, "turns": 16, "pitch": 5}
BALLS = {"top": {"tilt": "free"}, "bottom": {"tilt": "free"}}
FINE = {"wire_diameter": 0.9, "outer_diameter": 6.5, "turns": 24, "free_length": 130}


@pytest.mark.parametrize(
    ("spring", "ends", "travel", "steps", "low", "high"),
    [
        (FINE, {}, 3.2, (2, 12), 2.69, 2.77),  # L0/D = 23, EN 13906-1: 2.727 mm
        (HINGED, {"heads": BALLS}, 20.0, (4, 20), 15.8, 16.0),  # Haringx with ν = 1: 15.9 mm; its force rises on
        (ON_SEATS, {"ends": "seats", "seats": {"hold": "groove"}}, 14.0, (14, 28), 12.5, 13.1),  # one end lifts off
    ],
    ids=["clamped", "hinged", "on seats"],
)
def test_a_spring_buckles_where_its_path_bends_whatever_its_ends_and_steps(spring, ends, travel, steps, low, high):
    for number in steps:
        analysis = pressed(travel, number, mesh=12, spring=spring, **ends)
        summary = summarise(analysis.setup, analysis.run())
        assert summary["buckled"]
        assert low < summary["buckling_travel_mm"] < high
        assert summary["unstable_steps"] == 0
        found = [(step.travel_mm, step.force_N) for step in analysis.result.steps]
        force = np.interp(summary["buckling_travel_mm"], *np.transpose(found))
        assert summary["buckling_force_N"] == pytest.approx(force, rel=1e-9)
        # of the length over the wire, where Haringx's is that of the centre line
        assert summary["buckling_travel_EN_13906_1_mm"] == pytest.approx(0.5 * (low + high), rel=0.04)


def path(*states):
    """Steps with these travels, mm, forces, N, and offsets, mm."""
    step = Step(1, 0, 1.0, 90.0, 0.0, 0.0, 3, 4, 0, 0, 2, 0.0)
    return [replace(step, travel_mm=s, force_N=F, axis_offset_mm=w) for s, F, w in states]


def pushed_column(travels, critical=64.4, bend=0.0085, push=0.02):
    """Steps of Koiter's symmetric fork, (s_c − s + b w²) w = c s, whose force rises ten times less beyond it."""
    states = []
    for s in travels:
        roots = np.roots([bend, 0.0, critical - s, -push * s])
        w = max(root.real for root in roots if abs(root.imag) < 1e-9)
        states.append((s, 3.8 * min(s, critical + 0.1 * (s - critical)), w))
    return path(*states)


@pytest.mark.parametrize("push", [1e-3, 2e-1, 8.0])
@pytest.mark.parametrize("number", [5, 16, 40])
def test_a_column_that_is_pushed_aside_buckles_where_it_would_fork(push, number):
    """Its states are stable, and its force rises on: s_c follows from any three of them."""
    travels = np.linspace(0.0, 1.3 * 64.4, number + 1)[1:]
    found = buckling(pushed_column(travels, push=push), 40.0)
    assert found.travel_mm == pytest.approx(64.4, rel=1e-9)
    assert found.offset_mm == pushed_column(travels, push=push)[-1].axis_offset_mm


def test_a_spring_that_is_pushed_aside_and_not_pressed_to_its_fork_leans():
    steps = pushed_column(np.linspace(5.0, 60.0, 12), push=0.3)
    assert buckling(steps, 40.0) is None
    assert leaning(steps, 40.0) is steps[-1]
    assert leaning(pushed_column(np.linspace(5.0, 60.0, 12), push=0.02), 40.0) is None
    assert leaning(pushed_column(np.linspace(5.0, 80.0, 16), push=0.3), 40.0) is None  # it has buckled


def test_a_spring_buckles_at_the_maximum_of_its_force_if_its_axis_leaves():
    """A dip that is regained within a twentieth of the travel is a coil that slips; wire that yields keeps its axis."""
    rise = [(8.0, 16.0, 0.2), (9.0, 18.0, 0.25), (10.0, 19.8, 0.36), (10.2, 19.7, 0.41), (10.4, 20.0, 0.5)]
    fall = [(11.0, 20.1, 1.1), (11.2, 20.0, 1.9), (12.0, 19.0, 8.0)]
    found = buckling(path(*rise, *fall), 20.0)
    assert (found.travel_mm, found.force_N, found.offset_mm) == (11.0, 20.1, 8.0)
    assert buckling(path(*rise, *((s, F, 1.1) for s, F, _ in fall)), 20.0) is None


def test_a_spring_buckles_at_its_last_stable_state():
    steps = path((8.0, 16.0, 0.2), (9.0, 18.0, 0.3), (9.1, 18.1, 1.5), (10.0, 18.2, 3.0))
    for left in ({"negative_pivots": 1}, {"left_branch": 1}):
        found = buckling([*steps[:2], replace(steps[2], **left), steps[3]], 20.0)
        assert (found.travel_mm, found.force_N, found.offset_mm) == (9.0, 18.0, 3.0)
    assert buckling(steps[:2], 20.0) is None
    still = [replace(step, axis_offset_mm=0.2) for step in steps]  # coils that snap past each other move no axis
    assert buckling([*still[:2], replace(still[2], left_branch=1), still[3]], 20.0) is None


def test_a_spring_buckles_in_the_loading_that_bends_it():
    """One that was pressed to 14 mm and let go, and buckles at 10 mm, softer by then."""
    first = path(*((s, 10.0 * s, 0.01 * s) for s in (1, 2, 4, 6, 8, 9, 11, 12, 13, 14)))
    back = path(*((s, 9.0 * s, 0.01 * s) for s in (5.0, 1.0)))
    again = path(*((s, 9.0 * s, 0.01 * s) for s in (3.0, 6.0, 9.0, 10.0)), (12.0, 108.0, 5.0))
    found = buckling([*first, *back, *again[:-1], replace(again[-1], negative_pivots=1)], 40.0)
    assert (found.travel_mm, found.force_N) == (10.0, 90.0)


def test_a_spring_that_is_pulled_does_not_buckle():
    steps = path((-10.0, -20.0, 0.5), (-20.0, -40.0, 5.0), (-10.0, -20.0, 6.0), (0.0, 0.0, 1.0))
    assert buckling([replace(step, left_branch=1) for step in steps], 20.0) is None
    assert leaning(steps, 20.0) is None


def test_offset_of_the_axis_is_the_mean_of_a_turn():
    turns = np.linspace(0.0, 6.0, 97)
    start = np.stack([20 * np.cos(2 * np.pi * turns), 20 * np.sin(2 * np.pi * turns), 12 * turns], axis=1)
    wider = start * [1.1, 1.1, 1.0]  # breathing moves no axis
    assert axis_offset(wider, start, turns) < 1e-2
    moved = start + np.outer(np.sin(np.pi * turns / 6.0), [0.3, 0.4, 0.0])
    assert axis_offset(moved, start, turns) == pytest.approx(0.5 * np.sinc(1 / 12), rel=2e-3)


@pytest.mark.mpi
def test_ranks_count_and_weigh_alike():
    found = []
    for comm in (MPI.COMM_SELF, MPI.COMM_WORLD):
        analysis = pressed(30.0, 2, comm)
        analysis.run()
        load = analysis.newton.iteration.load
        with analysis.stability._factorised(load) as (_matrix, factors):
            negative = negative_pivots(factors)
        found.append((negative, *(analysis.stability.weakest(at).value for at in (load, edge(analysis)))))
    assert found[0][0] == found[1][0] == 0
    assert found[0][1:] == pytest.approx(found[1][1:], rel=1e-6)
    assert found[0][2] < -1e3


@pytest.mark.mpi
def test_ranks_snap_alike():
    """Let go from the straight spring beyond the critical travel: the same bent one, stable, and the same energy."""
    found = []
    for comm in (MPI.COMM_SELF, MPI.COMM_WORLD):
        analysis = pressed(44.0, 1, comm, mesh=4)
        newton, stability, control = analysis.newton, analysis.stability, analysis.control
        load = partial(control.to_height, analysis.spring.free_length - 44.0)
        assert newton.solve(load()).converged
        assert stability.negative_pivots(newton.iteration.load) > 0
        straight, unstable = control.trial_force, analysis.system.increments.copy()
        analysis.system.restore()
        outcome = Snap(stability, StepControl(), newton.solve).go(load, unstable)
        assert outcome.converged
        assert outcome.left_branch
        assert control.force < 0.99 * straight
        x = analysis.layout.gather(analysis.rod.x)
        assert axis_offset(x, analysis.rod.line.stations, analysis.setup.turns) > 5.0
        found.append((control.force, outcome.released))
    assert found[0][0] == pytest.approx(found[1][0], rel=1e-6)
    assert found[0][1] == pytest.approx(found[1][1], rel=1e-6)
    assert found[0][1] > 0.0
