"""When tangents are built with the section forces that a correction predicts."""

import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.core.case import read_case

CLAMPED = ["ends=clamped", "mesh={elements_per_turn: 10, section: {rule: abramowitz9}}"]


@pytest.fixture
def make(example):
    """The example between clamped heads, where no contact; further entries."""
    return lambda *entries: Analysis(read_case(example, [*CLAMPED, *entries]), MPI.COMM_SELF)


def solve(analysis):
    """A step of 2 mm."""
    return analysis.newton.solve(analysis.control.to_height(analysis.control.height - 2.0))


def shares_of(analysis, monkeypatch, factor=1.0):
    """The shares of corrections whose predicted forces tangents are built with, after those are wrong by a factor."""
    shares, tangents = [], analysis.rod.element_tangents

    def recorded(share=None):
        shares.append(share)
        return tangents(None if share is None else factor * share)

    monkeypatch.setattr(analysis.rod, "element_tangents", recorded)
    return shares


@pytest.mark.parametrize(("value", "predicts"), [("null", True), ("true", True), ("false", False)])
@pytest.mark.parametrize("entry", ["predicted_forces", "foreseen_forces"])
def test_forces_are_predicted_unless_switched_off(make, monkeypatch, entry, value, predicts):
    """By the entry's earlier name as well, with a notice."""
    analysis = make(f"solver.control.newton.{entry}={value}")
    shares = shares_of(analysis, monkeypatch)
    assert solve(analysis).converged
    assert analysis.newton.iteration.predicted == predicts
    assert any(share is not None for share in shares) == predicts
    assert None in shares  # the first tangent of all, which no correction precedes
    assert any("predicted_forces" in line for line in analysis.case.notices()) == (entry == "foreseen_forces")


def test_a_step_that_fails_with_predicted_forces_is_solved_again_with_the_actual_ones(make, monkeypatch):
    """Wrong ones here; the next step is predicted all the same, and without them the first solve would have done."""
    analysis, plain = make(), make("solver.control.newton.predicted_forces=false")
    shares = shares_of(analysis, monkeypatch, 1e6)
    for _step in range(2):
        shares.clear()
        outcome, alone = solve(analysis), solve(plain)
        assert outcome.converged
        assert any(share is not None for share in shares)
        assert outcome.evaluations > alone.evaluations
        for one in (analysis, plain):
            one.system.commit()
    assert analysis.control.force == pytest.approx(plain.control.force, rel=1e-7)
