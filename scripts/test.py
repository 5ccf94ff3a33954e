"""`coilset test`: the whole test suite, what is quick first, and the tests marked mpi again on 2 and 3 ranks."""

import subprocess
import sys
from pathlib import Path

from coilset.meshes.errors import InputError
from coilset.model.processes import mpi_environment, mpirun

REPOSITORY = Path(__file__).resolve().parent.parent
# tests that solve springs or solids to their end, or start the command: minutes, where all others take seconds
SOLVES = ["benchmarks", "commands", "examples", "install", "meshes/test_solved_springs.py", "solid", "spring", "sweep",
          "verification"]  # fmt: skip


def test(arguments: list[str]) -> int:
    """Run pytest, with arguments once, else stage by stage; returns the exit code of the first that fails, else 0.

    Raises:
        InputError: in an installation, which has no tests.
    """
    if not (REPOSITORY / "tests").is_dir():
        raise InputError("the tests are in coilset's repository; there, run scripts/coilset test", "test")
    pytest = [sys.executable, "-m", "pytest", *arguments]
    if arguments:
        return run("tests on one rank", pytest)
    solves = [f"tests/{name}" for name in SOLVES]
    status = run("tests of parts", [*pytest, *(f"--ignore={path}" for path in solves)])
    status = status or run("tests of whole solves", [*pytest, *solves])
    for ranks in (2, 3):
        command = [*mpirun(ranks), *pytest, "-m", "mpi"]
        status = status or run(f"tests on {ranks} ranks", command, mpi_environment())
    return status


def run(title: str, command: list[str], environment: dict[str, str] | None = None) -> int:
    """Say what is run, and run it from the repository's folder."""
    print(f"coilset: {title}", flush=True)
    return subprocess.run(command, cwd=REPOSITORY, check=False, env=environment).returncode
