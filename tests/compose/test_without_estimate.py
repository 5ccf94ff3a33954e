"""`accuracy: none`: equal steps find the same states to the last bit, and nothing is spent on what they leave wrong."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.summary import summarise
from coilset.model.core.base.errors import InputError
from coilset.model.core.case import check, read_case
from coilset.model.core.case.case import read_case_data
from coilset.model.core.results.files.checkpoint import Checkpoint
from coilset.model.tools.report.answer import answer
from coilset.model.tools.sweep.rehearsal import build_input
from coilset.scripts.commands.solve import solve
from coilset.scripts.terminal.interactive import Prompt

SMALL = ["mesh.elements_per_turn=10", "mesh.section.rule=abramowitz9"]
PROGRAM = "[{to: block, steps: 5}, {to: {force: 0}, steps: 4}]"
SETTINGS = [*SMALL, f"loading={PROGRAM}"]
NONE = "accuracy=none"


def run(example, *settings):
    analysis = Analysis(read_case(example, settings), MPI.COMM_SELF)
    analysis.run()
    return analysis


def without_errors(result):
    names = [f"{cause}_{number}" for cause in ("steps", "estimated") for number in ("force_error_N", "height_error_mm")]
    return [replace(step, **dict.fromkeys(names)) for step in result.steps]


def test_equal_steps_find_the_same_to_the_last_bit(example):
    known, bare = run(example, *SETTINGS), run(example, *SETTINGS, NONE)
    assert all(step.steps_force_error_N is not None for step in known.result.steps)
    assert list(bare.result.steps) == without_errors(known.result)
    np.testing.assert_array_equal(bare.rod.point_state, known.rod.point_state)
    names = [name for name, _ in bare.rod.state.items()]
    assert not [name for name in names if "finer" in name or "error" in name]
    told, summary = (summarise(one.setup, one.result) for one in (known, bare))
    changed = {name for name, value in summary.items() if value != told[name]}
    estimates = {name for name in summary if name.startswith("estimated_")}
    assert changed == {name for name in estimates if told[name] is not None} | {"warnings"}
    assert {summary[name] for name in estimates} == {None}
    assert {one["name"] for one in told["warnings"]} - {one["name"] for one in summary["warnings"]} == {"error"}
    assert next(one.remark for one in answer(summary) if one.term == "maximum force").endswith("not estimated")


@pytest.mark.parametrize("settings", [[NONE, f"loading={PROGRAM}"], [NONE, "loading=[{to: block, steps: [0.5, 1]}]"]])
def test_all_phases_give_their_steps(example, settings):
    case = read_case(example, settings)
    assert case.accuracy == "none"
    assert case.steps_error is None
    build_input(case)


def test_automatic_steps_need_the_estimate(example, tmp_path):
    """From a file, in a sweep's case, and where a target is typed."""
    settings = [*SMALL, NONE, "loading=[{to: block, steps: 5}, {to: {force: 0}}]"]
    words = "loading.1.steps: automatic steps follow the error that accuracy: none leaves unknown; give a number"
    with pytest.raises(InputError) as caught:
        solve(example, tmp_path / "out", False, settings)
    assert str(caught.value).startswith(f"{example}: {words}")
    assert not (tmp_path / "out").exists()
    with pytest.raises(InputError, match=words):
        build_input(read_case(example, settings))
    analysis = Analysis(read_case(example, [*SETTINGS, NONE]), MPI.COMM_SELF)
    with pytest.raises(InputError, match="automatic"):
        Prompt(analysis, print).obey("to", "{travel: 4}")
    Prompt(analysis, print).obey("to", "{travel: 4}, steps: 1")
    assert analysis.run().steps[0].travel_mm == pytest.approx(4.0)


def test_other_words_are_no_accuracy(example):
    with pytest.raises(InputError, match="'nothing': must be a number, or none"):
        check(read_case_data(example) | {"accuracy": "nothing"})
    with pytest.raises(InputError, match="accuracy"):
        check(read_case_data(example) | {"accuracy": None})


def test_a_run_goes_on_without_an_estimate_but_not_with_one_again(example, tmp_path):
    """Without one as it began; from one that was estimated too, but no error is known of steps that were not."""
    whole = run(example, *SETTINGS, NONE)
    cases = [read_case(example, [*SETTINGS, accuracy]) for accuracy in (NONE, "accuracy=0.2 %")]
    for number, case in enumerate(cases):
        folder = tmp_path / str(number)
        begun, checkpoint = Analysis(case, MPI.COMM_SELF), Checkpoint(folder, case)

        def stop(step):
            if step.number == 6:
                raise KeyboardInterrupt

        with pytest.raises(KeyboardInterrupt):
            begun.run(stop, save=checkpoint.save)
        resumed = Analysis(cases[0], MPI.COMM_SELF)
        resumed.resume(Checkpoint(folder, cases[0]).load(MPI.COMM_SELF))
        resumed.run()
        assert without_errors(resumed.result) == list(whole.result.steps)
        assert resumed.result.steps[-1].steps_force_error_N is None
    with pytest.raises(InputError, match="accuracy: the errors of its steps were not estimated"):
        Checkpoint(tmp_path / "0", cases[1]).load(MPI.COMM_SELF)
