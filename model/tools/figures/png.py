"""Panels as PNG: plotly's traces and layout, drawn by matplotlib."""

import re
import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path as Outline

from coilset.model.core.base.style import DIVERGING, STYLE, as_written
from coilset.model.core.results.files.png_file import write
from coilset.model.tools.figures.panels.panel import COLOURS, Panel, Trace

POINTS = 0.6  # of the figure, to a pixel of the page
LETTERS = 14  # of a title, on an inch of a figure
LARGE = 11  # the same in the size of a single diagram's title
BESIDE = 4  # lines of a legend that fit beside a single diagram
WIDTH, HEIGHT = 5.2, 4.0  # inches of a panel
LINES = {"solid": "-", "dash": "--", "dot": ":", "dashdot": "-."}
SYMBOLS = {"circle": "o", "square": "s"}
MAPS = {"RdBu": DIVERGING, "Viridis": "viridis"}  # plotly's RdBu is red where positive


def save(figure: Figure, path: str | Path) -> None:
    """Write a figure as PNG; its colours `C0`, `C1`, … are looked up only now.

    The same picture as by `savefig`, which finds the layout, draws to be sure of it, and draws once more.
    """
    with mpl.rc_context(STYLE):
        as_written(figure)
        figure.dpi = STYLE["savefig.dpi"]
        canvas = FigureCanvasAgg(figure)
        canvas.draw()
        titles = [figure.get_suptitle(), *(axes.get_title() for axes in figure.axes)]
        title = "; ".join(" ".join(title.split()) for title in titles if title)
        write(path, np.asarray(canvas.buffer_rgba()), title, figure.dpi)


def add_title(figure: Figure, text: str) -> None:
    """Put a line below the title that a figure has, all of it broken to the figure's width."""
    figure.suptitle(broken(f"{figure.get_suptitle()}\n{text}", int(LETTERS * figure.get_figwidth())), fontsize=9)


def broken(text: str, letters: int) -> str:
    """Lines of a title that have no more letters than that; a number keeps its unit."""
    text = re.sub(r"(\d) (N|mm|MPa|%)", "\\1\u00a0\\2", text)
    return "\n".join(part for line in text.split("\n") for part in textwrap.wrap(line, letters))


def write_png(path: str | Path, panels: Sequence[Panel], source: str = "") -> None:
    """Write panels side by side, or in rows of two, as one PNG.

    Args:
        path: PNG to write.
        panels: of one with choices the last one is drawn; of contacts, which are chosen by kind, each.
        source: a line below the figure: what it was made from.
    """
    figure = png_figure(panels)
    if source:
        with mpl.rc_context(STYLE):
            figure.supxlabel(source, fontsize=6, color="0.5", x=0.99, ha="right")
    save(figure, path)


def png_figure(panels: Sequence[Panel]) -> Figure:
    """Figure of `write_png`."""
    drawn = [(panel, choice) for panel in panels for choice in _choices(panel)]
    columns = min(len(drawn), 2)
    rows = -(-len(drawn) // columns)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(max(WIDTH * columns, 6.4), HEIGHT * rows + 0.3), layout="constrained")
        for number, (panel, choice) in enumerate(drawn, start=1):
            axes = figure.add_subplot(rows, columns, number)
            draw(axes, panel, choice)
            title = panel.title if len(_choices(panel)) < 2 else f"{panel.title}: {panel.choices[choice]}"
            axes.set_title(broken(title, int(LARGE * figure.get_figwidth() / columns)))
    return figure


def _choices(panel: Panel) -> range:
    """Numbers of the choices that a PNG shows; a panel without choices has one."""
    count = max(len(panel.choices), 1)
    return range(count) if panel.choice == "contact of" else range(count - 1, count)


def draw(axes: Axes, panel: Panel, choice: int = 0) -> None:
    """Draw a choice of a panel.

    Raises:
        KeyError: if it has a kind of trace or shape that is not drawn here.
    """
    for trace in panel.traces:
        if trace.get("meta", {"choice": choice})["choice"] == choice:
            {"scatter": _scatter, "heatmap": _heatmap}[trace["type"]](axes, trace)
    for shape in panel.layout.get("shapes", ()):
        {"line": _line, "path": _path}[shape["type"]](axes, shape)
    for note in panel.layout.get("annotations", ()):
        _annotate(axes, note)
    for name in "xy":
        _axis(axes, name, panel.layout.get(f"{name}axis", {}))
    entries = len(axes.get_legend_handles_labels()[1])
    if entries > BESIDE:
        axes.legend(fontsize=7, loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=2)
    elif entries:
        axes.legend(fontsize=7, frameon=True, framealpha=0.8, edgecolor="none")
    if not any(trace["type"] == "heatmap" for trace in panel.traces):
        axes.grid(lw=0.3)


def _scatter(axes: Axes, trace: Trace) -> None:
    x, y = (np.array(trace[name], dtype=float) for name in "xy")
    line, marker, mode = trace.get("line", {}), trace.get("marker", {}), trace["mode"]
    symbol, size = SYMBOLS[marker.get("symbol", "circle")], POINTS * marker.get("size", 0)
    if isinstance(marker.get("color"), np.ndarray):
        edge = marker["line"]
        shown = axes.scatter(
            x,
            y,
            size**2,
            marker["color"],
            marker=symbol,
            cmap=MAPS[marker["colorscale"]],
            vmin=marker["cmin"],
            vmax=marker["cmax"],
            edgecolors=edge["color"],
            linewidths=POINTS * edge["width"],
        )
        _scale(axes, shown, marker["colorbar"])
        return
    axes.plot(
        x,
        y,
        ls=LINES[line.get("dash", "solid")] if "lines" in mode else "",
        lw=POINTS * line.get("width", 2),
        marker=symbol if "markers" in mode else "",
        ms=size,
        color=line.get("color") or marker.get("color", COLOURS[0]),
        markerfacecolor=marker.get("color", line.get("color")),
        markeredgewidth=0.0,
        alpha=trace.get("opacity"),
        label=trace.get("name") if trace.get("showlegend", True) else None,
    )


def _heatmap(axes: Axes, trace: Trace) -> None:
    x, y = trace["x"], trace["y"]
    ends = (x[0], x[-1], y[0], y[-1])
    limits = {"vmin": trace["zmin"], "vmax": trace["zmax"], "cmap": MAPS[trace["colorscale"]]}
    aspect = "equal" if np.isclose(x[-1] - x[0], y[-1] - y[0]) else "auto"  # of a place across the wire, or a map
    shown = axes.imshow(trace["z"], origin="lower", extent=ends, interpolation="bilinear", aspect=aspect, **limits)
    _scale(axes, shown, trace["colorbar"])


def _scale(axes: Axes, shown: Any, bar: dict[str, Any]) -> None:
    axes.figure.colorbar(shown, ax=axes, label=bar["title"]["text"], shrink=bar.get("len", 1.0))


def _line(axes: Axes, shape: dict[str, Any]) -> None:
    line = {"color": shape["line"]["color"], "lw": shape["line"]["width"], "ls": LINES[shape["line"]["dash"]]}
    axes.axvline(shape["x0"], **line)


def _path(axes: Axes, shape: dict[str, Any]) -> None:
    """Closed polygons of one orientation, the second a hole in the first."""
    points, codes = [], []
    for number, part in enumerate(re.findall(r"M([^MZ]*)", shape["path"])):
        corners = [tuple(map(float, corner.split(","))) for corner in part.replace("L", " ").split()]
        corners = corners[::-1] if number else corners  # filled where windings add up
        points += [*corners, corners[0]]
        codes += [Outline.MOVETO, *[Outline.LINETO] * (len(corners) - 1), Outline.CLOSEPOLY]
    fill, width = shape.get("fillcolor"), POINTS * shape["line"]["width"]
    edge = shape["line"].get("color", "none")
    axes.add_patch(PathPatch(Outline(points, codes), fc="w" if fill else "none", ec=edge, lw=width))


def _annotate(axes: Axes, note: dict[str, Any]) -> None:
    if note["showarrow"]:
        arrow = {"arrowstyle": "<->", "lw": 0.9, "color": "0.3"}
        axes.annotate("", (note["ax"], note["ay"]), (note["x"], note["y"]), arrowprops=arrow)
        return
    place = axes.get_xaxis_transform() if note.get("yref") == "paper" else axes.transData
    across = "right" if note.get("yref") == "paper" else note.get("xanchor", "center")  # not beyond the figure
    va = "top" if note.get("yref") == "paper" else note["yanchor"]
    box = {"fc": "w", "ec": "none", "pad": 0.5, "alpha": 0.8}
    axes.text(note["x"], note["y"], f" {note['text']} ", transform=place, ha=across, va=va, fontsize=8, bbox=box)


def _axis(axes: Axes, name: str, entries: dict[str, Any]) -> None:
    axes.set(**{f"{name}label": entries.get("title", {}).get("text", "")})
    if "range" in entries:
        axes.set(**{f"{name}lim": entries["range"]})
    if entries.get("rangemode") == "tozero":
        axes.set(**{f"{name}lim": (0.0, None)})
    if "ticktext" in entries:
        getattr(axes, f"set_{name}ticks")(entries["tickvals"], entries["ticktext"], fontsize=7)
    if "scaleanchor" in entries:
        axes.set_aspect("equal", adjustable="box" if "range" in entries else "datalim")
