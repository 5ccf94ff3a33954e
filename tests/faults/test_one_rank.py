"""An error on one of several ranks ends all of them, with one line."""

import subprocess
import sys

import pytest

from coilset.model.processes import mpi_environment, mpirun

PROGRAM = """
import sys
from mpi4py import MPI
from coilset.meshes.errors import InputError
from coilset.scripts import main

main.TOGETHER = 1.0

@main.app.command()
def fail(where: int):
    if where in (MPI.COMM_WORLD.rank, -1):
        raise InputError("is wrong", "place")
    MPI.COMM_WORLD.barrier()

sys.argv = ["coilset", "fail", "--", sys.argv[1]]
main.run()
"""


@pytest.mark.parametrize("where", [-1, 0, 1])
def test_an_error_on_one_rank_ends_all(tmp_path, where):
    command = [*mpirun(2), sys.executable, "-c", PROGRAM, str(where)]
    done = subprocess.run(command, cwd=tmp_path, env=mpi_environment(), capture_output=True, text=True, timeout=100,
                          check=False)  # fmt: skip
    assert done.returncode == 2
    lines = [line for line in done.stderr.splitlines() if line.startswith("coilset:")]
    assert lines == ["coilset: place: is wrong"]
    assert "Traceback" not in done.stderr
