"""Sections that are divided among threads: the same numbers."""

import threading

import numpy as np
import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.core.case import read_case
from coilset.model.core.rod import section_states
from coilset.model.core.runtime import threads
from coilset.model.core.runtime.threads import LEAST, Threads


def test_parts_are_even_and_large_enough():
    assert Threads(3).ends(10, LEAST).tolist() == [0, 3, 6, 10]
    assert Threads(3).ends(10, LEAST // 4).tolist() == [0, 5, 10]
    assert Threads(3).ends(10, LEAST // 10).tolist() == [0, 10]
    assert Threads(3).ends(0, LEAST).tolist() == [0, 0]
    assert Threads(3).ends(1, 3 * LEAST).tolist() == [0, 1]


def test_parts_run_side_by_side_and_one_that_fails_is_reported():
    """Each part has its own number; a part without a result counts as good. One call without sections comes before."""
    barrier, numbers = threading.Barrier(2, timeout=30.0), []

    def part(ends, number, result):
        if ends[-1] == 0:
            assert threading.current_thread() is threading.main_thread()
            return None
        barrier.wait()
        numbers.append(number)
        return result if number else None

    assert Threads(2).run(part, 10, LEAST, True)
    assert not Threads(2).run(part, 10, LEAST, False)
    assert sorted(numbers) == [0, 0, 1, 1]


@pytest.mark.parametrize("kept", [4096, 8], ids=["kept", "passing"])
def test_threads_change_no_bit(example, monkeypatch, kept):
    """Of points on trial that are kept, and of a long rod's, of which each thread keeps one element's."""
    monkeypatch.setattr(section_states, "KEPT", kept)
    monkeypatch.setattr(threads, "LEAST", 64)
    settings = [
        "loading.0.to={travel: 6}",
        "loading.0.steps=2",
        "loading.1.steps=1",
        "mesh.section.radial=2",
        "mesh.section.angular=8",
    ]
    found = []
    for number in (1, 2, 3):
        analysis = Analysis(read_case(example, settings), MPI.COMM_SELF, threads=number)
        assert len(analysis.rod.sections.threads.ends(len(analysis.rod.radius), 2 * 16)) == number + 1
        analysis.run()
        found.append([analysis.result.steps[-1].force_N, *analysis.rod.surface_state.ravel()])
    assert np.ptp(found, axis=0).max() == 0.0
    assert np.abs(found).max() > 1.0
