"""Elapsed time of the example's walk alone: its load program, without imports, set-up and output.

    scripts/coilset python verification/benchmarks/walks.py

It runs in this checkout and in others: it uses only what they have, too.
"""

import json
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Any

from coilset.meshes.errors import CoilsetError, InputError
from coilset.model.examples import EXAMPLES
from coilset.model.processes import usable_cores

EQUAL = ("loading.0.steps=12", "loading.1.steps=12", "mesh.section.radial=4", "mesh.section.angular=12")
WALKS: dict[str, tuple[str, ...]] = {
    "12 + 12 equal steps, 4 x 12 points, error not estimated": (*EQUAL, "accuracy=none"),
    "12 + 12 equal steps, 4 x 12 points": EQUAL,
    "as shipped": (),
}


def walk(settings: Sequence[str], threads: int) -> float | None:
    """Seconds, the median of three walks after one that loads all they need; None where a checkout cannot walk so."""
    from mpi4py import MPI

    from coilset.model.analysis import Analysis
    from coilset.model.case import read_case

    spent = []
    try:
        case = read_case(EXAMPLES / "ck15_presetting.yaml", list(settings))
        for _ in range(4):
            analysis = Analysis(case, MPI.COMM_SELF, threads=threads)
            began = time.perf_counter()
            analysis.run()
            spent.append(time.perf_counter() - began)
    except (InputError, TypeError):
        return None
    return median(spent[1:])


def walks_once() -> list[dict[str, Any]]:
    """Each walk on one thread and on as many as there are cores: `name`, `threads`, `seconds`."""
    return [{"name": name, "threads": threads, "seconds": walk(settings, threads)}
            for name, settings in WALKS.items() for threads in sorted({1, usable_cores()})]  # fmt: skip


def walks(starts: Sequence[Sequence[str]], environment: Mapping[str, str], repeats: int = 5) -> list[dict[str, Any]]:
    """Medians for some checkouts, measured alternately.

    Args:
        starts: words that start the command of each.
        environment: of the commands, from before MPI.
        repeats: processes of each.

    Returns:
        As `walks_once`, but for `seconds`: a number, or None, for each checkout.

    Raises:
        CoilsetError: if one failed.
    """
    plain = {name: value for name, value in environment.items() if name != "COILSET_STARTED"}
    runs = [[_of_process([*start, "python", str(Path(__file__).resolve())], plain) for start in starts]
            for _ in range(repeats)]  # fmt: skip
    rows = []
    for number, row in enumerate(runs[0][0]):
        found = [[run[side][number]["seconds"] for run in runs] for side in range(len(starts))]
        rows.append({**row, "seconds": [None if None in side else median(side) for side in found]})
    return rows


def _of_process(command: Sequence[str], environment: Mapping[str, str]) -> list[dict[str, Any]]:
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        reason = (done.stderr.strip() or "no message").splitlines()[-1]
        raise CoilsetError(f"'{' '.join(command)}' failed: {reason}")
    return json.loads(done.stdout.strip().splitlines()[-1])


if __name__ == "__main__":
    from coilset.model.caches import load_without_compiler

    load_without_compiler()
    json.dump(walks_once(), sys.stdout)
