"""What a run says about itself: each warning on either side of its bound, as data, on the screen and in the log."""

import copy
import json
import math
from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.run_warnings import accuracy_warning, run_warnings, step_warnings
from coilset.model.compose.summary import summarise
from coilset.model.core.base.warning import Warning
from coilset.model.core.case import read_case
from coilset.model.core.results import surface
from coilset.model.core.results.files.checkpoint import Checkpoint
from coilset.model.core.results.records.record import Result, Step
from coilset.model.physics.time.creep.entries import CreepTests
from coilset.scripts.commands.solve import solve

COARSE = ["mesh.elements_per_turn=10", "mesh.section.rule=abramowitz9"]
LIFTED = "loading=[{to: {travel: 8}, steps: 4}, {to: {force: 0}, steps: 2}, {to: {travel: 0}, steps: 2}]"


@pytest.fixture(scope="module")
def lifted(example):
    """A spring that sets and is then drawn up to its free length."""
    analysis = Analysis(read_case(example, [*COARSE, LIFTED, "rates_at=[4]"]), MPI.COMM_SELF)
    analysis.run()
    return analysis


def names(warnings):
    return [warning.name for warning in warnings]


def test_a_seat_that_lifts_off_is_reported(lifted):
    (warning,) = (one for one in run_warnings(lifted.setup, lifted.result) if one.name not in ("contact mesh", "error"))
    steps = lifted.result.steps
    assert warning.name == "lift-off"
    assert warning.place.startswith("step 7, ")
    assert [step.lift_off_mm > 0.0 for step in steps] == [False] * 6 + [True] * 2
    # the gaps at both seats make up what the spring has set, as seen where it was free of load
    gap = steps[-1].seat_height_mm - steps[5].seat_height_mm
    assert steps[-1].lift_off_mm == pytest.approx(0.5 * gap, rel=0.01)
    assert warning.value == steps[-1].lift_off_mm


def test_a_seat_that_is_left_carries_nothing(lifted):
    """The springs at the tips pull by some tenths of a newton; no seat does."""
    steps, seats = lifted.result.steps, lifted.result.seats
    assert lifted.control.force < -0.1
    assert [step.force_N for step in steps[6:]] == [0.0, 0.0]
    assert [(one.bottom.force_N, one.top.force_N) for one in seats[6:]] == [(0.0, 0.0)] * 2
    assert lifted.result.snapshots[-1].force == 0.0
    (release,) = summarise(lifted.setup, lifted.result)["releases"]
    assert release["phase"] == 2  # of three; at the end it is not free: the tips are held
    for step, one in zip(steps[:5], seats[:5], strict=True):
        assert one.top.force_N == pytest.approx(step.force_N, rel=1e-9)


def test_a_force_of_zero_has_no_sign(lifted):
    """A released spring bears 0.0 N in all files, not -0.0."""
    released = [step.force_N for step in lifted.result.steps if step.force_N == 0.0]
    assert len(released) > 2  # at the release, and where the seat is left
    assert [math.copysign(1.0, force) for force in released] == [1.0] * len(released)


def test_no_rate_is_that_of_a_lifted_seat(lifted):
    summary = summarise(lifted.setup, lifted.result)
    (asked,) = summary["rates"]
    assert asked["rate_N_per_mm"] > 0.0
    assert summary["rate_30_70_after_N_per_mm"] is None  # not free of load: the string pulls
    assert summary["warnings"] == [vars(warning) for warning in run_warnings(lifted.setup, lifted.result)]


def test_warnings_of_steps(lifted):
    step = Step(1, 0, 1.0, 30.0, 5.0, 100.0, 3, 4, 0, 0, 2, 0.0)
    setup, limits = lifted.setup, lifted.setup.limits
    bounds = [
        ("plastic work", {"plastic_work_max_N_per_mm2": limits.plastic_work}, 1.001),
        ("penetration", {"penetration_mm": limits.penetration}, 1.001),
        ("coils slipped", {"least_rise": 0.7}, 0.999),
        ("lift-off", {"lift_off_mm": 0.0}, None),
        ("unstable", {"negative_pivots": 0}, None),
        ("snapped", {"left_branch": 0, "released_energy_Nmm": 0.0}, None),
    ]
    for name, right, factor in bounds:
        wrong = {key: value * factor if factor else 1 for key, value in right.items()}
        assert step_warnings(setup, Result(steps=(replace(step, **right),))) == []
        found = step_warnings(setup, Result(steps=(step, replace(step, number=2, **wrong))))
        assert name in names(found)
        assert next(one for one in found if one.name == name).place.startswith("step 2, ") or name == "buckled"


def test_a_spring_that_buckles_is_told_from_one_that_leans(lifted):
    """The standard's travel beside it, which is that of elastic wire; the axis of a side-load spring is drawn so."""
    D = lifted.setup.spring.mean_diameter
    step = Step(1, 0, 1.0, 30.0, 5.0, 100.0, 3, 4, 0, 0, 2, 0.0)
    aside = replace(step, number=2, travel_mm=5.1, force_N=101.0, axis_offset_mm=0.1 * D)

    def found(*steps, **changes):
        result = replace(lifted.result, steps=steps)
        names = ("buckled", "leans")
        return [one for one in run_warnings(replace(lifted.setup, **changes), result) if one.name in names]

    for limit, words in ((12.0, "at 12 mm"), (math.inf, "never, as long as the wire is elastic")):
        (one,) = found(step, replace(aside, left_branch=1), buckling_travel=limit)
        assert (one.name, one.value) == ("buckled", 5.0)
        assert f"buckled at a travel of 5 mm and 100 N, and its axis went up to {0.1 * D:.3g} mm aside" in one.message
        assert f"(EN 13906-1: {words})" in one.message
    (one,) = found(step, aside)
    assert (one.name, one.value) == ("leans", 0.1 * D)
    assert f"its axis is up to {0.1 * D:.3g} mm aside, at a travel of 5.1 mm, 10 % of its mean diameter" in one.message
    side_load = replace(lifted.setup.spring, is_straight=False)
    assert found(step, aside, spring=side_load) == []


def test_creep_beyond_its_tests(lifted):
    """Stress where time begins to pass: of the snapshot before that phase, not of a press before."""
    shots, step = lifted.result.snapshots, Step(1, 1, 1.0, 30.0, 5.0, 100.0, 3, 4, 0, 0, 2, 0.0)
    steps = (step, replace(step, number=2, hours=48.0, temperature_K=393.0))
    stress = float(surface.equivalent(shots[1].surface_state, shots[1].components).max())
    inside = {"temperature": (353.0, 393.0), "stress": (0.0, stress), "hours": (48.0, 48.0)}

    def found(**changes):
        limits = replace(lifted.setup.limits, creep=CreepTests.model_validate(inside | changes))
        result = replace(lifted.result, steps=steps)
        return [one for one in run_warnings(replace(lifted.setup, limits=limits), result) if one.name == "creep"]

    assert found() == []
    for name, place, value in (("temperature", "temperature", 393.0), ("hours", "time", 48.0)):
        (one,) = found(**{name: (1.0, 0.9 * value)})
        assert (one.place, one.value) == (place, value)
    (one,) = found(stress=(0.0, 0.9 * stress))
    assert one.place == "equivalent stress"
    assert "the load loss is extrapolated" in one.message


@pytest.mark.parametrize("critical", [math.inf, 8.0], ids=["stout", "slender"])
def test_a_warning_is_logged_after_the_first_step_that_shows_it(lifted, caplog, critical):
    """Steps on both sides of all bounds at random: as if all steps so far had been looked through after each."""
    recorder, rng, steps = copy.copy(lifted.recorder), np.random.default_rng(4), []
    recorder.setup, limits = replace(lifted.setup, buckling_travel=critical), lifted.setup.limits
    recorder.resume(Result())
    wrong = [
        {"plastic_work_max_N_per_mm2": 1.5 * limits.plastic_work},
        {"penetration_mm": 1.5 * limits.penetration},
        {"least_rise": 0.5},
        {"lift_off_mm": 0.1},
        {"negative_pivots": 1},
        {"force_N": 1e4, "progress": 1.0},
        {"left_branch": 1, "released_energy_Nmm": 1.0},
        {"axis_offset_mm": 0.06 * lifted.setup.spring.mean_diameter},
    ]
    expected = {}
    with caplog.at_level("WARNING", "coilset.steps"):
        for number in range(1, 61):
            step = Step(number, 0, 0.5, 30.0, 0.2 * number, 10.0 * number, 3, 4, 0, 0, 2, 0.0)
            for changes in wrong:
                early = number == 12 and "axis_offset_mm" in changes  # long before the eigenvalue vanishes
                step = replace(step, **changes) if rng.uniform() < 0.08 or early else step
            eigenvalue = None if critical == math.inf else 10.0 - 0.25 * number
            before, steps = Result(tuple(steps)), [*steps, replace(step, least_eigenvalue=eigenvalue)]
            recorder.result = Result(tuple(steps))
            recorder._announce(before)
            for warning in step_warnings(recorder.setup, recorder.result):
                expected.setdefault(warning.name, f"warning: {warning.message}")
    assert caplog.messages == list(expected.values())
    assert len(expected) == 8


def test_a_negative_set_after_compression_is_named(lifted):
    """The released spring is moved apart: 0.99 and 1.01 of the limit; drawn or coiled springs may lengthen."""
    setup, result, limit = lifted.setup, lifted.result, 1e-3 * lifted.setup.spring.free_length
    steps, shots = result.steps[:6], result.snapshots[:3]
    short = setup.spring.free_length - setup.outer_length(shots[-1].x)

    def longer(by, steps=steps, setup=setup):
        x = shots[-1].x.copy()
        x[len(x) // 2 :, 2] += short + by  # from the middle of the wire on
        released = replace(result, steps=steps, snapshots=(*shots[:2], replace(shots[-1], x=x)))
        return [one for one in run_warnings(setup, released) if one.name == "negative set"]

    assert longer(0.99 * limit) == []
    (warning,) = longer(1.01 * limit)
    assert warning.value == pytest.approx(-1.01 * limit)
    assert "ends: seats" in warning.message
    drawn = (replace(steps[0], force_N=-10.0), *steps[1:])
    assert longer(1.01 * limit, steps=drawn) == []
    assert longer(1.01 * limit, setup=replace(setup, coiling_diameter=30.0)) == []


def test_a_force_on_a_wall_is_reported(lifted):
    """From 100 N at 10 mm to 120 N at 10.1 mm: 200 N/mm are 16.8 % of it for 1 % of the travel, 400 N/mm 29 %."""
    first = Step(1, 0, 0.9, 25.0, 10.0, 100.0, 3, 4, 0, 0, 2, 0.0)
    for force, phase, progress, found in (
        (120.0, 0, 1.0, 0),
        (140.0, 0, 1.0, 1),
        (140.0, 0, 0.95, 0),
        (140.0, 1, 1.0, 0),
        (60.0, 0, 1.0, 1),
    ):
        last = replace(first, number=2, travel_mm=10.1, force_N=force, phase=phase, progress=progress)
        walls = [one for one in step_warnings(lifted.setup, Result(steps=(first, last))) if one.name == "wall"]
        assert len(walls) == found
        if found:
            assert walls[0].value == pytest.approx(abs(force - 100.0) / 0.1 * 10.1 / force, rel=1e-9)
    back = replace(first, number=2, travel_mm=9.9, force_N=60.0, progress=1.0)
    assert "wall" not in names(step_warnings(lifted.setup, Result(steps=(first, back))))
    hot, cold = (
        replace(first, phase=1, travel_mm=travel, force_N=force, progress=progress)
        for travel, force, progress in ((10.0, -1e-10, 0.5), (10.01, 1e-10, 1.0))
    )
    assert "wall" not in names(step_warnings(lifted.setup, Result(steps=(first, hot, cold))))  # free of load


def test_the_steps_error_is_held_against_the_accuracy_asked_for():
    assert accuracy_warning(0.01, 0.01, "block") is None
    assert accuracy_warning(0.02, 0.01, "block").value == 0.02
    of_set = accuracy_warning(0.02, 0.01, "set", "the set", "0.01 mm").message
    assert "the set is uncertain by about 2 %, 0.01 mm, because" in of_set  # a small set may be good enough
    near = accuracy_warning(0.02004, 0.02, "set").message
    assert "by about 2.004 % because of the step size, more than the case's accuracy of 2 %;" in near  # not 2 and 2


@pytest.mark.parametrize(("error", "found"), [(1e-4, []), (1e-3, ["step error"])])
def test_an_error_of_the_set_that_nobody_measures_is_not_reported(example, error, found):
    """Of an elastic spring of 35 mm that has set by a thousandth of a millimetre in rounding."""
    settings = [*COARSE, "material=elastic", "loading=[{to: {travel: 6}, steps: 2}, {to: {force: 0}, steps: 1}]"]
    analysis = Analysis(read_case(example, settings), MPI.COMM_SELF)
    result = analysis.run()
    shorter = replace(result.snapshots[-1], x=result.snapshots[-1].x * (1.0 - 3e-5))
    steps = (*result.steps[:-1], replace(result.steps[-1], steps_height_error_mm=error))
    set_so = replace(result, steps=steps, snapshots=(*result.snapshots[:-1], shorter))
    assert [name for name in names(run_warnings(analysis.setup, set_so)) if name != "error"] == found


def test_an_error_that_is_not_known_at_the_greatest_force_is_reported(lifted):
    """Where accuracy is asked for, and the spring bears something; elsewhere than at its greatest no error is held."""
    setup, result = lifted.setup, lifted.result
    top = max(range(8), key=lambda number: result.steps[number].force_N)
    unknown = [replace(step, steps_force_error_N=None) for step in result.steps]
    assert "unknown error" not in names(run_warnings(setup, result))
    others = replace(result, steps=(*unknown[:top], result.steps[top], *unknown[top + 1 :]))
    assert "unknown error" not in names(run_warnings(setup, others))
    found = [one for one in run_warnings(setup, replace(result, steps=tuple(unknown))) if one.name == "unknown error"]
    assert [(one.place, one.limit) for one in found] == [(f"step {top + 1}, travel 8 mm", 0.002)]
    none_asked = replace(setup, limits=replace(setup.limits, accuracy=None))
    assert "unknown error" not in names(run_warnings(none_asked, replace(result, steps=tuple(unknown))))
    free = tuple(replace(step, force_N=1e-9) for step in unknown)
    assert "unknown error" not in names(run_warnings(setup, replace(result, steps=free)))


def test_stress_above_the_wires_strength(example):
    wire = "material={wire: EN 10270-1 SH}"
    block = [*COARSE, wire, "loading=[{to: {travel: 17}, steps: 3}]"]
    analysis = Analysis(read_case(example, block), MPI.COMM_SELF)
    analysis.run()
    strength = analysis.setup.limits.strength
    assert strength == pytest.approx(1656.8, abs=0.1)  # 2230 − 820 lg 5
    assert names(analysis.setup.warnings) == ["estimate"]
    assert "strength" not in names(run_warnings(analysis.setup, analysis.result))
    lower = replace(analysis.setup, limits=replace(analysis.setup.limits, strength=300.0))
    assert "strength" in names(run_warnings(lower, analysis.result))


def test_little_presetting(example):
    settings = [*COARSE, "material=elastic", "loading=[{to: block, steps: 6}, {to: {force: 0}, steps: 4}]"]
    analysis = Analysis(read_case(example, settings), MPI.COMM_SELF)
    analysis.run()
    assert "presetting" not in names(run_warnings(analysis.setup, analysis.result))  # an elastic spring is not preset
    analysis = Analysis(read_case(example, [*settings, "material={wire: EN 10270-1 SH}"]), MPI.COMM_SELF)
    analysis.run()
    (found,) = [one for one in run_warnings(analysis.setup, analysis.result) if one.name == "presetting"]
    assert 0.0 < found.value < found.limit == pytest.approx(0.1 * 17.5)


def test_they_are_in_the_log_the_summary_and_the_checkpoint(example, tmp_path, capsys):
    solve(example, tmp_path / "out", False, [*COARSE, LIFTED, "contact.deepest=0.02"], comm=MPI.COMM_SELF)
    found = json.loads((tmp_path / "out" / "summary.json").read_text())["warnings"]
    assert [one["name"] for one in found] == ["earlier name", "lift-off", "error"]  # of the coarse mesh
    log = (tmp_path / "out" / "log.txt").read_text()
    printed = " ".join(capsys.readouterr().out.split())
    for one in found:
        assert one["message"] in log
        assert printed.count("warning: " + one["message"]) == 1
    assert log.index("lifts off a seat") < log.index("step 8:")  # said when it happened


def test_a_checkpoint_keeps_warnings(example, tmp_path):
    case = read_case(example, [*COARSE, "loading=[{to: {travel: 1}, steps: 1}]"])
    analysis, checkpoint = Analysis(case, MPI.COMM_SELF), Checkpoint(tmp_path, case)
    warning = Warning("initial rate", "start", "the initial rate is unknown")
    analysis.recorder.result = replace(analysis.result, warnings=(warning,))
    analysis.run(save=checkpoint.save)
    assert checkpoint.load(MPI.COMM_SELF).result.warnings == (warning,)
