"""Long springs compressed far beyond buckling in 1, 2, 3, 4, 5, 10, 80 and automatic steps: the same stable state

Elastic springs of wire 5, D 40 and pitch 12 with 40, 30 and 25 turns, 8 rods per turn, between clamped heads and
between seats. They buckle at a tenth to a third of the travel; the axis then deflects, and with 30 and 25 turns the
coils on the inside of the bend touch and slip past each other, so several branches exist. Whatever the number of steps,
the result must be the same stable state, or the run must report that it left a branch (a warning `snapped` or
`unstable`).

Three things are judged: the final force of the runs that report no branch, within 0.5 % of the median of all runs; how
many runs end elsewhere without a warning; and how many end unstable without one. The table lists all runs.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.run_warnings import run_warnings
from coilset.model.core.base.errors import SolveError
from coilset.model.core.base.style import STYLE
from coilset.model.core.case import check
from coilset.verification.study import Study

FAST = False
SPRINGS = (
    (40, "clamped", 160.0),
    (40, "seats", 160.0),
    (30, "clamped", 180.0),
    (30, "seats", 180.0),
    (25, "clamped", 140.0),
    (25, "seats", 140.0),
)
STEPS: tuple[int | str, ...] = (1, 2, 3, 4, 5, 10, 80, "auto")
BRANCHES = ("snapped", "unstable")  # warnings that name a branch
TOLERANCE = 5e-3


@dataclass(frozen=True)
class End:
    """How a run ended: force, N, NaN if it did not; negative pivots, warnings of branches, states evaluated, path."""

    force: float
    negative_pivots: int
    branches: tuple[str, ...]
    evaluations: int
    path: tuple[tuple[float, float], ...]


def press(turns: int, ends: str, travel: float, steps: int | str) -> End:
    """Compress a spring in the given number of steps."""
    spring = {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": turns, "pitch": 12.0}
    mesh = {"elements_per_turn": 8, "section": {"kind": "plane", "radial": 2, "angular": 6}}
    loading = [{"to": {"travel": travel}, "steps": steps}]
    case = check({"spring": spring, "material": "elastic", "ends": ends, "mesh": mesh, "loading": loading})
    analysis, force = Analysis(case, MPI.COMM_SELF), np.nan
    with suppress(SolveError):
        force = analysis.run().steps[-1].force_N
    found = analysis.result.steps
    names = tuple(warning.name for warning in run_warnings(analysis.setup, analysis.result) if warning.name in BRANCHES)
    path = tuple((step.travel_mm, step.force_N) for step in found)
    return End(force, found[-1].negative_pivots if found else 0, names, sum(step.evaluations for step in found), path)


def run(study: Study) -> None:
    """All springs in all numbers of steps."""
    report(study, [[press(*spring, steps) for steps in STEPS] for spring in SPRINGS])


def report(study: Study, found: Sequence[Sequence[End]]) -> None:
    """Judge the ends, one list for each of SPRINGS."""
    rows = []
    for (turns, ends, travel), runs in zip(SPRINGS, found, strict=True):
        where = f"{turns} turns, {ends}, {travel:g} mm"
        forces = np.array([end.force for end in runs])
        median = float(np.nanmedian(forces))
        silent = [end.force for end in runs if not end.branches]
        if silent:
            farthest = max(silent, key=lambda force: np.inf if np.isnan(force) else abs(force - median))
            study.check(f"force at the end, N, {where}", farthest, median, "all numbers of steps", TOLERANCE)
        elsewhere = sum(not abs(end.force / median - 1.0) <= TOLERANCE and not end.branches for end in runs)
        study.check(f"runs that end elsewhere without a warning, {where}", elsewhere, 0, "required", kind="at_most")
        unstable = sum(end.negative_pivots > 0 and not end.branches for end in runs)
        study.check(f"runs that end unstable without a warning, {where}", unstable, 0, "required", kind="at_most")
        for steps, end in zip(STEPS, runs, strict=True):
            rows.append(
                [
                    turns,
                    ends,
                    travel,
                    str(steps),
                    end.force,
                    100.0 * (end.force / median - 1.0),
                    end.negative_pivots,
                    ", ".join(end.branches),
                    end.evaluations,
                ]
            )
    columns = [
        "turns",
        "ends",
        "travel, mm",
        "steps",
        "force, N",
        "off the median, %",
        "negative pivots",
        "warnings",
        "states evaluated",
    ]
    study.table("far beyond buckling", columns, rows)
    study.figure("buckled_far", draw(found))


def draw(found: Sequence[Sequence[End]]) -> Figure:
    """Paths in 80 steps as lines, the ends of all runs as marks."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.6, 3.6), layout="constrained")
        axes = figure.add_subplot()
        for k, ((turns, ends, travel), runs) in enumerate(zip(SPRINGS, found, strict=True)):
            line = "-" if ends == "clamped" else ":"
            path = np.array([(0.0, 0.0), *runs[STEPS.index(80)].path]).T
            axes.plot(*path, line, lw=1.0, color=f"C{k // 2}", label=f"{turns} turns, {ends}")
            axes.plot(
                np.full(len(runs), travel),
                [end.force for end in runs],
                "o" if ends == "clamped" else "x",
                ms=4,
                mfc="none",
                color=f"C{k // 2}",
            )
        axes.set(xlabel="travel in mm", ylabel="force in N", title="Pressed far beyond buckling in 1 to 80 steps")
        axes.grid(lw=0.3)
        axes.legend(fontsize=7)
    return figure
