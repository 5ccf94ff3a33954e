"""One rank against two, in turns: a clamped spring in which nothing touches, and one whose coils lie on each other."""

from collections.abc import Callable
from statistics import median
from typing import Any

from coilset.verification.benchmarks.target import seconds

SIZES = {"quick": (320, 2_560), "full": (320, 2_560, 20_000)}  # elements
KINDS = ("clamped", "with contact")
REPEATS = 3


def compare(measure: Callable[..., dict[str, Any]], size: str, report: Callable[[str], object]) -> list[dict[str, Any]]:
    """Medians of runs that take turns.

    Args:
        measure: called with the job, its arguments and `ranks`; see coilset.verification.benchmarks.run.
        size: `quick` or `full`.
        report: called with the name of each measurement before it begins.

    Returns:
        Dicts: kind, elements, contacts, iterations; elapsed and processor seconds of a rank with one and with two
        ranks; how far the force differs.
    """
    rows = []
    for touching, kind in enumerate(KINDS):
        for elements in SIZES[size]:
            report(f"{elements:,} elements on one and two ranks, {kind}")
            runs: tuple[list[dict[str, Any]], ...] = [], []
            for _repeat in range(REPEATS):
                for ranks, taken in enumerate(runs, 1):
                    taken.append(measure("press", elements, 2, touching, ranks=ranks))
            (one, *_), (two, *_) = runs
            rows.append(
                {
                    "kind": kind,
                    "elements": one["elements"],
                    "contacts": two["contacts"],
                    "iterations": two["iterations"],
                    "elapsed": [median(seconds(run["stages"], 0) for run in taken) for taken in runs],
                    "processor": [median(seconds(run["stages"], 1) for run in taken) for taken in runs],
                    "difference": abs(two["force_N"] / one["force_N"] - 1.0),
                }
            )
    return rows
