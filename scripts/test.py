"""`coilset test`: the whole test suite, and the tests marked mpi again on 2 and 3 ranks."""

import subprocess
import sys
from pathlib import Path

from coilset.meshes.errors import InputError
from coilset.model.processes import mpi_environment, mpirun

REPOSITORY = Path(__file__).resolve().parent.parent


def test(arguments):
    """Run pytest; returns its exit code, the first that is not zero.

    Raises:
        InputError: in an installation, which has no tests.
    """
    if not (REPOSITORY / "tests").is_dir():
        raise InputError("the tests are in coilset's repository; there, run scripts/coilset test", "test")
    pytest = [sys.executable, "-m", "pytest", *arguments]
    print("coilset: tests on one rank", flush=True)
    status = subprocess.run(pytest, cwd=REPOSITORY, check=False).returncode
    if arguments:
        return status
    for ranks in (2, 3):
        print(f"coilset: tests on {ranks} ranks", flush=True)
        command = [*mpirun(ranks), *pytest, "-m", "mpi"]
        done = subprocess.run(command, cwd=REPOSITORY, check=False, env=mpi_environment())
        status = status or done.returncode
    return status
