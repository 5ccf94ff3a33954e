"""Signals in the midst of a step: SIGTERM leaves it, SIGINT lets it end, and what was found before is kept."""

import json
import os
import signal
import time

import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.errors import SolveError
from coilset.model.core.equilibrium.system.system import System
from coilset.scripts.commands.solve import solve

SMALL = ["mesh.elements_per_turn=8", "mesh.section.rule=abramowitz9", "accuracy=none"]
STEPS = "loading=[{to: {travel: 2}, steps: 4}]"


class Drawings:
    """None may be drawn."""

    def draw(self, folder):
        raise AssertionError(folder)


def results(folder):
    return json.loads((folder / "summary.json").read_text())


@pytest.fixture
def during_step(monkeypatch):
    """Something that happens at the first evaluation of a step; gives when the evaluations after it began."""

    def happen(number, what):
        own, later = System.residual, []
        begun = []
        run = Analysis.run

        def counted(analysis, report, *arguments):
            def told(step):
                begun.append(step.number)
                report(step)

            return run(analysis, told, *arguments)

        def residual(system, *arguments):
            if later:
                later.append(time.monotonic())
            elif len(begun) == number - 1:
                later.append(time.monotonic())
                what()
            return own(system, *arguments)

        monkeypatch.setattr(Analysis, "run", counted)
        monkeypatch.setattr(System, "residual", residual)
        return later

    return happen


def test_sigterm_leaves_the_step(example, tmp_path, during_step):
    """No further evaluation of it, no pictures; the results of the two steps before are written."""
    later = during_step(3, lambda: os.kill(os.getpid(), signal.SIGTERM))
    before = [signal.getsignal(number) for number in (signal.SIGTERM, signal.SIGALRM)]
    with pytest.raises(KeyboardInterrupt):
        solve(example, tmp_path / "out", False, [*SMALL, STEPS], drawings=Drawings(), comm=MPI.COMM_SELF)
    assert len(later) == 1
    assert results(tmp_path / "out")["steps"] == 2
    assert not results(tmp_path / "out")["complete"]
    assert [signal.getsignal(number) for number in (signal.SIGTERM, signal.SIGALRM)] == before
    assert signal.getitimer(signal.ITIMER_REAL)[0] == 0.0
    solve(example, tmp_path / "out", False, [*SMALL, STEPS], resume=True, comm=MPI.COMM_SELF)
    assert results(tmp_path / "out")["complete"]


def test_sigterm_between_steps_leaves_the_next(example, tmp_path, monkeypatch):
    """Where no step is being solved it waits until one is."""
    touch = Analysis.initial_rate

    def signalled(analysis):
        found = touch(analysis)
        os.kill(os.getpid(), signal.SIGTERM)
        return found

    monkeypatch.setattr(Analysis, "initial_rate", signalled)
    with pytest.raises(KeyboardInterrupt):
        solve(example, tmp_path / "out", False, [*SMALL, STEPS], comm=MPI.COMM_SELF)
    assert results(tmp_path / "out")["steps"] == 0


def test_sigint_lets_the_step_end(example, tmp_path, during_step):
    later = during_step(3, lambda: os.kill(os.getpid(), signal.SIGINT))
    with pytest.raises(KeyboardInterrupt):
        solve(example, tmp_path / "out", False, [*SMALL, STEPS], comm=MPI.COMM_SELF)
    assert len(later) > 1
    assert results(tmp_path / "out")["steps"] == 3


def test_a_step_that_was_to_end_and_fails_is_still_an_interruption(example, tmp_path, monkeypatch, capsys):
    """The user has stopped the run; why its last step failed is said all the same."""
    run = Analysis.run

    def fails(analysis, report, *arguments):
        def told(step):
            report(step)
            if step.number == 2:
                os.kill(os.getpid(), signal.SIGINT)
                raise SolveError("no equilibrium beyond here")

        return run(analysis, told, *arguments)

    monkeypatch.setattr(Analysis, "run", fails)
    with pytest.raises(KeyboardInterrupt):
        solve(example, tmp_path / "out", False, [*SMALL, STEPS], comm=MPI.COMM_SELF)
    assert "no equilibrium beyond here" in capsys.readouterr().out
    assert results(tmp_path / "out")["steps"] == 2
