"""The picture of a buckling mode: the spring before it goes off its axis, and where it would go."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.interpolate import CubicSpline

from coilset.model.base.style import STYLE
from coilset.model.figures.figures import save
from coilset.model.results.records.buckling import turn_means
from coilset.model.results.records.labels import plain
from coilset.model.results.records.record import BucklingMode, Result, Setup

POINTS_PER_TURN = 48
SHOWN = 0.4  # of the mean diameter: by how much the axis is drawn aside


def buckling_mode(path: str | Path, setup: Setup, result: Result, summary: Mapping[str, Any]) -> None:
    """The spring seen across the plane in which its axis would go off, and its axis over the height.

    Args:
        path: PNG to write.
        setup, result, summary: of a run with a BucklingMode.
    """
    mode = result.mode
    assert mode is not None
    across = plane(mode, setup.turns)
    height, aside = axis(mode, setup.turns, across)
    fine = np.linspace(setup.turns[0], setup.turns[-1], round(POINTS_PER_TURN * np.ptp(setup.turns)) + 1)
    x, moved = (CubicSpline(setup.turns, values)(fine) for values in (mode.x, mode.displacement))
    scale = SHOWN * setup.mean_diameter / np.abs(aside).max()
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(7.6, 5.0), layout="constrained")
        view, line = figure.subplots(1, 2, width_ratios=(1.3, 1.0))
        for displaced, style in ((0.0, {"color": "0.75", "lw": 1.2}), (scale, {"color": "C0", "lw": 1.8})):
            wire = x + displaced * moved
            view.plot(wire[:, :2] @ across, wire[:, 2], **style)
        view.plot(scale * aside, height, "C1--", lw=1.0)
        view.set(
            aspect="equal",
            xlabel="in the plane of the mode in mm",
            ylabel="height in mm",
            title=f"travel {plain(mode.travel_mm)} mm, {plain(mode.force_N)} N",
        )
        _axis(line, height, aside, mode)
        buckled = summary["buckling_travel_mm"]
        found = "did not buckle in this run" if buckled is None else f"buckled at {plain(buckled)} mm of travel"
        figure.suptitle(f"The spring {found}; the weakest mode of the tangent")
        save(figure, path)


def _axis(axes: Axes, height: np.ndarray, aside: np.ndarray, mode: BucklingMode) -> None:
    """The axis over the height, and a clamped column's mode."""
    bottom, top = float(mode.x[0, 2]), float(mode.x[-1, 2])
    z = np.linspace(bottom, top, 101)
    axes.plot(aside / np.abs(aside).max(), height, "C1", label="mean of a turn")
    axes.plot(column(z, bottom, top), z, "k:", lw=0.9, label="clamped column")
    axes.set(xlabel="displacement over its maximum", ylim=(min(bottom, height[0]), max(top, height[-1])))
    axes.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.12), ncols=2)
    axes.grid(lw=0.3)


def plane(mode: BucklingMode, turns: np.ndarray) -> np.ndarray:
    """Unit vector across the spring's axis in whose direction the mode goes most, shape (2,)."""
    moved = turn_means(mode.displacement[:, :2], turns)
    direction = np.linalg.svd(moved, full_matrices=False)[2][0]
    along = moved @ direction
    return np.asarray(direction * np.sign(along[np.abs(along).argmax()]))


def axis(mode: BucklingMode, turns: np.ndarray, across: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Height of each turn's mean, mm, and its displacement along `across`, of a mode of 1 mm, shapes (m,)."""
    height = turn_means(mode.x[:, 2:], turns)[:, 0]
    return height, turn_means(mode.displacement[:, :2], turns) @ across


def column(z: np.ndarray, bottom: float, top: float) -> np.ndarray:
    """Mode of a column that is clamped at both ends, greatest 1: ½ (1 − cos 2π(z − bottom)/(top − bottom))."""
    return 0.5 * (1.0 - np.cos(2.0 * np.pi * (z - bottom) / (top - bottom)))
