"""Shipped springs to block and back in 12, 24, 48 and 96 steps: force at block and set against Richardson's limit

Once coils touch, torsion turns into bending, and backward Euler's first order shows (Ck 15's steep ζ). Each spring is
pressed to block in so many equal steps and let go in as many. From the last three values the limit and the observed
order follow after Richardson: with the differences d1 and d2 of a sequence, q = d1/d2, the limit is v + d2/(q − 1).

Where the sequence closes in (the last difference is less than the one before it), 96 steps are judged to be within 1 %
of the limit; the table says how far 12 steps are off, which is the default. A spring whose sequence does not close in
is shown and not judged: its limit would mean nothing.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from mpi4py import MPI

from coilset.meshes.errors import SolveError
from coilset.model.analysis import Analysis
from coilset.model.case import read_case
from coilset.model.examples import EXAMPLES
from coilset.model.results.figures import STYLE
from coilset.model.results.summary import summarise
from coilset.verification.study import Study

FAST = False
SPRINGS = {
    "example": "ck15_presetting.yaml", "cone": "springs/cone.yaml", "barrel": "springs/barrel.yaml",
    "funnel": "springs/funnel.yaml",
}  # fmt: skip
STEPS = (12, 24, 48, 96)
QUANTITIES = ("force at block, N", "set, mm")


def press(file: str, steps: int) -> tuple[float, float]:
    """Force at the end of the first phase, N, and set, mm; NaN where no equilibrium was found."""
    analysis = Analysis(read_case(EXAMPLES / file, [f"loading.{k}.steps={steps}" for k in (0, 1)]), MPI.COMM_SELF)
    try:
        result = analysis.run()
    except SolveError:
        return np.nan, np.nan
    force = [step.force_N for step in result.steps if step.phase == 0][-1]
    return force, summarise(analysis.setup, result)["set_mm"]


def limit(values: np.ndarray) -> tuple[float, float]:
    """Richardson's limit of a sequence with halved steps, from its last three values, and the observed order."""
    first, second = values[-2] - values[-3], values[-1] - values[-2]
    ratio = first / second
    return values[-1] + second / (ratio - 1.0), np.log2(abs(ratio))


def run(study: Study) -> None:
    """All springs, all numbers of steps."""
    found, rows = {}, []
    for name, file in SPRINGS.items():
        found[name] = np.array([press(file, steps) for steps in STEPS]).T
        for quantity, values in zip(QUANTITIES, found[name], strict=True):
            end, order = limit(values)
            rows.append([name, quantity, *values, end, order, 100.0 * (values[0] / end - 1.0)])
            change = abs((values[-1] - values[-2]) / (values[-2] - values[-3]))
            what, far = f"{name}, {quantity}, {STEPS[-1]} steps", "its steps do not close in yet"
            if change < 1.0:
                study.check(what, values[-1], end, "Richardson's limit", 0.01)
            else:
                study.shown(what, values[-1], values[-2], f"{STEPS[-2]} steps", far)
    columns = ["spring", "quantity", *(f"{steps} steps" for steps in STEPS), "limit", "order", "12 steps off, %"]
    study.table("to block and back in equal steps", columns, rows)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.0, 3.6), layout="constrained")
        for k, (axes, quantity) in enumerate(zip(figure.subplots(1, 2), QUANTITIES, strict=True)):
            for name, values in found.items():
                axes.loglog(STEPS, np.abs(values[k] / limit(values[k])[0] - 1.0), "o-", ms=4, lw=1, label=name)
            axes.loglog(STEPS, 0.3 / np.array(STEPS), "k:", lw=0.9, label="1/steps")
            axes.set_xticks(STEPS, [str(steps) for steps in STEPS])
            axes.minorticks_off()
            axes.set(xlabel="steps each way", ylabel="off Richardson's limit", title=quantity)
            axes.grid(lw=0.3)
        axes.legend(fontsize=8)
    study.figure("step_convergence", figure)
