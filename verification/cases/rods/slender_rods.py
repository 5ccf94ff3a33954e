"""Slender rods, r/L = 1e-2, 1e-3 and 1e-4, 8 to 128 elements: elastica and two circles, iterations per step

The same problems as in the cases elastica and two-circles, where the wire's radius is 1e-2 L and values are judged.
After a correction with finite rotations the axial and shear forces are wrong by EA ½ w′², which grows with (L/r)²; if
the tangent is built with these forces, Newton's method creeps or fails. Other elements take these steps in about the
same number of iterations at any slenderness (D. Magisano, L. Leonetti, G. Garcea, Int. J. Num. Meth. Eng. 112 (2017)
1685, mixed integration point); at most 8 per step are required here. The values, where they are reached, are judged as
in the other two cases; at r/L = 1e-3 shear contributes 6.5e-6.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from coilset.model.core.base.style import STYLE
from coilset.model.core.material import library
from coilset.verification.chain import ALL, ROTATION_X, ROTATION_Y, ROTATION_Z, Y, Z, chain, straight
from coilset.verification.frame import Frame
from coilset.verification.references.elastica import cantilever
from coilset.verification.study import Study

FAST = False
LENGTH, STEPS, WANTED = 100.0, 10, 8
SLENDERNESS, MESHES = (1e-2, 1e-3, 1e-4), (8, 32, 128)
THICK = (
    1e-2  # r/L at which shear would show against the elliptic integrals; its values are judged in the other two cases
)
LOAD = 10.0  # PL²/EI of the elastica


def take_steps(
    frame: Frame, forces: dict[int, float] | None = None, moves: dict[int, float] | None = None
) -> tuple[list[int], bool]:
    """Iterations of ten equal steps, as many as converge, and whether all did."""
    counts = []
    for k in range(1, STEPS + 1):
        loads = {dof: value * k / STEPS for dof, value in (forces or {}).items()}
        parts = {dof: value / STEPS for dof, value in (moves or {}).items()}
        outcome = frame.step(moves=parts, forces=loads, predictor_scale=None if k == 1 else 1.0)
        counts.append(outcome.iterations)
        if not outcome.converged:
            return counts, False
    return counts, True


def elastica(slenderness: float, elements: int) -> tuple[list[int], bool, float]:
    """Iterations, whether all steps converged, and v/L of the tip."""
    law, radius = library.load("elastic"), slenderness * LENGTH
    frame = chain(straight(LENGTH, elements), radius, law)
    force = LOAD * law.E * np.pi * radius**4 / 4.0 / LENGTH**2
    counts, done = take_steps(frame, forces={frame.dof(elements, Y): force})
    return counts, done, frame.moved(elements)[1] / LENGTH


def circles(slenderness: float, elements: int) -> tuple[list[int], bool, float]:
    """Iterations, whether all steps converged, and the distance of the tip from the clamp over L."""
    plane = [(node, (Z, ROTATION_X, ROTATION_Y)) for node in range(1, elements + 1)]
    frame = chain(straight(LENGTH, elements), slenderness * LENGTH, library.load("elastic"), held=[(0, ALL), *plane])
    counts, done = take_steps(frame, moves={frame.dof(elements, ROTATION_Z): 4.0 * np.pi})
    return counts, done, float(np.linalg.norm(np.add(frame.moved(elements), [LENGTH, 0.0, 0.0]))) / LENGTH


def run(study: Study) -> None:
    """Iterations of both problems; values where the end was reached."""
    most, rows = {}, []
    for name, solve in (("elastica", elastica), ("two circles", circles)):
        for slenderness in SLENDERNESS:
            for n in MESHES:
                counts, done, value = solve(slenderness, n)
                at = f"{name}, r/L = {slenderness:g}, {n} rods"
                most[name, slenderness, n] = max(counts) if done else np.inf
                study.check(
                    f"maximum iterations per step, {at}",
                    max(counts) if done else np.inf,
                    WANTED,
                    "required",
                    kind="at_most",
                )
                if done and slenderness < THICK and name == "elastica":
                    exact = cantilever(LOAD)[1]
                    study.check(f"v/L, {at}", value, exact, "elliptic integrals", 0.02 * LOAD / n**2 + 1e-5, "absolute")
                elif done and slenderness < THICK:
                    study.check(f"tip to clamp over L, {at}", value, 0.0, "closed circles", 1e-6, "absolute")
                rows.append([name, slenderness, n, " ".join(map(str, counts)) + ("" if done else " failed")])
    study.table(f"iterations, {STEPS} steps", ["problem", "r/L", "rods", "iterations per step"], rows)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.6, 3.4), layout="constrained")
        axes, names = (
            figure.add_subplot(),
            [f"{name}\nr/L = {s:g}" for name in ("elastica", "two circles") for s in SLENDERNESS],
        )
        values = np.array(list(most.values())).reshape(-1, len(MESHES))
        top = max(WANTED, values[np.isfinite(values)].max(initial=0.0))
        for k, n in enumerate(MESHES):
            heights = np.where(np.isfinite(values[:, k]), values[:, k], 1.1 * top)
            axes.bar(np.arange(len(names)) + 0.25 * (k - 1), heights, 0.22, label=f"{n} rods")
        for place, k in np.argwhere(~np.isfinite(values)):
            axes.text(place + 0.25 * (k - 1), 1.12 * top, "failed", ha="center", va="bottom", rotation=90, fontsize=7)
        axes.axhline(WANTED, color="0.4", lw=0.8, ls="--", label="required")
        axes.set_xticks(range(len(names)), names)
        axes.set(ylabel="maximum iterations per step", ylim=(0, 1.6 * top))
        axes.legend(fontsize=8, ncols=4, loc="upper center")
    study.figure("slender_rods", figure)
