"""Steps that know their error: what is asked for, what the estimate says, what the steps make of it."""

from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.summary import summarise
from coilset.model.core.base.errors import InputError
from coilset.model.core.case import check, read_case
from coilset.model.core.case.case import read_case_data
from coilset.model.core.equilibrium.newton.outcome import Estimate
from coilset.model.core.material import library
from coilset.model.physics.accuracy.step_error import LEAST_FACTOR

COARSE = ["mesh.elements_per_turn=10", "mesh.section.radial=3", "mesh.section.angular=8"]
BACK = "{to: {force: 0}, steps: 8}"


def run(example, *settings):
    """Result and summary of the example with other entries."""
    analysis = Analysis(read_case(example, settings), MPI.COMM_SELF)
    return analysis.run(), summarise(analysis.setup, analysis.result)


@pytest.mark.parametrize(("given", "found"), [("0.2 %", 0.002), ("0.5%", 0.005), (0.01, 0.01)])
def test_accuracy_in_per_cent_and_as_a_number(example, given, found):
    data = read_case_data(example)
    assert check(data | {"accuracy": given}).accuracy == pytest.approx(found, rel=1e-15)
    assert check(data).accuracy == 0.002


@pytest.mark.parametrize("given", ["little", "%", "2 % of it", 0, 1.5, "-1 %", "nan"])
def test_an_accuracy_that_is_none(example, given):
    with pytest.raises(InputError, match="accuracy"):
        check(read_case_data(example) | {"accuracy": given})


def test_steps_take_the_size_that_their_error_allows(example):
    """Eight times what a step may bring in: cut to 0.9/2 of its size; the next one to 0.9/1.1 by a third of 1.1³."""
    analysis = Analysis(read_case(example, ["mesh.elements_per_turn=8", "loading=[{to: {travel: 3}}]"]), MPI.COMM_SELF)
    factor = analysis.continuation.step_error._factor
    assert factor(8.0) == pytest.approx(0.45)
    assert factor(1.0) == pytest.approx(0.9)
    assert factor(0.0) == factor(1e-9) == analysis.case.solver.control.steps.growth
    assert factor(np.inf) == LEAST_FACTOR
    shares, asked = [8.0, 1.331, 1e-9], []

    def estimate(ratio, controls, rate):
        assert controls
        asked.append(ratio)
        share = shares.pop(0) if shares else 0.0
        return Estimate(0.0, 0.0, share, factor(share))

    analysis.continuation.step_error.estimate = estimate
    travels = [step.travel_mm for step in analysis.run().steps]
    regular = 3.0 / analysis.case.solver.control.steps.automatic
    assert travels[0] == pytest.approx(0.45 * regular, rel=1e-12)
    assert np.diff(travels)[0] == pytest.approx(0.45 * 0.9 / 1.1 * regular, rel=1e-12)
    assert np.diff(travels)[1] == pytest.approx(1.5 * np.diff(travels)[0], rel=1e-12)
    assert travels[-1] == pytest.approx(3.0, abs=1e-12)
    assert asked[:2] == [0.0, 0.0]
    assert asked[2:4] == pytest.approx([0.9 / 1.1, 1.5])


@pytest.mark.parametrize(("ends", "to"), [("clamped", "{travel: 15}"), ("seats", "block")])
def test_equal_steps_estimate_their_error(example, ends, to):
    """Eight steps against forty; estimated over true, force and set: 0.85 and 1.7 clamped, 0.68 and 4.4 with contact.

    The set with contact is off by 0.03 of 13 mm; with 6 to 16 steps the ratio is 1.7 to 4.4.
    """
    few, many = 8, 40
    coarse, told = run(example, *COARSE, f"ends={ends}", f"loading=[{{to: {to}, steps: {few}}}, {BACK}]")
    fine, _ = run(example, *COARSE, f"ends={ends}", f"loading=[{{to: {to}, steps: {many}}}, {BACK}]")
    force = fine.steps[many - 1].force_N - coarse.steps[few - 1].force_N
    assert 1 / 3 < coarse.steps[few - 1].steps_force_error_N / force < 3
    set_error = fine.steps[-1].travel_mm - coarse.steps[-1].travel_mm
    own = told["estimated_errors"]["steps"]
    assert 1 / 3 < own["set_mm"] / abs(set_error) < (3 if ends == "clamped" else 5)
    names = {warning["name"] for warning in told["warnings"]}
    worst = max(own["force_N"] / told["force_max_N"], own["set_mm"] / told["set_mm"])
    assert worst <= 0.002 or names & {"error", "step error"}


LINEAR = {"strain: 2.0e-4": "strain: 2.0e-6", "exponent: 6": "exponent: 4", "time_exponent: 0.2": "time_exponent: 1"}


@pytest.mark.parametrize(("changes", "unknown", "known"), [({}, [1], 3), (LINEAR, [1, 3], 4)])
def test_a_hold_in_coarse_steps_has_an_error_or_an_unknown_one(tmp_path, example, changes, unknown, known):
    """In one step the difference of its halves has the other sign; told over true in `known` steps: 0.6 to 0.7."""
    material = (Path(library.__file__).parent / "creeping.yaml").read_text()
    for old, new in changes.items():
        material = material.replace(old, new, 1)
    (tmp_path / "creeping.yaml").write_text(material)

    def hold(steps):
        loading = f"loading=[{{to: {{force: 650}}, steps: 8}}, {{hold: {{hours: 1000}}, steps: {steps}}}]"
        entries = [f"material={tmp_path}/creeping.yaml", "temperature=373.15", "spring.pitch=18", "ends=clamped"]
        return run(example, *COARSE, *entries, loading)[0].steps[-1]

    for steps in unknown:
        assert hold(steps).steps_force_error_N is None
    coarse = hold(known)
    assert 1 / 3 < coarse.steps_force_error_N / (hold(64).force_N - coarse.force_N) < 3


def test_holds_in_which_hardly_anything_creeps_keep_the_error_of_those_before(example):
    """Of a later hold each step is 100 times as long as all before it; a free spring loses forces of rounding."""
    phases = (
        "{to: {force: 650}, steps: 8}",
        "{hold: {hours: 1000}, steps: 6}",
        "{hold: {hours: 100}, steps: 3}",
        BACK,
        "{hold: {hours: 10}, steps: 4}",
    )
    entries = ["material=creeping", "temperature=373.15", "spring.pitch=18", "ends=clamped"]
    steps = run(example, *COARSE, *entries, f"loading=[{', '.join(phases)}]")[0].steps
    first, *later = (step.steps_force_error_N for step in steps if step.phase in (1, 2, 4))
    assert None not in (first, *later)
    assert later[5:8] == pytest.approx([later[4]] * 3, rel=0.1)


def test_the_example_is_within_its_accuracy(example):
    """Against Richardson's limit of 48 and 96 equal steps each way, with the error of second order."""
    (_, coarse), (_, fine) = (
        run(example, f"loading.0.steps={steps}", f"loading.1.steps={steps}") for steps in (48, 96)
    )
    _, found = run(example)
    for name, accuracy in (("force_max_N", 0.002), ("set_mm", 0.001)):
        limit = fine[name] + (fine[name] - coarse[name]) / 3.0
        assert found[name] == pytest.approx(limit, rel=accuracy)
    assert "step error" not in [warning["name"] for warning in found["warnings"]]


def test_where_the_error_is_not_known_steps_go_on(example):
    """A finer path on which the law finds no stress, once: no estimate for that step, and one for the next."""
    analysis = Analysis(read_case(example, ["mesh.elements_per_turn=8", "loading=[{to: {travel: 9}}]"]), MPI.COMM_SELF)
    _, finer = analysis.continuation.step_error._finer._blocks[0]
    update, first_halves = finer.update, []

    def fail_once(*args):
        first_halves.append(np.shares_memory(args[1]["strain"], analysis.rod.state["strain"].equilibrium))
        return not (first_halves[-1] and first_halves.count(True) == 3) and update(*args)

    finer.update = fail_once
    result = analysis.run()
    assert result.complete
    known = [step.steps_force_error_N is not None for step in result.steps]
    assert known[:5] == [True, True, False, True, True]
    assert np.isfinite(result.steps[-1].steps_force_error_N)
