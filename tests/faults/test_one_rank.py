"""An error on one of several ranks ends all of them, with one line."""

import subprocess
import sys

import pytest

from coilset.model.core.runtime.processes import mpi_environment, mpirun

PROGRAM = """
import sys
from mpi4py import MPI
from coilset.model.core.base.errors import InputError
from coilset.scripts import main, running

running.TOGETHER = 1.0

@main.app.command()
def fail(where: int):
    if where in (MPI.COMM_WORLD.rank, -1):
        raise InputError("is wrong", "place")
    MPI.COMM_WORLD.barrier()

sys.argv = ["coilset", "fail", "--", sys.argv[1]]
running.run()
"""


def fail(where, folder, program=PROGRAM):
    command = [*mpirun(2), sys.executable, "-c", program, str(where)]
    return subprocess.run(
        command, cwd=folder, env=mpi_environment(), capture_output=True, text=True, timeout=100, check=False
    )


@pytest.mark.parametrize("where", [-1, 0, 1])
def test_an_error_on_one_rank_ends_all(tmp_path, where):
    done = fail(where, tmp_path)
    assert done.returncode == 2
    lines = [line for line in done.stderr.splitlines() if line.startswith("coilset:")]
    assert lines == ["coilset: place: is wrong"]
    assert "Traceback" not in done.stderr


def test_an_unforeseen_error_on_one_rank_ends_all(tmp_path):
    """A defect of the program: with its traceback, but the other rank does not wait for ever."""
    done = fail(1, tmp_path, PROGRAM.replace('InputError("is wrong", "place")', 'IndexError("unforeseen")'))
    assert done.returncode == 1
    assert "IndexError: unforeseen" in done.stderr


@pytest.mark.parametrize("where", [-1, 0, 1])
def test_an_interruption_of_one_rank_ends_all(tmp_path, where):
    """The other one waits inside MPI, as for the pictures, where Python hears of no signal."""
    done = fail(where, tmp_path, PROGRAM.replace('InputError("is wrong", "place")', "KeyboardInterrupt"))
    assert done.returncode == 130
    lines = [line for line in done.stderr.splitlines() if line.startswith("coilset:")]
    assert lines == ([] if where == 1 else ["coilset: interrupted"])
    assert "Traceback" not in done.stderr
