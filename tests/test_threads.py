"""Sections that are divided among threads: the same numbers, and nobody at work any more when something is raised."""

import time

import numpy as np
import pytest
from mpi4py import MPI

from coilset.model.analysis import Analysis
from coilset.model.case import read_case
from coilset.model.rod import section_states
from coilset.model.threads import Threads


def test_shares_are_even_and_large_enough():
    assert Threads(3).shares(10, 1) == [slice(0, 3), slice(3, 6), slice(6, 10)]
    assert Threads(3).shares(10, 5) == [slice(0, 5), slice(5, 10)]
    assert Threads(3).shares(10, 11) == [slice(0, 10)]
    assert Threads(3).shares(0, 4) == [slice(0, 0)]


@pytest.mark.parametrize("failing", [0, 1, 2])
def test_what_one_share_raises_comes_when_all_have_ended(failing):
    ended = []

    def work(share):
        if share == failing:
            raise ArithmeticError(f"share {share}")
        time.sleep(0.01)
        ended.append(share)

    with pytest.raises(ArithmeticError, match=f"share {failing}"):
        Threads(3).map(work, [0, 1, 2])
    assert sorted(ended) == sorted({0, 1, 2} - {failing})


@pytest.mark.parametrize("kept", [4096, 8], ids=["kept", "passing"])
def test_threads_change_no_bit(example, monkeypatch, kept):
    """Of points on trial that are kept, and of a long rod's, of which each thread keeps one element's."""
    monkeypatch.setattr(section_states, "KEPT", kept)
    monkeypatch.setattr(section_states, "LEAST", 64)
    settings = ["loading.0.to={travel: 6}", "loading.0.steps=2", "loading.1.steps=1",
                "mesh.section.radial=2", "mesh.section.angular=8"]  # fmt: skip
    found = []
    for threads in (1, 2, 3):
        analysis = Analysis(read_case(example, settings), MPI.COMM_SELF, threads=threads)
        assert len(analysis.rod._points.shares) == threads
        analysis.run()
        found.append([analysis.result.steps[-1].force_N, *analysis.rod.surface_state.ravel()])
    assert np.ptp(found, axis=0).max() == 0.0
    assert np.abs(found).max() > 1.0
