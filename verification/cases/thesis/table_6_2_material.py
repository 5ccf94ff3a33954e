"""Table 6.2 from the material alone: stresses of the tripod's bars with logarithmic strain

The joint of Table 6.2's tripod is moved by u along the middle bar (length l, no. 2); the outer ones (1, 3) have length
sqrt(2) l and stand at 45°. Without elements: each bar is one point of the law under ε = ln(length / first length), so
ε2 = ln(1 + u/l) and ε13 = ½ ln(½ (1 + (1 + u/l)²)). Increments of 1e-4, return mapping. On release u follows from F =
σ2 + 2 cos φ σ13 with the areas of the start, tan φ = l/(l + u), which is the relation of the printed columns; u itself
is printed with two digits, which on release is 6 % of σF. Release is judged by 1 % of σF, as in `table_6_2`, where the
misprint is also explained.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from scipy.optimize import brentq

from coilset.model.core.base.style import STYLE
from coilset.model.core.material import library
from coilset.model.core.material.law.law import Law
from coilset.model.core.material.point import points
from coilset.verification.cases.thesis.table_6_2 import PULL, READ, RELEASE, YIELD
from coilset.verification.study import Study

FAST = True


def strains(u: float) -> np.ndarray:
    """ε of the outer bars and of the middle one at u/l."""
    return np.array([0.5 * np.log(0.5 * (1 + (1 + u) ** 2)), np.log(1 + u)])


def force(u: float, stress: np.ndarray) -> float:
    """F/A0 of σ13 and σ2, N/mm²."""
    return stress[1] + 2 * (1 + u) / np.hypot(1, 1 + u) * stress[0]


def move(law: Law, state: np.ndarray, u: float, end: float) -> np.ndarray:
    """State of both bars after the joint went from u to end."""
    path = np.linspace(u, end, max(2, int(np.ceil(abs(end - u) / 1e-4)) + 1))
    for step in np.diff([strains(at) for at in path], axis=0):
        state, _, _ = points.update(law, state, np.column_stack([step, np.zeros((2, 2))]))
    return state


def release(law: Law, state: np.ndarray, u: float, load: float) -> tuple[np.ndarray, float]:
    """State of both bars and u/l where the force is `load`."""
    end = brentq(lambda end: force(end, move(law, state, u, end)[:, 0]) - load, u - 0.02, u)
    return move(law, state, u, end), end


def run(study: Study) -> None:
    """Loading at the printed displacements, release at the printed forces."""
    law = library.load("ck15", spin=True)
    state, u, rows = points.initial_state(law, 2), 0.0, []
    for end, *_ in PULL:
        state, u = move(law, state, u, end / 100), end / 100
        rows.append([100 * u, force(u, state[:, 0]) / YIELD, *(state[:, 0] / YIELD)])
    for _, load, *_ in RELEASE:
        state, u = release(law, state, u, load * YIELD)
        rows.append([100 * u, force(u, state[:, 0]) / YIELD, *(state[:, 0] / YIELD)])
    printed = np.array([row[:4] for row in PULL + RELEASE])
    for k, (mine, table) in enumerate(zip(rows, printed, strict=True)):
        kind = "relative" if k < len(PULL) else "absolute"
        for column, name in ((2, "σ13"), (3, "σ2")):
            misprint = READ.get((table[0], name))
            source = "Table 6.2, misprint corrected" if misprint else "Table 6.2"
            study.check(
                f"{name}/σF at u/l = {table[0]:g} %", mine[column], misprint or table[column], source, 0.01, kind
            )
    study.table(
        "ours / Table 6.2",
        ["10² u/l", "F/σF A0", "σ13/σF", "σ2/σF"],
        [
            [f"{a:.3f} / {b:.3f}" for a, b in zip(mine, table, strict=True)]
            for mine, table in zip(rows, printed, strict=True)
        ],
    )
    _draw(study, np.array(rows), printed)


def _draw(study: Study, ours: np.ndarray, printed: np.ndarray) -> None:
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.4, 4.2), layout="constrained")
        axes = figure.add_subplot()
        for column, name in ((2, "σ13"), (3, "σ2")):
            axes.plot(ours[:, 0], ours[:, column], lw=1.2, label=f"{name}/σF, the law with logarithmic strain")
            axes.plot(
                printed[:, 0],
                printed[:, column],
                "o",
                ms=4,
                mfc="none",
                color=axes.lines[-1].get_color(),
                label=f"{name}/σF, Table 6.2 of the thesis",
            )
        axes.set(
            xlabel="10² u/l", ylabel="stress over σF = 181.5 N/mm²", title="Tripod: stresses from the material alone"
        )
        axes.grid(lw=0.3)
        axes.legend(fontsize=8)
    study.figure("table_6_2_material", figure)
