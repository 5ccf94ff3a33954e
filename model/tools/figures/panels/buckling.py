"""The buckling mode of a slender spring: the shape in which the spring would leave its axis."""

from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from coilset.model.core.results.files.opened import Run
from coilset.model.core.results.records.axis import turn_means
from coilset.model.core.results.records.labels import plain
from coilset.model.tools.figures.panels.panel import GREY, Panel, axis, curve

POINTS_PER_TURN = 48
SHOWN = 0.4  # of the mean diameter: the largest displacement of the axis in the figure


def buckling_mode(run: Run) -> Panel | None:
    """The spring seen across the plane of its mode, and displaced by it; None of a spring that cannot buckle."""
    if "mode_position" not in run.data:
        return None
    turns, x, moved = _mode(run)
    across = plane(moved, turns)
    height, aside = mode_axis(x, moved, turns, across)
    fine = np.linspace(turns[0], turns[-1], round(POINTS_PER_TURN * np.ptp(turns)) + 1)
    x, moved = (CubicSpline(turns, values)(fine) for values in (x, moved))
    diameter = 2.0 * float(np.hypot(*x[len(x) // 2, :2]))
    scale = SHOWN * diameter / np.abs(aside).max()
    traces = []
    for part, drawn in ((0.0, {"colour": GREY, "name": "at equilibrium"}), (scale, {"colour": 0, "name": "its mode"})):
        wire = x + part * moved
        traces.append(curve(wire[:, :2] @ across, wire[:, 2], **drawn))
    traces.append(curve(scale * aside, height, 1, dash="dash", width=1.5, name="axis"))
    buckled = run.summary["buckling_travel_mm"]
    outcome = "did not buckle in this run" if buckled is None else f"buckled at {plain(buckled)} mm of travel"
    state = run.data["mode_position"].attrs
    finding = f"The spring {outcome}"
    return Panel(
        "buckling_mode",
        finding,
        f"{finding}. Weakest mode of the tangent, at a travel of {state['travel_mm']} mm and {state['force_N']} N.",
        traces,
        {"xaxis": axis("in the plane of the mode, mm"), "yaxis": axis("height, mm", scaleanchor="x")},
        height=520,
    )


def buckling_axis(run: Run) -> Panel | None:
    """Displacement of the axis over the height, beside a clamped column's; None of a spring that cannot buckle."""
    if "mode_position" not in run.data:
        return None
    turns, x, moved = _mode(run)
    height, aside = mode_axis(x, moved, turns, plane(moved, turns))
    bottom, top = float(x[0, 2]), float(x[-1, 2])
    z = np.linspace(bottom, top, 101)
    state = run.data["mode_position"].attrs
    finding = f"Weakest mode of the tangent, at {state['travel_mm']} mm and {state['force_N']} N"
    return Panel(
        "buckling_axis",
        finding,
        f"{finding}. Displacement of the axis over the height, beside that of a column clamped at both ends.",
        [
            curve(aside / np.abs(aside).max(), height, 1, name="mean of a turn"),
            curve(column(z, bottom, top), z, GREY, dash="dot", width=1.5, name="clamped column"),
        ],
        {"xaxis": axis("displacement over its maximum"), "yaxis": axis("height, mm")},
        height=520,
    )


def _mode(run: Run) -> tuple[np.ndarray, Any, Any]:
    """Turns of the stations, their positions, mm, and their displacements."""
    return tuple(run.data[name].values for name in ("turn", "mode_position", "mode_displacement"))


def plane(displacement: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """Unit vector across the spring's axis in whose direction a mode's displacement is largest, shape (2,)."""
    moved = turn_means(displacement[:, :2], turns)
    direction = np.linalg.svd(moved, full_matrices=False)[2][0]
    along = moved @ direction
    return np.asarray(direction * np.sign(along[np.abs(along).argmax()]))


def mode_axis(
    x: np.ndarray, displacement: np.ndarray, turns: np.ndarray, across: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Height of each turn's mean, mm, and its displacement along `across`, shapes (m,)."""
    return turn_means(x[:, 2:], turns)[:, 0], turn_means(displacement[:, :2], turns) @ across


def column(z: np.ndarray, bottom: float, top: float) -> np.ndarray:
    """Mode of a column clamped at both ends, maximum 1: ½ (1 − cos 2π(z − bottom)/(top − bottom))."""
    return 0.5 * (1.0 - np.cos(2.0 * np.pi * (z - bottom) / (top - bottom)))
