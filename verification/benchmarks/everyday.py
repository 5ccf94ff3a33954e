"""Elapsed time of everyday commands, and of the walk in them: medians for several checkouts, measured alternately.

Commands are measured from outside, until their first line and until they end.
"""

import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Any

from coilset.model.base.errors import CoilsetError, InputError
from coilset.model.run.examples import EXAMPLES
from coilset.verification.benchmarks import walk
from coilset.verification.benchmarks.process import read_json

REPEATS = 5
THIS = Path(__file__).resolve().parents[2]
CASE = str(EXAMPLES / "ck15_presetting.yaml")
EQUAL = [word for setting in walk.EQUAL for word in ("--set", setting)]
COMMANDS = {
    "--help": ["--help"],
    "solve --no-pictures, 12 + 12 steps, 4 x 12 points": ["solve", CASE, "--no-pictures", *EQUAL],
    "solve --no-pictures": ["solve", CASE, "--no-pictures"],
    "solve": ["solve", CASE],
}


def launchers(against: Path | None = None) -> list[list[str]]:
    """The words that start the command of this checkout, or of the installation where there is none, and of another.

    Raises:
        InputError: if the other is no checkout of coilset.
    """
    here = THIS / "scripts" / "coilset"
    starts = [[str(here)] if here.is_file() else [sys.executable, "-m", "coilset.scripts"]]
    if against is not None:
        there = against / "scripts" / "coilset"
        if not there.is_file():
            raise InputError("is no checkout of coilset; there is no scripts/coilset in it", "--against", against)
        starts.append([str(there)])
    return starts


def timed(command: Sequence[str], environment: Mapping[str, str]) -> tuple[float, float]:
    """Seconds to the first line and to the end of a command.

    Raises:
        CoilsetError: if it failed.
    """
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryFile() as complaints:
        began = time.perf_counter()
        process = subprocess.Popen(command, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=complaints)
        assert process.stdout is not None
        process.stdout.readline()
        first = time.perf_counter() - began
        process.stdout.read()
        process.stdout.close()
        if process.wait():
            complaints.seek(0)
            lines = complaints.read().decode(errors="replace").strip().splitlines() or ["no message"]
            raise CoilsetError(f"'{' '.join(command)}' failed: {lines[-1]}")
        return first, time.perf_counter() - began


def everyday(
    starts: Sequence[Sequence[str]], environment: Mapping[str, str], repeats: int = REPEATS
) -> list[dict[str, Any]]:
    """Medians for some checkouts, measured alternately; a first run of each, not counted, warms up.

    Args:
        starts: words that start the command of each.
        environment: of the commands, from before MPI.
        repeats: of each command.

    Returns:
        For each command its `name`, and `first_line` and `end`: seconds for each checkout.
    """
    plain, rows = of_a_new_command(environment), []
    for name, arguments in COMMANDS.items():
        runs = [[timed([*start, *arguments], plain) for start in starts] for _ in range(repeats + 1)][1:]
        first, end = ([median(run[i][which] for run in runs) for i in range(len(starts))] for which in (0, 1))
        rows.append({"name": name, "first_line": first, "end": end})
    return rows


def walks(
    starts: Sequence[Sequence[str]], environment: Mapping[str, str], repeats: int = REPEATS
) -> list[dict[str, Any]]:
    """Medians for some checkouts, measured alternately.

    Args:
        starts: words that start the command of each.
        environment: of the commands, from before MPI.
        repeats: processes of each.

    Returns:
        As `walk.walks`, but for `seconds`: a number, or None, for each checkout.

    Raises:
        CoilsetError: if one failed.
    """
    plain, script = of_a_new_command(environment), str(Path(walk.__file__).resolve())
    runs = [
        [read_json([*start, "python", script], f"'{start[0]} python walk.py'", plain) for start in starts]
        for _ in range(repeats)
    ]
    rows = []
    for number, row in enumerate(runs[0][0]):
        found = [[run[side][number]["seconds"] for run in runs] for side in range(len(starts))]
        rows.append({**row, "seconds": [None if None in side else median(side) for side in found]})
    return rows


def of_a_new_command(environment: Mapping[str, str]) -> dict[str, str]:
    """Without the time at which this command started, from which that one would count."""
    return {name: value for name, value in environment.items() if name != "COILSET_STARTED"}
