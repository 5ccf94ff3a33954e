"""A cold start says so, a warm one does not."""

import logging
import os
import subprocess
import sys

import numba
import pytest

from coilset.scripts.compiling import NOTICE, announce_compiling, announce_if_cold

SMALL = ["--set", "loading=[{to: {travel: 2}, steps: 1}]", "--set", "mesh.elements_per_turn=8", "--no-pictures"]


@pytest.fixture
def announced():
    """An announcement, and what it says; FFCx's logger is as before afterwards."""
    logger, said = logging.getLogger("ffcx"), []
    before = (list(logger.handlers), logger.level, logger.propagate)
    yield announce_compiling(said.append), said
    del logger.setLevel
    logger.handlers, logger.propagate = before[0], before[2]
    logger.setLevel(before[1])


def test_numba_compiling_is_said_once(announced):
    _, said = announced
    kernels = [numba.njit(lambda x: x + 1.0), numba.njit(lambda x: x + 2.0)]
    assert said == []
    assert [kernel(1.0) for kernel in kernels] == [2.0, 3.0]
    assert said == [NOTICE]


def test_ffcx_is_heard_whatever_level_it_sets(announced):
    _, said = announced
    logger = logging.getLogger("ffcx")
    logger.setLevel(logging.WARNING)
    logger.info("Final option values")  # said for forms from its cache, too
    assert said == []
    logger.info("Compiler stage 1: Analyzing UFL objects")
    assert said == [NOTICE]
    logger.warning("what a user should read")
    assert said == [NOTICE, "what a user should read"]


def test_an_empty_folder_of_kernels_is_cold(monkeypatch, tmp_path):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "none"))
    said = []
    announce_if_cold(said.append)
    assert said == [NOTICE]
    (tmp_path / "none" / "law").mkdir(parents=True)
    (tmp_path / "none" / "law" / "kernel.nbi").touch()
    announce_if_cold(said.append)
    assert said == [NOTICE]


def test_a_warm_solve_does_not_say_it(example, tmp_path):
    """The first solve may; the second finds everything compiled."""
    command = [sys.executable, "-m", "coilset.scripts", "solve", str(example), "--force", "--out", "out", *SMALL]
    first, second = (
        subprocess.run(command, cwd=tmp_path, env=dict(os.environ), capture_output=True, text=True, check=True)
        for _ in range(2)
    )
    assert first.stderr in ("", NOTICE + "\n")
    assert second.stderr == ""
