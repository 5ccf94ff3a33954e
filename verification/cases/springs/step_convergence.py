"""Shipped springs to block and back in increasing numbers of equal steps and in automatic ones: force at block and set

Each spring is compressed to block in a number of equal steps and released in the same number, 48 at most, and once in
automatic steps, the default, with an accuracy of 0.2 %. The law and the straight strain path in a step have errors of
second order, so Richardson's limit of the last two values is v + (v − v')/3 where the differences of the sequence
decrease; the observed order is log2 of their ratio. Contacts that close within a step disturb the order: those of cone,
barrel and funnel close point by point over half of the travel, and the sequence converges only with steps shorter than
the travel from one point to the next. The cone is therefore compressed in up to 768 steps.

The example as it is shipped must be within 0.2 % of its limit in force and 0.1 % in set with automatic steps, the
others within 0.5 and 0.2 %. Where a sequence does not converge (its last difference is more than 0.6 of the one before
it), no limit is taken; the last value serves instead if the last two are within a third of the tolerance, otherwise the
deviation is shown but not judged. Nor is a force judged that falls while the spring is compressed further: coils slide
past each other there, without friction, and where the slide began is accidental. The first table shows how steep the
wall is on which a spring stands at block, and how much height the tolerance corresponds to; the second, the error as
estimated by the steps themselves; the third, the cost.
"""

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.examples import EXAMPLES
from coilset.model.compose.summary import summarise
from coilset.model.core.base.errors import SolveError
from coilset.model.core.base.style import STYLE
from coilset.model.core.case import read_case
from coilset.verification.study import Study

FAST = False
LOOSE = (0.005, 0.002)
SPRINGS = {
    "example": ("ck15_presetting.yaml", (0.002, 0.001), (12, 24, 48, 96)),
    "cone": ("springs/cone.yaml", LOOSE, (96, 192, 384, 768)),
    "barrel": ("springs/barrel.yaml", LOOSE, (24, 48, 96, 192)),
    "funnel": ("springs/funnel.yaml", LOOSE, (48, 96, 192, 384)),
}
BACK = 48  # steps of the release, at most
QUANTITIES = ("force at block, N", "set, mm")
FEWER_POINTS = ("mesh.section.radial=4", "mesh.section.angular=12")  # of the larger springs, for time
CLOSING = 0.6  # ratio of the last differences up to which a sequence counts as convergent


@dataclass(frozen=True)
class Press:
    """To block and back: force at block, N, and set, mm, rate there, their estimated errors, evaluations, seconds.

    The rate is that over the last step, N/mm; seconds are of processor time.
    """

    found: tuple[float, float]
    rate: float
    told: tuple[float | None, float | None]
    evaluations: int
    seconds: float


LOST = Press((np.nan, np.nan), np.nan, (np.nan, np.nan), 0, np.nan)


def press(file: str, steps: int | str) -> Press:
    """A Press; NaN where no equilibrium was found."""
    back = steps if isinstance(steps, str) else min(steps, BACK if "springs" in file else steps)
    settings = [f"loading.0.steps={steps}", f"loading.1.steps={back}", *(FEWER_POINTS if "springs" in file else ())]
    analysis = Analysis(read_case(EXAMPLES / file, settings), MPI.COMM_SELF)
    began = time.process_time()
    try:
        result = analysis.run()
    except SolveError:
        return LOST
    seconds = time.process_time() - began
    before, block = [step for step in result.steps if step.phase == 0][-2:]
    rate = (block.force_N - before.force_N) / (block.travel_mm - before.travel_mm)
    summary = summarise(analysis.setup, result)
    told = block.steps_force_error_N, summary["estimated_errors"]["steps"]["set_mm"]
    return Press((block.force_N, summary["set_mm"]), rate, told, summary["evaluations"], seconds)


def _number(value: float | None) -> float:
    return np.nan if value is None else value


def limit(values: Sequence[float]) -> tuple[float, float]:
    """Richardson's limit of a sequence with halved steps and an error of second order, and the observed order."""
    first, second = values[-2] - values[-3], values[-1] - values[-2]
    return values[-1] + second / 3.0, np.log2(abs(first / second))


def run(study: Study) -> None:
    """All springs, all numbers of steps."""
    presses = {name: [press(file, number) for number in (*steps, "auto")] for name, (file, _, steps) in SPRINGS.items()}
    report(study, presses)


def report(study: Study, presses: Mapping[str, Sequence[Press]]) -> None:
    """Judge what the runs of each of SPRINGS have found, equal steps first, automatic ones last."""
    rows, told, costs, off = [], [], [], {}
    for name, (_, tolerances, steps) in SPRINGS.items():
        runs = presses[name]
        for k, (quantity, tolerance) in enumerate(zip(QUANTITIES, tolerances, strict=True)):
            *values, automatic = (one.found[k] for one in runs)
            last, before = abs(values[-1] - values[-2]), abs(values[-2] - values[-3])
            closes = last <= CLOSING * before
            end, order = limit(values)
            if not closes:
                end = values[-1]
            off[name, k] = [100.0 * abs(value / end - 1.0) for value in (*values, automatic)]
            wall = runs[-2].rate  # over the last of many small steps
            told.append(
                [name, quantity, *(_number(one.told[k]) for one in runs), *(end - one.found[k] for one in runs)]
            )
            rows.append(
                [
                    name,
                    quantity,
                    ", ".join(map(str, steps)),
                    *values,
                    automatic,
                    end if closes else np.nan,
                    order,
                    off[name, k][-1],
                    wall,
                    tolerance * end / wall if k == 0 else np.nan,
                ]
            )
            what = f"{name}, {quantity}, automatic steps"
            if k == 0 and wall < 0.0:
                study.shown(what, automatic, end, f"{steps[-1]} steps", "it falls as coils slide past each other")
            elif closes:
                study.check(what, automatic, end, "Richardson's limit", tolerance)
            elif last <= tolerance * end / 3.0:
                study.check(what, automatic, end, f"{steps[-1]} steps", tolerance)
            else:
                study.shown(what, automatic, end, f"{steps[-1]} steps", "its sequence does not converge")
        costs.append([name, *(one.evaluations for one in runs), *(one.seconds for one in runs)])
    names = [*(f"steps {number}" for number in range(1, 5)), "automatic"]
    columns = [
        "spring",
        "quantity",
        "steps",
        *names,
        "limit",
        "order",
        "automatic, error %",
        "rate at block, N/mm",
        "tolerance, mm",
    ]
    study.table("to block and back", columns, rows)
    study.table(
        "error as estimated, and true error",
        ["spring", "quantity", *(f"estimated, {name}" for name in names), *(f"true, {name}" for name in names)],
        told,
    )
    study.table(
        "states evaluated, seconds of processor time", ["spring", *names, *(f"{name}, s" for name in names)], costs
    )
    study.figure("step_convergence", draw(presses, off))


def draw(presses: Mapping[str, Sequence[Press]], off: Mapping[tuple[str, int], Sequence[float]]) -> Figure:
    """Deviations from the limits over their cost."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.0, 3.6), layout="constrained")
        for k, (axes, quantity) in enumerate(zip(figure.subplots(1, 2), QUANTITIES, strict=True)):
            for number, (name, runs) in enumerate(presses.items()):
                evaluations, colour = [one.evaluations for one in runs], f"C{number}"
                axes.loglog(evaluations[:-1], off[name, k][:-1], "o-", ms=4, lw=1, color=colour, label=name)
                axes.loglog(evaluations[-1], off[name, k][-1], "*", ms=11, color=colour, mec="k", mew=0.5)
            axes.set(xlabel="states evaluated", ylabel="deviation from the limit in %", title=quantity)
            axes.grid(lw=0.3)
        axes.loglog([], [], "k*", ms=9, label="automatic")
        axes.legend(fontsize=8)
    return figure
