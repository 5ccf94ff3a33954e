"""When tangents are built with the forces that a correction foresees."""

import pytest
from mpi4py import MPI

from coilset.model.case import read_case
from coilset.model.run.analysis import Analysis

CLAMPED = ["ends=clamped", "mesh={elements_per_turn: 10, section: {rule: abramowitz9}}"]


@pytest.fixture
def make(example):
    """The example between clamped heads, where nothing touches; further entries."""
    return lambda *entries: Analysis(read_case(example, [*CLAMPED, *entries]), MPI.COMM_SELF)


def solve(analysis):
    """A step of 2 mm."""
    return analysis.newton.solve(analysis.control.to_height(analysis.control.height - 2.0))


@pytest.mark.parametrize(("entry", "foresees"), [("null", True), ("true", True), ("false", False)])
def test_forces_are_foreseen_unless_the_case_says_no(make, monkeypatch, entry, foresees):
    analysis, asked = make(f"solver.control.newton.foreseen_forces={entry}"), []
    monkeypatch.setattr(analysis.rod, "foresee", asked.append)
    assert solve(analysis).converged
    assert (analysis.newton.foreseeing is not None) == foresees
    assert bool(asked) == foresees


def test_a_step_that_fails_with_foreseen_forces_is_solved_again_with_the_true_ones(make, monkeypatch):
    """Wrong ones here; the next step is foreseen all the same, and without them the first solve would have done."""
    analysis, plain = make(), make("solver.control.newton.foreseen_forces=false")
    foresee, asked = analysis.rod.foresee, []

    def wrong(length):
        asked.append(length)
        foresee(1e6 * length)

    monkeypatch.setattr(analysis.rod, "foresee", wrong)
    for _step in range(2):
        asked.clear()
        outcome, alone = solve(analysis), solve(plain)
        assert outcome.converged
        assert asked
        assert outcome.evaluations > alone.evaluations
        for one in (analysis, plain):
            one.system.commit()
    assert analysis.control.force == pytest.approx(plain.control.force, rel=1e-7)
