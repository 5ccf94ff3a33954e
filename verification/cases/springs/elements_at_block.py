"""Springs to block and back with both elements on finer and finer meshes: force at block and set, against their limit

Where coils close, torsion turns into bending within a few wire diameters and the wire flows there. The thesis's element
has one twist and linear curvatures, so that it cannot flow in the section that carries most alone: without hardening
the error of the force at block is of the first order in the length of the elements. In the mixed element the section
forces are in equilibrium with those at the nodes, and sections are at the nodes, where the moments of contact forces
are greatest.

A cone of nine turns of ideally plastic wire is the hardest case; an open cylinder hardens. The limit is that of the
thesis's element, extrapolated from its three finest meshes with the order that they show (Aitken). The mixed element,
whose equations, sections and unknowns are others, must meet it with 16 elements a turn within 0.5 % (0.2 % are the
steps' own), and with a fifth of the error of the thesis's element at most.
"""

import time
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import matplotlib as mpl
from matplotlib.figure import Figure
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.style import STYLE
from coilset.model.core.case import check
from coilset.verification.study import Study

FAST = False
TO_BLOCK: list[dict[str, Any]] = [{"to": "block"}, {"to": {"force": 0}}]
SPRINGS: dict[str, dict[str, Any]] = {
    "cone, ideally plastic": {
        "spring": {
            "wire_diameter": 3.709,
            "mean_diameter": {"shape": "cone", "bottom": 36.52, "top": 26.585},
            "turns": 9.2,
            "pitch": 5.938,
        },
        "material": "ideal_plastic",
        "loading": [{"to": {"travel": 12.522}}, *TO_BLOCK],
    },
    "open cylinder, Voce": {
        "spring": {"wire_diameter": 3.962, "mean_diameter": 44.599, "turns": 5.44, "pitch": 11.579},
        "material": "voce",
        "loading": TO_BLOCK,
    },
}
MESHES = {"thesis": (8, 16, 32, 64, 128), "mixed": (8, 16, 32)}
USUAL, TOLERANCE, GAIN = 16, 0.005, 5.0


class Press(NamedTuple):
    """Force at block, N, set, mm, evaluations of states, and seconds of processor time."""

    force: float
    set: float
    evaluations: int
    seconds: float


def press(spring: str, element: str, elements_per_turn: int) -> Press:
    """To block and back on a mesh."""
    mesh = {"element": element, "elements_per_turn": elements_per_turn}
    analysis = Analysis(check(SPRINGS[spring] | {"mesh": mesh}), MPI.COMM_SELF)
    began = time.process_time()
    result = analysis.run()
    seconds = time.process_time() - began
    force = max(step.force_N for step in result.steps)
    return Press(force, result.steps[-1].travel_mm, sum(step.evaluations for step in result.steps), seconds)


def extrapolated(values: Sequence[float]) -> float:
    """Limit of a sequence whose differences fall by the same ratio, from its last three."""
    before, last = values[-2] - values[-3], values[-1] - values[-2]
    return values[-1] + last**2 / (before - last)


def run(study: Study) -> None:
    """All springs, elements and meshes."""
    presses = {
        (spring, element): [press(spring, element, number) for number in meshes]
        for spring in SPRINGS
        for element, meshes in MESHES.items()
    }
    rows, errors, at = [], {}, MESHES["mixed"].index(USUAL)
    for spring in SPRINGS:
        limit = extrapolated([one.force for one in presses[spring, "thesis"]])
        for element, meshes in MESHES.items():
            runs = presses[spring, element]
            errors[spring, element] = [abs(one.force / limit - 1.0) for one in runs]
            rows += [
                [spring, element, number, one.force, 100.0 * (one.force / limit - 1.0), *one[1:]]
                for number, one in zip(meshes, runs, strict=True)
            ]
        usual = presses[spring, "mixed"][at].force
        study.check(f"{spring}, force at block, N", usual, limit, "limit of the thesis's element", TOLERANCE)
        thesis = abs(presses[spring, "thesis"][at].force - limit)
        study.check(
            f"{spring}, error of the force at block, N",
            abs(usual - limit),
            thesis / GAIN,
            "a fifth of the thesis's element's",
            kind="at_most",
        )
    columns = [
        "spring",
        "element",
        "elements a turn",
        "force at block, N",
        "from the limit %",
        "set, mm",
        "evaluations",
        "seconds",
    ]
    study.table("to block and back", columns, rows)
    study.figure("elements_at_block", draw(errors))


def draw(errors: Mapping[tuple[str, str], Sequence[float]]) -> Figure:
    """Errors of the force at block over the number of elements."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.0, 4.0), layout="constrained")
        axes = figure.subplots()
        for number, spring in enumerate(SPRINGS):
            for element, line in (("thesis", "o--"), ("mixed", "s-")):
                percent = [100.0 * error for error in errors[spring, element]]
                axes.loglog(MESHES[element], percent, line, color=f"C{number}", ms=5, label=f"{spring}; {element}")
        axes.axhline(0.2, color="0.5", lw=0.8)
        axes.annotate(
            "accuracy of the steps", (60, 0.2), xytext=(0, 2), textcoords="offset points", va="bottom", ha="right"
        )
        axes.set(xlabel="elements a turn", ylabel="error of the force at block in %")
        axes.set_xticks(MESHES["thesis"], [str(number) for number in MESHES["thesis"]])
        axes.set_yticks([0.1, 1, 10, 100], ["0.1", "1", "10", "100"])
        axes.minorticks_off()
        axes.set_ylim(0.02, 400)
        axes.grid(lw=0.3)
        axes.legend(fontsize=8, ncols=2, loc="upper center")
    return figure
