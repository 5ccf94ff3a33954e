"""Springs of L0/D = 6, 8, 10 between clamped heads and between seats: the travel at which they buckle, against Haringx

Wire 5, D 40, pitch 12, elastic, 16 rods per turn as by default (with 8, that of L0/D = 6 buckles 0.7 % later). Seats
hold the wire's tips sideways and against rotation, unless a case says otherwise, and stay parallel. A spring between
them therefore buckles as it does between clamped heads, with the coefficient ½ of EN 13906-1, and both are compared
with Haringx's clamped column (`references/stability.py`). What is judged is the travel at which a run reports that the
spring buckled (`model/physics/stability/buckling.py`). The numbers of turns include whole and fractional ones; with a
fractional number the ends push the axis to one side from the start.

Beyond that travel the stable branch is drawn: the force hardly rises while the axis deflects.

Tolerance: 2 %. Haringx neglects the pitch, whose tan² α is 0.9 %.
"""

import matplotlib as mpl
from matplotlib.figure import Figure
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.errors import SolveError
from coilset.model.core.base.style import STYLE
from coilset.model.core.case import check
from coilset.model.core.material import library
from coilset.model.core.results.records.record import Step
from coilset.model.physics.stability.buckling import Buckling, buckling
from coilset.verification.references.stability import clamped_spring
from coilset.verification.study import Study

FAST = False
WIRE, DIAMETER, PITCH = 5.0, 40.0, 12.0  # mm
RATIOS, ENDS = (6, 8, 10), ("clamped", "seats")
BEYOND, STEPS = 1.1, 16  # of Haringx's travel
TOLERANCE = 0.02


def press(length: float, ends: str, travel: float) -> tuple[Step, ...]:
    """Steps of a run that must end stable."""
    spring = {"wire_diameter": WIRE, "mean_diameter": DIAMETER, "turns": length / PITCH, "pitch": PITCH}
    mesh = {"elements_per_turn": 16, "section": {"kind": "plane"}}
    case = check(
        {
            "spring": spring,
            "material": "elastic",
            "ends": ends,
            "mesh": mesh,
            "loading": [{"to": {"travel": travel}, "steps": STEPS}],
        }
    )
    steps = Analysis(case, MPI.COMM_SELF).run().steps
    if any(step.negative_pivots for step in steps):
        raise SolveError(f"L0 = {length:g} mm, {ends}: an unstable state was kept")
    return steps


def buckled(steps: tuple[Step, ...]) -> Buckling:
    """Where it buckled, as it must."""
    found = buckling(steps, DIAMETER)
    if found is None:
        raise SolveError("the spring did not buckle")
    return found


def run(study: Study) -> None:
    """Critical travels, and the branches that are stable."""
    law, found, exact = library.load("elastic"), {}, {}
    for ratio in RATIOS:
        length = ratio * DIAMETER
        exact[ratio] = clamped_spring(WIRE, DIAMETER, length / PITCH, length, law.E, law.G)
        for ends in ENDS:
            found[ratio, ends] = steps = press(length, ends, BEYOND * exact[ratio][0])
            what = f"travel at which it buckles, L0/D = {ratio}, {ends}, mm"
            study.check(what, buckled(steps).travel_mm, exact[ratio][0], "Haringx", TOLERANCE)
    rows = [[ratio, exact[ratio][0], *(buckled(found[ratio, ends]).travel_mm for ends in ENDS)] for ratio in RATIOS]
    study.table("critical travel, mm", ["L0/D", "Haringx", *ENDS], rows)
    draw(study, found, exact)


def draw(study: Study, found: dict[tuple[int, str], tuple[Step, ...]], exact: dict[int, tuple[float, float]]) -> None:
    """Force over travel: clamped as lines, seats as marks, Haringx's points."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.6, 3.6), layout="constrained")
        axes = figure.add_subplot()
        for k, ratio in enumerate(RATIOS):
            for ends, style in zip(ENDS, ("-", "o"), strict=True):
                steps = found[ratio, ends]
                axes.plot(
                    [0.0, *(step.travel_mm for step in steps)],
                    [0.0, *(step.force_N for step in steps)],
                    style,
                    ms=3.5,
                    mfc="none",
                    color=f"C{k}",
                    label=f"L0/D = {ratio}, {ends}",
                )
            axes.axvline(buckled(found[ratio, "clamped"]).travel_mm, color=f"C{k}", lw=0.7, ls=":")
            axes.plot(*exact[ratio], "k+", ms=10, label="Haringx" if k == 0 else None)
        axes.set(xlabel="travel in mm", ylabel="force in N", title="Slender springs, pressed until they buckle")
        axes.grid(lw=0.3)
        axes.legend(fontsize=7)
    study.figure("buckling_of_ends", figure)
