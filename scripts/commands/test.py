"""`coilset test`: the whole test suite, the tests marked mpi on 2 and 3 ranks."""

import contextlib
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from coilset.model.core.base.errors import InputError
from coilset.model.core.runtime.processes import (
    end_with_parent,
    folder_of_mpirun,
    mpi_environment,
    mpirun,
    usable_cores,
)

REPOSITORY = Path(__file__).resolve().parents[2]
# tests that solve springs or solids to the end, or start the command: minutes, where most others take seconds; both
# take about as long
SOLVES = [
    "api",
    "benchmarks",
    "commands",
    "examples",
    "install",
    "meshes/test_solved_springs.py",
    "physics/solid",
    "spring",
    "tools/identification/test_fit.py",
    "tools/spring_fit",
    "tools/sweep",
    "verification",
]


def test(arguments: list[str]) -> int:
    """Run pytest, once with arguments, else stage by stage; returns the exit code of the first failure, else 0.

    Tests marked slow are run with arguments alone. With two cores, the tests of parts and those of whole solves,
    which take one core each, run in parallel.

    Raises:
        InputError: in an installation, which has no tests.
    """
    if not (REPOSITORY / "tests").is_dir():
        raise InputError("the tests are in coilset's repository; there, run scripts/coilset test", "test")
    pytest = [sys.executable, "-m", "pytest", *(arguments or ["-q"])]
    if arguments:
        return run("tests on one rank", pytest)
    print("coilset: all tests, in serial and under MPI; some ten minutes on two cores", flush=True)
    solves = [f"tests/{name}" for name in SOLVES]
    alone = [*pytest, "-m", "not mpi and not slow"]  # mpi: these compare ranks with one
    parts = [*alone, *(f"--ignore={path}" for path in solves)]
    if usable_cores() > 1:
        with beside("tests of parts", parts) as found:
            status = run("tests of whole solves", [*alone, *solves])
        status = found[0] or status
    else:
        status = run("tests of parts", parts) or run("tests of whole solves", [*alone, *solves])
    for ranks in (2, 3):
        command = [*mpirun(ranks), *pytest, "-m", "mpi", *on_ranks()]
        with folder_of_mpirun() as folder:
            status = status or run(f"tests on {ranks} ranks", command, mpi_environment() | folder)
    return status


def on_ranks() -> list[str]:
    """The files with tests marked mpi: each rank imports what it collects, and all files take it ten seconds more."""
    files = (REPOSITORY / "tests").rglob("test_*.py")
    return sorted(str(file) for file in files if "mark.mpi" in file.read_text(encoding="utf-8"))


@contextlib.contextmanager
def beside(title: str, command: list[str]) -> Iterator[list[int]]:
    """Run a command in parallel with the block; then print its output and append its exit code to the list."""
    status: list[int] = []
    with tempfile.TemporaryFile() as said:
        process = subprocess.Popen(
            command, cwd=REPOSITORY, stdout=said, stderr=subprocess.STDOUT, preexec_fn=end_with_parent
        )
        try:
            yield status
            status.append(process.wait())
        finally:
            process.kill()
            process.wait()
        said.seek(0)
        print(f"coilset: {title}", flush=True)
        sys.stdout.buffer.write(said.read())
        sys.stdout.flush()


def run(title: str, command: list[str], environment: dict[str, str] | None = None) -> int:
    """Print a line, and run the tests from the repository's folder."""
    print(f"coilset: {title}", flush=True)
    done = subprocess.run(command, cwd=REPOSITORY, check=False, env=environment, preexec_fn=end_with_parent)
    return done.returncode
