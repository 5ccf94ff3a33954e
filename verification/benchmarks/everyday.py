"""Time of everyday commands: medians for this checkout and, in turns with it, another one.

Commands are measured from outside: elapsed seconds until their first line and until they end, and processor seconds.
"""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Any

from coilset.model.compose.examples import EXAMPLES
from coilset.model.core.base.errors import CoilsetError, InputError

REPEATS = 5
THIS = Path(__file__).resolve().parents[2]
CASE = str(EXAMPLES / "ck15_presetting.yaml")
EQUAL = ["mesh.section.radial=4", "mesh.section.angular=12", "loading.0.steps=12", "loading.1.steps=12"]
COMMANDS = {
    "--help": ["--help"],
    "solve --no-pictures, 12 + 12 steps, 4 x 12 points": [
        *("solve", CASE, "--no-pictures"),
        *(word for setting in EQUAL for word in ("--set", setting)),
    ],
    "solve --no-pictures": ["solve", CASE, "--no-pictures"],
    "solve": ["solve", CASE],
}
MEASURED = ("first line", "end", "processor")


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


def timed(command: Sequence[str], environment: Mapping[str, str]) -> tuple[float, float, float]:
    """Elapsed seconds to the first line and to the end of a command, and its processor seconds.

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
        _, status, used = os.wait4(process.pid, 0)  # with the processes that it has waited for
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode:
            complaints.seek(0)
            lines = complaints.read().decode(errors="replace").strip().splitlines() or ["no message"]
            raise CoilsetError(f"'{' '.join(command)}' failed: {lines[-1]}")
        return first, time.perf_counter() - began, used.ru_utime + used.ru_stime


def everyday(
    starts: Sequence[Sequence[str]], environment: Mapping[str, str], repeats: int = REPEATS
) -> list[dict[str, Any]]:
    """Medians for some checkouts, measured alternately; a first run of each, not counted, warms up.

    Args:
        starts: words that start the command of each.
        environment: of the commands, from before MPI.
        repeats: of each command.

    Returns:
        For each command its `name`, and for each of MEASURED the seconds of each checkout.
    """
    plain, rows = of_a_new_command(environment), []
    for name, arguments in COMMANDS.items():
        runs = [[timed([*start, *arguments], plain) for start in starts] for _ in range(repeats + 1)][1:]
        medians = [[median(run[side][kind] for run in runs) for side in range(len(starts))] for kind in range(3)]
        rows.append({"name": name, **dict(zip(MEASURED, medians, strict=True))})
    return rows


def of_a_new_command(environment: Mapping[str, str]) -> dict[str, str]:
    """Without the time at which this command started, from which that one would count."""
    return {name: value for name, value in environment.items() if name != "COILSET_STARTED"}
