"""Curved rod rotated rigidly four times about a skew axis: no stress, and back where it was

One end of a stress-free helix is rotated by 8π about the axis (1, 2, 3), which is not an axis of symmetry; the other
nodes are free. Every state is a rigid motion. Tolerance: 1e-9 MPa, about 1e-14 of the elastic modulus times the number
of steps; positions to 1e-9 mm.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from coilset.model.core.base.style import STYLE
from coilset.model.core.material import library
from coilset.verification.chain import ROTATION_X, X, chain, drive
from coilset.verification.study import Study

FAST = True
ELEMENTS, RADIUS = 24, 2.5
AXIS, ANGLE = np.array([1.0, 2.0, 3.0]) / np.sqrt(14.0), 8.0 * np.pi
STEPS = (32, 64)


def rotate(steps: int) -> tuple[np.ndarray, float, list[int]]:
    """Maximum stress after each step, MPa, distance of the nodes from their start, mm, and iterations of the steps."""
    angle = np.linspace(0.0, 3.0 * np.pi, ELEMENTS + 1)
    nodes = np.stack([20.0 * np.cos(angle), 20.0 * np.sin(angle), 2.0 * angle], axis=1)
    frame, stress = chain(nodes, RADIUS, library.load("elastic"), held=()), []
    moves = {frame.dof(0, X + k): 0.0 for k in range(3)} | {
        frame.dof(0, ROTATION_X + k): ANGLE * AXIS[k] for k in range(3)
    }
    counts = drive(frame, steps, moves, after=lambda: stress.append(np.abs(frame.rod.point_state[..., :3]).max()))
    back = max(float(np.linalg.norm(frame.moved(node))) for node in range(ELEMENTS + 1))
    return np.array(stress), back, counts


def run(study: Study) -> None:
    """Stress and position after four full rotations."""
    rows, found = [], {}
    for steps in STEPS:
        found[steps], back, counts = rotate(steps)
        at = f"after {ANGLE / np.pi:g}π in {steps} steps"
        study.check(f"maximum stress on the way, MPa, {at}", found[steps].max(), 0.0, "rigid", 1e-9, "absolute")
        study.check(f"maximum distance from the start, mm, {at}", back, 0.0, "rigid", 1e-9, "absolute")
        rows.append([steps, max(counts), sum(counts)])
    study.table("iterations", ["steps", "maximum per step", "all"], rows)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.2, 3.4), layout="constrained")
        axes = figure.add_subplot()
        for steps, stress in found.items():
            axes.semilogy(
                ANGLE / np.pi * np.arange(1, steps + 1) / steps, stress, "o-", ms=3, lw=0.8, label=f"{steps} steps"
            )
        axes.axhline(1e-9, color="0.5", lw=0.8, ls="--", label="tolerance")
        axes.set(xlabel="angle over π", ylabel="maximum stress in MPa", title="Helix rotated rigidly")
        axes.grid(lw=0.3)
        axes.legend(fontsize=8)
    study.figure("rigid_rotations", figure)
