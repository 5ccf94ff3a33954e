"""The example spring with every iteration method: all pass the reversal and end in the same state

`examples/ck15_presetting.yaml` (Ck 15, 2.5 turns, compressed to block and released), between clamped heads and between
seats, in 10 steps down and 12 up and in 60 each. Iterations, factorisations, evaluations of the residual (each updates
all section points and their tangents) and time are counted, failed solves included.

A method that must cut a step takes different steps from the others, and the error of the law over them leads to a
different final state. Each method's final state is therefore compared with Newton's along exactly the same steps:
positions to 1e-6 of the travel and stresses to 1e-6 of the maximum. To see this rather than the tolerance of (6.3.1), ε
is 1e-9 here.

Recommendation: Newton. It takes the fewest iterations and the shortest time and cuts no step. A rod gains nothing from
keeping a matrix: its section points return their tangents together with their stresses, and factorisation takes about 3
% of the time (`coilset bench`), with 40 elements as with thousands. The methods that keep it save up to half of the
factorisations at the price of three to fifteen times the evaluations; BFGS is the best of them. Broyden's saves none
where coils close: it must begin anew after three corrections. Arc-length comes second to Newton and is the method for
limit points.
"""

import itertools
import time
from collections.abc import Iterable
from dataclasses import dataclass

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.examples import EXAMPLES
from coilset.model.core.base.errors import SolveError
from coilset.model.core.base.style import STYLE
from coilset.model.core.case import Case, read_case
from coilset.model.core.equilibrium.newton.methods import METHODS, rod_method
from coilset.model.core.equilibrium.newton.newton import Newton, Start
from coilset.model.core.equilibrium.newton.outcome import Outcome
from coilset.model.core.results.records.record import Snapshot, Step
from coilset.verification.counting import listen
from coilset.verification.study import Study

FAST = False
EXAMPLE = EXAMPLES / "ck15_presetting.yaml"
STEPS = ((10, 12), (60, 60))  # down and up
TOLERANCE = 1e-9  # ε of (6.3.1)
COUNTS = ("iterations", "factorisations", "evaluations")


@dataclass
class Run:
    """One run of the program: its Analysis and Result, counts over all solves, failed ones included, seconds."""

    analysis: Analysis
    complete: bool
    counts: dict[str, int]
    seconds: float

    @property
    def steps(self) -> tuple[Step, ...]:
        """The converged steps."""
        return self.analysis.result.steps

    @property
    def final(self) -> Snapshot:
        """The last Snapshot."""
        return self.analysis.result.snapshots[-1]


def example(ends: str, method: str, down: int = 1, up: int = 1) -> Case:
    """The example's Case with other ends, method and steps."""
    settings = [f"ends={ends}", "release=held", f"solver.method={method}", f"solver.tolerance={TOLERANCE}"]
    return read_case(EXAMPLE, [*settings, f"loading.0.steps={down}", f"loading.1.steps={up}"])


def drive(ends: str, down: int, up: int, method: str) -> Run:
    """Run the example to block and back to zero force."""
    case = example(ends, method, down, up)
    analysis, counts = Analysis(case, MPI.COMM_SELF), dict.fromkeys(COUNTS, 0)

    def count(outcome: Outcome) -> None:
        for name in COUNTS:
            counts[name] += getattr(outcome, name)

    listen(analysis.newton, "solve", count)
    complete, began = True, time.perf_counter()
    try:
        analysis.run()
    except SolveError:
        complete = False
    return Run(analysis, complete, counts, time.perf_counter() - began)


def newton_along(ends: str, steps: Iterable[Step]) -> Snapshot | None:
    """The final Snapshot of Newton along the steps of another run, or None if it fails on one of them.

    It starts each step from the last one's increments, then from rest, with either line search: one of these finds the
    equilibrium.
    """
    analysis = Analysis(example(ends, "newton"), MPI.COMM_SELF)
    control, system = analysis.control, analysis.system
    newtons = [analysis.newton, Newton(system, rod_method("newton", 1, {"snes_linesearch_type": "cp"}), TOLERANCE)]
    phase, size = None, 0.0
    for step in steps:
        by_height = step.phase == 0
        begin, end = (control.height, step.seat_height_mm) if by_height else (control.force, step.force_N)
        load = (control.to_height if by_height else control.to_force)(end)
        starts = [Start()]
        if phase == step.phase:
            starts.insert(0, Start(analysis.continuation.guess.scaled_last((end - begin) / size)))
        for newton, start in itertools.product(newtons, starts):
            if newton.solve(load, start).converged:
                break
        else:
            return None
        phase, size = step.phase, end - begin
        system.commit()
    return analysis.snapshot("end")


def apart(run: Run, reference: Snapshot | None) -> float:
    """Maximum difference of a final state from a Snapshot: of positions over the travel, of stresses over the largest.

    Infinite if the run did not end, or there is no reference.
    """
    if not run.complete or reference is None:
        return np.inf
    spring, stress = run.analysis.spring, reference.point_state[..., :3]
    travel = spring.free_length - spring.block_height
    return max(
        np.abs(run.final.x - reference.x).max() / travel,
        np.abs(run.final.point_state[..., :3] - stress).max() / np.abs(stress).max(),
    )


def run(study: Study) -> None:
    """All methods, both kinds of ends, 10 and 60 steps."""
    drive("clamped", 2, 2, "newton")  # compiles what is to be timed
    found = {}
    for ends in ("clamped", "seats"):
        for down, up in STEPS:
            rows, group = [], {}
            for method in METHODS:
                group[method] = one = drive(ends, down, up, method)
                cuts = sum(step.cuts for step in one.steps)
                place = f"{method}, {ends}, {down} steps down"
                if method == "newton":
                    study.check(f"{place}: force at the end, N", one.final.force, 0.0, "the program", 1e-6, "absolute")
                else:
                    reference = newton_along(ends, one.steps) if cuts else group["newton"].final
                    difference = apart(one, reference)
                    study.check(f"{place}: final state", difference, 1e-6, "Newton, same steps", kind="at_most")
                rows.append(
                    [method, len(one.steps), cuts, *one.counts.values(), round(one.seconds, 2), one.final.height]
                )
            columns = ["method", "steps", "cuts", *COUNTS, "s", "height at zero force, mm"]
            study.table(f"{ends}, {down} steps down, {up} up", columns, rows)
            found[ends, down] = group
    draw(study, found)


def draw(study: Study, found: dict[tuple[str, int], dict[str, Run]]) -> None:
    """Counts and time of each method, one panel a program."""
    names = [*COUNTS, "time in ms"]
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(10.0, 6.6), layout="constrained")
        panels = figure.subplots(2, 2, sharex=True)
        for axes, ((ends, down), group) in zip(panels.flat, found.items(), strict=True):
            for k, name in enumerate(names):
                values = [1000 * run.seconds if k == 3 else run.counts[name] for run in group.values()]
                axes.barh(np.arange(len(group)) + 0.2 * (k - 1.5), values, 0.2, label=name)
            axes.set_yticks(range(len(group)), group)
            axes.invert_yaxis()
            axes.set(xscale="log", title=f"{ends}, {down} steps down, {dict(STEPS)[down]} up")
            axes.grid(lw=0.3, axis="x")
        panels[0, 0].legend(fontsize=7)
        for axes in panels[1]:
            axes.set_xlabel("number, or ms on one core")
        figure.suptitle("Spring of Ck 15 to block and back, each iteration method")
    study.figure("iteration_methods", figure)
