"""Elements much shorter than the wire is thick: rounding of the rotation matrices, times E I/l, must pass for rest."""

import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.core.case import read_case

PRESS = ["loading=[{to: {travel: 6}, steps: 3}]", "mesh.section.rule=abramowitz9", "accuracy=none"]


@pytest.mark.parametrize("ends", ["clamped", "seats"])
def test_a_thousand_elements_a_turn_are_no_obstacle(example, ends):
    """2,560 elements of 0.12 mm with default settings: no step is cut, and the force is that of 160 elements."""
    runs = {}
    for per_turn in (64, 1024):
        case = read_case(example, [*PRESS, f"ends={ends}", f"mesh.elements_per_turn={per_turn}"])
        runs[per_turn] = Analysis(case, MPI.COMM_SELF).run()
    coarse, fine = runs[64], runs[1024]
    assert [step.cuts for step in fine.steps] == [0, 0, 0]
    assert max(step.iterations for step in fine.steps) <= 8
    assert fine.rate == pytest.approx(coarse.rate, rel=5e-6)
    assert fine.steps[-1].force_N == pytest.approx(coarse.steps[-1].force_N, rel=1e-5)
