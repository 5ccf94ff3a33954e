"""Long clamped spring: the travel at which its straight axis is no longer stable, against Haringx

Wire 5, D 40, 40 turns of pitch 12 between clamped heads, elastic. Haringx's column (`references/stability.py`) buckles
at 39.16 mm and 96.51 N. Here the tangent of the free unknowns is examined after each step: its lowest eigenvalue falls
almost in proportion to the travel, and no pivot is negative up to 38 mm; a parabola through its last three values gives
the travel at which it vanishes, and the force there. No path leads right up to that point: the ends of a helix push to
one side, and near the critical travel the axis deflects to that side. The section is plane, because Haringx's
stiffnesses are those of straight wire.

The axis of the lowest mode at the last step is compared with ½ (1 − cos 2πz/L), that of a column between clamped heads,
whether or not it is soft in shear; averaging over a turn leaves out the half turns next to the heads.

Tolerance: 1.5 tan² α = 1.4 %, because Haringx neglects the pitch angle (tan α = 0.0955), whose square enters the
stiffnesses; comparing 8 rods per turn with 16 shows the effect of the mesh.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.style import STYLE
from coilset.model.core.case import check
from coilset.model.core.material import library
from coilset.model.core.results.records.record import Step
from coilset.model.tools.figures.panels.buckling import column, mode_axis, plane
from coilset.verification.references.stability import clamped_spring
from coilset.verification.stability import lowest_eigenvalue, negative_pivots, tangent
from coilset.verification.study import Study

FAST = False
WIRE, DIAMETER, TURNS, PITCH = 5.0, 40.0, 40, 12.0  # mm
LAST, STEPS = 38.0, 19  # mm of travel
MESHES = (8, 16)


def press(mesh: int) -> tuple[np.ndarray, float]:
    """Travel (mm), force (N), lowest eigenvalue, negative pivots after each step, shape (STEPS, 4), and `mode_off`."""
    spring = {"wire_diameter": WIRE, "mean_diameter": DIAMETER, "turns": TURNS, "pitch": PITCH}
    case = check(
        {
            "spring": spring,
            "material": "elastic",
            "ends": "clamped",
            "mesh": {"elements_per_turn": mesh, "section": {"kind": "plane"}},
            "loading": [{"to": {"travel": LAST}, "steps": STEPS}],
        }
    )
    analysis, rows = Analysis(case, MPI.COMM_SELF), []

    def keep(step: Step) -> None:
        matrix = tangent(analysis.system, analysis.control.to_height(analysis.control.height))
        rows.append((step.travel_mm, step.force_N, lowest_eigenvalue(matrix), negative_pivots(matrix)))

    analysis.run(keep)
    return np.array(rows), mode_off(analysis)


def mode_off(analysis: Analysis) -> float:
    """Deviation of the axis of the lowest mode from that of a clamped column, over its maximum displacement."""
    mode, turns = analysis.result.mode, analysis.setup.turns
    assert mode is not None
    height, aside = mode_axis(mode.x, mode.displacement, turns, plane(mode.displacement, turns))
    exact = column(height, mode.x[0, 2], mode.x[-1, 2])
    return float(np.abs(aside / (aside @ exact) * (exact @ exact) - exact).max())


def critical(rows: np.ndarray) -> tuple[float, float]:
    """Travel and force at which the lowest eigenvalue vanishes, by parabolas through the last three steps, mm and N."""
    travel, force, least = rows[-3:, :3].T
    roots = np.roots(np.polyfit(travel, least, 2))
    at = min(roots[np.isreal(roots)].real, key=lambda root: abs(root - travel[-1]))
    return float(at), float(np.polyval(np.polyfit(travel, force, 2), at))


def run(study: Study) -> None:
    """Critical travel and force."""
    law, pressed = library.load("elastic"), {mesh: press(mesh) for mesh in MESHES}
    found = {mesh: rows for mesh, (rows, _) in pressed.items()}
    travel, force = clamped_spring(WIRE, DIAMETER, TURNS, TURNS * PITCH, law.E, law.G)
    ours = {mesh: critical(rows) for mesh, rows in found.items()}
    tolerance = 1.5 * (PITCH / (np.pi * DIAMETER)) ** 2
    study.check("travel at which it buckles, mm", ours[MESHES[-1]][0], travel, "Haringx", tolerance)
    study.check("force at which it buckles, N", ours[MESHES[-1]][1], force, "Haringx", tolerance)
    study.check(f"negative pivots up to {LAST:g} mm", found[MESHES[-1]][:, 3].max(), 0, "stability", kind="at_most")
    study.check(
        "lowest mode's deviation from a clamped column's, over its maximum",
        pressed[MESHES[-1]][1],
        0,
        "clamped column",
        tolerance,
        kind="absolute",
    )
    study.table("critical travel and force", ["rods per turn", "mm", "N"], [[mesh, *ours[mesh]] for mesh in MESHES])
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.6, 3.6), layout="constrained")
        axes = figure.add_subplot()
        for mesh, marker in zip(MESHES, "+o", strict=True):
            rows = found[mesh]
            axes.plot(rows[:, 0], rows[:, 2] / rows[0, 2], marker, ms=4, mfc="none", label=f"{mesh} rods per turn")
            axes.plot([rows[-1, 0], ours[mesh][0]], [rows[-1, 2] / rows[0, 2], 0.0], "k:", lw=0.8)
        axes.axvline(travel, color="C3", lw=0.9, label=f"Haringx, {travel:.2f} mm")
        axes.set(
            xlabel="travel in mm", ylabel="lowest eigenvalue over that at 2 mm", title="40 turns between clamped heads"
        )
        axes.grid(lw=0.3)
        axes.legend(fontsize=8)
    study.figure("buckling_of_springs", figure)
