"""Active turns of a spring that is released, from the reactions of its seats."""

import numpy as np
import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.core.case import read_case


def test_active_turns_of_a_spring_that_has_set_are_those_of_its_state(example):
    """Held tips keep a torque that goes with no force: it counts the more the smaller the force, both ways alike."""
    loading = "loading=[{to: {travel: 13}, steps: 7}, {to: {force: 0}, steps: 5}, {to: {force: 100}, steps: 2}]"
    settings = ["mesh.elements_per_turn=8", "mesh.section.rule=abramowitz9", "accuracy=none", loading]
    result = Analysis(read_case(example, settings), MPI.COMM_SELF).run()
    active = np.array([one.active_turns for one in result.seats])
    forces = np.array([one.force_N for one in result.steps])
    assert np.all(np.diff(forces[7:12]) < 0)
    assert np.all(np.diff(active[6:11]) > 0)
    assert np.isnan(active[11])  # free of load
    again = np.interp(1 / forces[12:], 1 / forces[7:11], active[7:11])
    assert active[12:] == pytest.approx(again, rel=0.02)
