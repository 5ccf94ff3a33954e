"""Finer runs: what is made finer, by how much, and what is kept."""

import json
import re
from dataclasses import replace

import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.run_warnings import run_warnings
from coilset.model.core.case import read_case
from coilset.model.core.results.records.record import Errors, RunErrors
from coilset.model.tools.further_runs.refinement import left_open, left_out, needed, within_accuracy
from coilset.scripts.commands.solve import solve
from coilset.scripts.interrupt import Interrupt

ALL = {"steps", "mesh", "section", "contact"}
FINE = ["mesh={}", "ends=clamped", "accuracy=0.02 %", "loading=[{to: {travel: 14}}, {to: {force: 0}}]"]


def errors(steps, mesh, section, contact):
    """Of the force."""
    return RunErrors(*(Errors(part, None, None) for part in (steps, mesh, section, contact, 0.0)))


def test_only_what_counts_is_made_finer_by_its_order():
    found = needed(errors(0.05, 1.0, 0.02, 0.5), {"force_N": 1.0}, ALL)
    assert found.keys() == {"mesh", "contact"}
    share = (0.9 - 0.07) / 1.5  # of both errors may be left
    assert found["mesh"] ** -1.5 == pytest.approx(share)
    assert found["contact"] ** -0.6 == pytest.approx(share)


@pytest.mark.parametrize(
    ("parts", "left"),
    [
        ((0.1, 0.5, 0.1, 0.1), ALL),  # accurate
        ((0.1, 9.0, 0.1, 0.1), ALL),  # four times as many elements would not do
        ((0.1, 2.0, 0.1, 0.1), ALL - {"mesh"}),  # the mesh is given
        ((0.1, None, 0.1, 0.1), ALL),  # not known
    ],
)
def test_nothing_is_run_again_where_it_need_not_or_would_not_suffice(parts, left):
    assert needed(errors(*parts), {"force_N": 1.0}, left) == {}


def test_a_number_out_of_reach_does_not_keep_others_from_being_made_finer():
    found = RunErrors(
        *(Errors(force, set_, None) for force, set_ in ((0.1, 0.1), (1.0, 9.0), (0.1, 0.1), (0.1, 0.1), (0.0, 0.0)))
    )
    assert needed(found, {"force_N": 1.0, "set_mm": 1.0}, ALL) == needed(
        errors(0.1, 1.0, 0.1, 0.1), {"force_N": 1.0}, ALL
    )
    assert needed(found, {"set_mm": 1.0}, ALL) == {}


def test_a_number_that_would_cost_too_much_does_not_keep_others_from_being_made_finer():
    """As the set of a valve spring, 0.6 mm: the force is brought within the accuracy alone."""
    pairs = ((0.1, 0.3), (1.0, 3.0), (0.1, 1.0), (0.1, 0.3), (0.0, 0.0))
    found = RunErrors(*(Errors(force, set_, None) for force, set_ in pairs))
    both = {"force_N": 1.0, "set_mm": 1.0}
    assert needed(found, both, ALL) == needed(found, {"force_N": 1.0}, ALL)
    assert needed(found, both, ALL, 100.0)["section"] > 2.0
    assert needed(found, both, ALL, 1.1) == {}


PRESSED = ["mesh={}", "accuracy=0.05 %", "loading=[{to: {travel: 10}}]"]


def test_what_is_left_out_is_stated_with_its_cost(example, monkeypatch):
    """Advice to make finer what the program had made finer, or had left out as too long, is no advice."""
    analysis = Analysis(read_case(example, PRESSED), MPI.COMM_SELF)
    result = analysis.run()

    def after(found, left=ALL):
        monkeypatch.setattr(analysis.recorder, "result", replace(result, errors=found))
        return left_out(analysis, left)

    F = result.greatest_force
    assert after(errors(0.0, 1e-4 * F, 0.0, 0.0)) == ""  # accurate
    assert after(errors(0.0, 1e-2 * F, 0.0, 0.0), ALL - {"mesh"}) == ""  # its mesh is given: the advice is to change it
    assert after(errors(0.0, 0.0, 0.01 * F, 0.0)).startswith("a run with 38 × 96 points per section, about 22 times")
    out_of_reach = "no finer run of a reasonable length would bring it there"
    assert after(errors(0.0, 1.0 * F, 0.0, 0.0)) == out_of_reach
    assert after(errors(0.0, 2e-3 * F, 1e-3 * F, 0.0), ALL - {"section"}) == out_of_reach  # of the section's part
    assert re.fullmatch(
        r"a run with 40 elements per turn, about 2\.\d times as long, was left out",
        after(errors(0.0, 1.65e-3 * F, 0.0, 0.0)),
    )


def test_the_warning_says_what_was_left_out(example, monkeypatch):
    """Of a run that would be finer if that might take any longer."""
    monkeypatch.setattr("coilset.model.tools.further_runs.refinement.MOST", 1.0)
    analysis = Analysis(read_case(example, FINE), MPI.COMM_SELF)
    last = within_accuracy(analysis, lambda one, finer: one.run())
    (warning,) = (one for one in run_warnings(last.setup, last.result) if one.name == "error")
    assert last is analysis
    assert re.search(r"allows; a run with .*, about \d\S* times as long, was left out$", warning.message)


def test_entries_of_the_case_are_kept(example):
    plain = ["mesh={}", "loading=[{to: block}]"]
    assert left_open(read_case(example, plain)) == ALL
    assert left_open(read_case(example, [*plain, "mesh.elements_per_turn=16"])) == ALL - {"mesh"}
    assert left_open(read_case(example, [*plain, "mesh.section.radial=8"])) == ALL - {"section"}
    assert left_open(read_case(example, [*plain, "contact.bedding=5000"])) == ALL - {"contact"}
    assert left_open(read_case(example, ["mesh={}", "loading=[{to: block, steps: 4}]"])) == ALL - {"steps"}


def test_a_finer_run_is_within_the_accuracy_and_can_be_continued(example, tmp_path, monkeypatch):
    """Ended in the last finer run, after which the results are those of the one before; continued, to the same bits."""
    counts = []

    def solved(name, last=10_000, resume=False):
        checks = iter(range(last))
        with monkeypatch.context() as patched:
            patched.setattr(Interrupt, "check", lambda self: next(checks, None) is None and _interrupt())
            solve(example, tmp_path / name, False, FINE, resume=resume, comm=MPI.COMM_SELF, voice="quiet")
        counts.append(next(checks, last))
        return summary(name)

    def summary(name):
        found = json.loads((tmp_path / name / "summary.json").read_text())
        return found | {"origin": found["origin"]["case"]}  # without the time

    whole = solved("whole")
    assert whole["estimated_force_error_N"] < 2e-4 * whole["force_max_N"]
    mesh = whole["origin"]["mesh"]
    assert mesh["elements_per_turn"] > 16.0
    assert mesh["section"]["radial"] > 8
    assert not [one for one in whole["warnings"] if one["name"] == "error"]
    with pytest.raises(KeyboardInterrupt):
        solved("ended", counts[0] - 5)
    assert summary("ended")["origin"]["mesh"]["elements_per_turn"] < mesh["elements_per_turn"]
    assert solved("ended", resume=True) == whole
    assert counts[1] < 10  # steps that were left


def _interrupt():
    raise KeyboardInterrupt
