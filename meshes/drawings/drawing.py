"""The drawing of a spring: side view with dimensions, pitch and diameters over the turn."""

from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from coilset.meshes.springs.geometry import Spring

PIECES_PER_TURN = 96
OUTLINE = 1.0  # width of an outline, points
INK, STEEL_FACE, DIMENSION = "0.15", "0.85", "C0"


def drawing(spring: Spring, title: str = "") -> Figure:
    """Draw a spring.

    Args:
        spring: `Spring`.
        title: of the figure.

    The look is that of matplotlib's parameters at the time; the colours are three of its cycle.

    Returns:
        A `matplotlib.figure.Figure`; its size must not change, so that the wire's thickness stays to scale.
    """
    figure = Figure(figsize=(9.6, 5.4))
    view = figure.add_axes((0.01, 0.02, 0.5, 0.9))
    _side_view(view, spring)
    _over_turn(figure.add_axes((0.575, 0.58, 0.35, 0.34)), spring, spring.pitch, "pitch in mm", "C2")
    below = figure.add_axes((0.575, 0.11, 0.35, 0.34))
    _over_turn(below, spring, lambda t: 2 * spring.mean_radius(t), "mean diameter D in mm", "C0")
    below.set_xlabel("turns from the bottom tip")
    wire = below.twinx()
    wire.spines["right"].set_visible(True)
    name = "diameter" if spring.section is None else "height"
    _over_turn(wire, spring, spring.wire_diameter, f"wire {name} d in mm", "C1", ls="--")
    figure.text(0.02, 0.955, title, fontsize=12)
    return figure


def _over_turn(
    axes: Axes, spring: Spring, function: Callable[[np.ndarray], np.ndarray], label: str, color: str, ls: str = "-"
) -> None:
    t = spring.breaks
    values = function(t)
    axes.plot(t, values, color=color, lw=1.4, ls=ls)
    axes.set_xlim(0, spring.turns)
    axes.set_ylim(0, 1.12 * values.max())
    axes.set_ylabel(label, color=color)
    axes.tick_params(axis="y", colors=color)
    for end in (spring.bottom.end_turns, spring.turns - spring.top.end_turns):
        if 0 < end < spring.turns:
            axes.axvline(end, color="0.6", lw=0.8, ls="--")


def _side_view(axes: Axes, spring: Spring) -> None:
    """The spring seen along the y axis, far half turns behind the near ones, its ends cut where they are ground."""
    t = spring.breaks
    if spring.has_tails:
        t = np.union1d(t, np.linspace(spring.corners[0], spring.corners[-1], 500))
    x, _, z = spring.centre_line(t).T
    half = 0.5 * spring.wire_diameter(t)
    reach = np.max(np.maximum(spring.mean_radius(t), np.abs(x) * spring.has_tails) + spring.width * half)
    low, high = spring.levels
    low, high = (min(low, np.min(z - half)), max(high, np.max(z + half))) if spring.has_tails else (low, high)
    size = max(high - low, 2 * reach)
    axes.set_axis_off()
    axes.set_aspect("equal", adjustable="box", anchor="C")
    axes.set_xlim(-reach - 0.25 * size, reach + 0.25 * size)
    axes.set_ylim(low - 0.2 * size, high + 0.2 * size)
    axes.apply_aspect()
    points_per_mm = axes.get_window_extent().width / np.ptp(axes.get_xlim()) * 72 / axes.figure.dpi
    cut = Rectangle((-2 * reach, low), 4 * reach, high - low, transform=axes.transData)
    for depth, turns in _pieces(spring):
        seen = spring.centre_line(turns)[:, [0, 2]]
        pieces = np.stack([seen[:-1], seen[1:]], axis=1)
        width = spring.wire_diameter(0.5 * (turns[1:] + turns[:-1])) * points_per_mm
        for order, (color, narrower) in enumerate(((INK, 0.0), (STEEL_FACE, 2 * OUTLINE))):
            wire = LineCollection(
                pieces,
                colors=color,
                linewidths=np.maximum(width - narrower, 0.2),
                capstyle="round",
                zorder=depth + 0.5 * order,
            )
            axes.add_collection(wire, autolim=False)
            wire.set_clip_path(cut)
    _dimensions(axes, spring, reach, size, (low, high))


def _pieces(spring: Spring) -> Iterator[tuple[int, np.ndarray]]:
    """Drawing order and turns of the pieces of the wire: hooks and arms, and the coil split where it changes between
    the far and the near side."""
    half = np.pi * spring.hand
    first = spring.phase / half
    marks = (np.arange(np.ceil(min(first, first + 2 * spring.turns)), max(first, first + 2 * spring.turns)) - first) / 2
    marks = np.unique(np.concatenate([[0.0], np.abs(marks), [spring.turns], spring.corners[[0, -1]]]))
    for start, end in pairwise(marks):
        turns = np.linspace(start, end, max(3, int(PIECES_PER_TURN * (end - start)) + 1))
        depth = float(spring.centre_line(turns)[:, 1].mean())
        is_between = spring.has_tails and abs(depth) < 0.3 * spring.mean_radius(start)  # as a hook over the axis
        yield (500 if is_between else 1 if depth > 0 else 1000) + round(2 * start), turns


def _dimensions(axes: Axes, spring: Spring, reach: float, size: float, span: tuple[float, float]) -> None:
    length, last = spring.free_length, spring.turns
    for level in spring.levels:
        axes.plot([-reach - 0.05 * size, reach + 0.2 * size], [level, level], color=DIMENSION, lw=0.7, zorder=0)
    low, high = spring.levels
    _dimension(axes, (reach + 0.15 * size, low), (reach + 0.15 * size, high), f"L0 = {length:.4g} mm")
    t = spring.breaks
    outer = 2 * spring.mean_radius(t) + spring.width * spring.wire_diameter(t)
    for turn, level in ((0.0, span[0] - 0.09 * size), (last, span[1] + 0.09 * size)):
        d, radius = spring.width * spring.wire_diameter(turn), spring.mean_radius(turn)
        _dimension(axes, (-radius - d / 2, level), (radius + d / 2, level), f"De = {2 * radius + d:.4g} mm")
    widest = t[np.argmax(outer)]
    if outer.max() > 1.001 * max(outer[0], outer[-1]):
        axes.text(
            -reach - 0.2 * size,
            spring.centre_line(widest)[2],
            f"De = {outer.max():.4g} mm\nwidest",
            ha="center",
            va="center",
            rotation=90,
            color=DIMENSION,
        )


def _dimension(axes: Axes, start: tuple[Any, Any], end: tuple[Any, Any], text: str) -> None:
    axes.annotate(
        "", start, end, arrowprops={"arrowstyle": "<->", "color": DIMENSION, "lw": 0.9, "shrinkA": 0, "shrinkB": 0}
    )
    upright = start[0] == end[0]
    middle = (0.5 * (start[0] + end[0]), 0.5 * (start[1] + end[1]))
    axes.annotate(
        text,
        middle,
        (6, 0) if upright else (0, 3),
        textcoords="offset points",
        color=DIMENSION,
        rotation=90 if upright else 0,
        ha="left" if upright else "center",
        va="center" if upright else "bottom",
    )
