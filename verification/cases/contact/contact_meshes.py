"""Cylinder and cone compressed to block, a barrel nearly so, and released: no step fails, and the meshes agree

The barrel stops at 30 mm, 6.5 mm above its block: from 28 mm on its coils slip past each other without friction, and
its path forks. The three springs of `examples/springs` run at 16, 32 and 64 elements per turn, both with twelve equal
steps each way and with automatic ones. A failed solve is repeated from rest, or its step is cut; both are counted.
Steps that were solved but cut because their error was too large or their state unstable are not. The table also shows
how often Newton's method did not converge within a step and a part of it was balanced first. The contact stiffness,
E/4, is the same for all meshes, so that finer ones converge to one state. Two things are judged: the set, which must
change by less than 1 % from 32 to 64 elements, and the characteristic at the heights of the equal steps, whose change
from 32 to 64 must be below 1 % of the maximum force and less than from 16 to 32. The force at block depends on the
positions of several hundred contacts to within a few thousandths of a millimetre: it converges last.
"""

import logging
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.examples import EXAMPLES
from coilset.model.compose.summary import summarise
from coilset.model.core.base.style import STYLE
from coilset.model.core.case import read_case
from coilset.verification.study import Study

SPRINGS = {"cylinder": "block", "cone": "block", "barrel": "{height: 30.0}"}  # and where they are compressed to
MESHES = (16, 32, 64)
FAILED = ("no equilibrium from the last step's direction", "cut to")  # in the log of the step control
SOLVED = ("its error is estimated", "the equilibrium is unstable")
IN_PARTS = ("no equilibrium of the whole step yet",)

Run = tuple[Analysis, dict[str, Any]]  # with its summary


class Counter(logging.Handler):
    """Counts the records of failed solves, and those of solves in parts."""

    failed = parts = 0

    def emit(self, record: logging.LogRecord) -> None:
        """Count a record."""
        message = record.getMessage()
        self.failed += any(words in message for words in FAILED) and not any(words in message for words in SOLVED)
        self.parts += any(words in message for words in IN_PARTS)


def press(name: str, mesh: int, automatic: bool) -> tuple[Analysis, dict[str, Any], Counter]:
    """Run an example; the Analysis, its summary, and the Counter of its solves."""
    steps = "auto" if automatic else 12
    settings = [f"mesh.elements_per_turn={mesh}", *(f"loading.{phase}.steps={steps}" for phase in (0, 1))]
    settings.append(f"loading.0.to={SPRINGS[name]}")
    analysis, counter = Analysis(read_case(EXAMPLES / "springs" / f"{name}.yaml", settings)), Counter()
    logger = logging.getLogger("coilset.steps")
    level = logger.level
    logger.setLevel(logging.INFO)
    logger.addHandler(counter)
    try:
        result = analysis.run()
    finally:
        logger.removeHandler(counter)
        logger.setLevel(level)
    return analysis, summarise(analysis.setup, result), counter


def characteristic(analysis: Analysis, phase: int | None = None) -> np.ndarray:
    """Travel and force at the steps of a phase, or of all of them, mm and N."""
    steps = [step for step in analysis.result.steps if phase in (None, step.phase)]
    return np.array([[step.travel_mm, step.force_N] for step in steps]).T


def run(study: Study) -> None:
    """Count failures, compare meshes."""
    rows, curves = [], {}
    for name in SPRINGS:
        for mesh in MESHES:
            for automatic in (False, True):
                analysis, summary, counter = press(name, mesh, automatic)
                kind = "automatic" if automatic else "equal"
                place = f"{name}, {mesh} per turn, {kind} steps"
                study.check(f"failed solves, {place}", counter.failed, 0, "required", kind="at_most")
                rows.append(
                    [
                        name,
                        mesh,
                        kind,
                        summary["steps"],
                        summary["iterations"],
                        counter.parts,
                        summary["set_mm"],
                        summary["force_max_N"],
                    ]
                )
                curves[name, mesh, automatic] = analysis, summary
        compare(study, name, {mesh: curves[name, mesh, False] for mesh in MESHES})
    columns = ["spring", "rods per turn", "steps", "steps done", "iterations", "in parts", "set, mm", "block force, N"]
    study.table("down and back", columns, rows)
    draw(study, curves)


def compare(study: Study, name: str, found: dict[int, Run]) -> None:
    """Set and loading characteristic of neighbouring meshes."""
    finest = f"{MESHES[-1]} elements per turn"
    force = {mesh: characteristic(analysis, 0)[1] for mesh, (analysis, _) in found.items()}
    greatest = force[64].max()
    coarse, fine = (np.abs(force[a] - force[b]).max() / greatest for a, b in ((16, 32), (32, 64)))
    study.check(f"{name}: set at 32 per turn, mm", found[32][1]["set_mm"], found[64][1]["set_mm"], finest, 0.01)
    study.check(
        f"{name}: maximum change of force from 32 to 64, over the maximum force", fine, 0.0, finest, 0.01, "absolute"
    )
    study.check(f"{name}: this change over that from 16 to 32", fine / coarse, 1.0, "convergence", kind="at_most")


def draw(study: Study, curves: dict[tuple[str, int, bool], Run]) -> None:
    """Characteristics of the three springs at three meshes."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(11.0, 4.0), layout="constrained")
        for place, name in zip(figure.subplots(1, len(SPRINGS)), SPRINGS, strict=True):
            for mesh, colour, marker in zip(MESHES, ("C3", "C1", "C0"), "o+x", strict=True):
                equal, _ = curves[name, mesh, False]
                place.plot(
                    *characteristic(equal),
                    marker,
                    color=colour,
                    ms=4,
                    mfc="none",
                    lw=0,
                    label=f"{mesh} per turn, equal steps",
                )
                automatic, _ = curves[name, mesh, True]
                place.plot(
                    *np.insert(characteristic(automatic), 0, 0.0, axis=1),
                    "-",
                    color=colour,
                    lw=0.8,
                    label=f"{mesh} per turn, automatic",
                )
            place.set(xlabel="travel in mm", ylabel="axial force in N", title=name)
            place.grid(lw=0.3)
        place.legend(fontsize=7)
        figure.suptitle("16, 32 and 64 elements per turn give the same curves (springs of Ck 15, to block and back)")
    study.figure("contact_meshes", figure)
