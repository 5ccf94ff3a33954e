"""Elapsed time of the example's walk alone: its load program, without imports, set-up and output.

    scripts/coilset python verification/benchmarks/walk.py

It runs in this checkout and in others: it uses only what they have, too.
"""

import json
import sys
import time
from collections.abc import Sequence
from statistics import median
from typing import Any

from coilset.model.base.errors import InputError
from coilset.model.run.examples import EXAMPLES
from coilset.model.runtime.processes import usable_cores

SAME = ("mesh.section.radial=4", "mesh.section.angular=12")  # so that times of all versions refer to the same work
STEPS = ("loading.0.steps=12", "loading.1.steps=12")
EQUAL = (*STEPS, *SAME)
WALKS: dict[str, tuple[str, ...]] = {
    "12 + 12 equal steps, 4 x 12 points, error not estimated": (*EQUAL, "accuracy=none"),
    "12 + 12 equal steps, 4 x 12 points": EQUAL,
    "as shipped": (),
}


def walk(settings: Sequence[str], threads: int) -> float | None:
    """Seconds, the median of three walks after one that loads all they need; None where a checkout cannot walk so."""
    from mpi4py import MPI

    from coilset.model.case import read_case
    from coilset.model.run.analysis import Analysis

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


def walks() -> list[dict[str, Any]]:
    """Each walk on one thread and on as many as there are cores: `name`, `threads`, `seconds`."""
    return [
        {"name": name, "threads": threads, "seconds": walk(settings, threads)}
        for name, settings in WALKS.items()
        for threads in sorted({1, usable_cores()})
    ]


if __name__ == "__main__":
    from coilset.model.runtime.caches import load_without_compiler

    load_without_compiler()
    json.dump(walks(), sys.stdout)
