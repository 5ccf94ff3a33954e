"""Cantilever rolled up to two circles by an end moment, against the circle

An end moment bends a straight rod to a circle of curvature M/EI; at M = 4π EI/L it closes twice. The tip is rotated by
4π about the axis perpendicular to the plane and is free within it; the moment is the reaction. (Out of the plane all
nodes are held: a rod whose end was turned by 4π can unwind through space, and with the other nodes free the tangent has
a negative pivot from 0.8 circles on.) Straight rods of length l = L/n form a polygon of equal angles φ = 4π/n with M =
EI φ/l: tip and moment are those of the circle for any n, up to the axial strain, which is zero. Tolerance: that of the
iteration, 1e-7. The polygon's corners lie on a circle of radius l/(2 sin(φ/2)) instead of l/φ: the rod's maximum height
2R is too large by φ²/24, and the tolerance is φ²/20.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from coilset.model.core.base.style import STYLE
from coilset.model.core.material import library
from coilset.verification.chain import ALL, ROTATION_X, ROTATION_Y, ROTATION_Z, Z, chain, drive, straight
from coilset.verification.frame import Frame
from coilset.verification.study import Study

FAST = True
LENGTH, RADIUS = 100.0, 1.0  # mm
STEPS = 20
MESHES = (16, 32, 64)


def roll(elements: int) -> tuple[float, list[np.ndarray], list[int]]:
    """M L/EI, positions of all nodes after half and after all of the steps, and iterations of the steps."""
    law, nodes, shapes = library.load("elastic"), straight(LENGTH, elements), []
    plane = [(node, (Z, ROTATION_X, ROTATION_Y)) for node in range(1, elements + 1)]
    frame = chain(nodes, RADIUS, law, held=[(0, ALL), *plane])
    turn = frame.dof(elements, ROTATION_Z)
    counts = drive(frame, STEPS, {turn: 4.0 * np.pi}, after=lambda: shapes.append(positions(frame, nodes)))
    EI = law.E * np.pi * RADIUS**4 / 4.0
    return frame.force(turn) * LENGTH / EI, shapes, counts


def positions(frame: Frame, nodes: np.ndarray) -> np.ndarray:
    """Positions of all nodes, shape (n, 3), mm."""
    return np.array([node + frame.moved(k) for k, node in enumerate(nodes)])


def run(study: Study) -> None:
    """Moment, tip and height."""
    rows = []
    shapes: list[np.ndarray] = []
    for n in MESHES:
        moment, shapes, counts = roll(n)
        angle, height = 4.0 * np.pi / n, np.ptp(shapes[-1][:, 1])
        study.check(f"M L/EI, {n} rods", moment, 4.0 * np.pi, "M = EI κ", 1e-6)
        tip = np.linalg.norm(shapes[-1][-1]) / LENGTH
        study.check(
            f"distance of the tip from the clamp over L, {n} rods", tip, 0.0, "closed circles", 1e-6, "absolute"
        )
        study.check(f"height over L, {n} rods", height / LENGTH, 0.5 / np.pi, "2R = L/2π", angle**2 / 20.0)
        rows.append([n, max(counts), sum(counts)])
    study.table(f"iterations, {STEPS} steps, r/L = 1e-2", ["rods", "maximum per step", "all"], rows)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.0, 3.6), layout="constrained")
        axes = figure.add_subplot()
        for k in range(1, STEPS, 3):
            axes.plot(*shapes[k][:, :2].T, "-", color="C0", lw=0.5 + 0.05 * k, alpha=0.35 + 0.03 * k)
        axes.plot(*shapes[-1][:, :2].T, "C3-", lw=1.5, label="M = 4π EI/L")
        axes.set(
            aspect="equal", xlabel="x in mm", ylabel="y in mm", title=f"Rolled up to two circles, {MESHES[-1]} rods"
        )
        axes.legend(fontsize=8)
    study.figure("two_circles", figure)
