"""`coilset test`: the whole test suite, and the tests marked mpi again on 2 and 3 ranks."""

import subprocess
import sys
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parent.parent
MPIRUN = ["mpirun", "--oversubscribe", "--mca", "btl", "self,sm"]


def test(arguments):
    """Run pytest; returns its exit code, the first that is not zero."""
    pytest = [sys.executable, "-m", "pytest", *arguments]
    print("coilset: tests on one rank", flush=True)
    status = subprocess.run(pytest, cwd=REPOSITORY, check=False).returncode
    if arguments:
        return status
    for ranks in (2, 3):
        print(f"coilset: tests on {ranks} ranks", flush=True)
        command = [*MPIRUN, "-n", str(ranks), *pytest, "-m", "mpi"]
        status = status or subprocess.run(command, cwd=REPOSITORY, check=False).returncode
    return status
