"""Force over travel, and the rate along it."""

from typing import Any

import numpy as np

from coilset.model.figures.curve import compressed, smooth
from coilset.model.report.panels.panel import Panel, axis, curve
from coilset.model.results.files.opened import Run
from coilset.model.results.records.labels import in_legend, plain

GREY = {"width": 1, "color": "#808080"}
HEIGHT = 440  # pixels, the same for both, which stand side by side
AGAIN = "For the second loading, add a phase to the load program, such as “- to: block”, and solve again."


def phases(run: Run) -> list[tuple[str, np.ndarray, np.ndarray]]:
    """Label, travel (mm) and force (N) of each phase, from the end of the one before on."""
    data, found = run.data, []
    labels, last = run.snapshots[1:], (0.0, 0.0)
    of_phase = data["phase"].values.astype(int)
    for number in np.unique(of_phase):
        here = of_phase == number
        travel, force = (
            np.append(start, data[name].values[here])
            for start, name in zip(last, ("travel_mm", "force_N"), strict=True)
        )
        label = labels[number] if number < len(labels) else "last equilibrium"
        found.append((in_legend(label), travel, force))
        last = float(travel[-1]), float(force[-1])
    names = [name for name, _, _ in found]
    again = {name for name in names if names.count(name) > 1}
    return [
        (f"{name}, {_times(names[: k + 1].count(name))}" if name in again else name, travel, force)
        for k, (name, travel, force) in enumerate(found)
    ]


def _times(number: int) -> str:
    """Of equal phases, such as first and second loading."""
    return {1: "first time", 2: "second time", 3: "third time"}.get(number, f"time {number}")


def characteristic(run: Run) -> Panel:
    """Force over travel, one line per phase, with the initial rate, block and set."""
    summary, parts = run.summary, phases(run)
    traces = []
    for number, (label, travel, force) in enumerate(parts):
        traces.append(curve(*smooth(travel, force), number, name=label, legendgroup=label, hoverinfo="skip"))
        steps = curve(travel, force, number, marker=5, name=label, legendgroup=label, showlegend=False)
        traces.append(steps | {"mode": "markers"})
    greatest, rate, set_mm = summary["force_max_N"], summary["rate_N_per_mm"], summary["set_mm"]
    if rate:
        travels = np.abs(run.data["travel_mm"].values)
        end = min(abs(greatest) / rate, float(np.nanmax(travels, initial=0.0)) or 1.0)
        x, dots = np.array([0.0, np.copysign(end, greatest)]), {"dash": "dot", **GREY}
        name = f"initial rate {rate:.4g} N/mm"
        traces.append({"type": "scatter", "mode": "lines", "name": name, "x": x, "y": rate * x, "line": dots})
    block = summary["free_length_before_mm"] - summary["block_height_mm"]
    longer = set_mm is not None and set_mm < 0.0
    sets = "" if set_mm is None else f", the spring {'stays' if longer else 'sets'} {plain(abs(set_mm))} mm"
    sets += " longer" if longer else ""
    finding = f"{compressed(greatest)} with up to {plain(abs(greatest))} N{sets}"
    return Panel(
        "characteristic",
        finding,
        f"Axial force over travel. {finding}. Block is at {block:.4g} mm of travel.",
        traces,
        {"xaxis": axis("travel, mm"), "yaxis": axis("axial force, N"), **_block_and_set(block, set_mm)},
        height=HEIGHT,
        note="" if set_mm is None or len(parts) > 2 else AGAIN,
    )


def _block_and_set(block: float, set_mm: float | None) -> dict[str, Any]:
    """A line at the block, and an arrow along the set; parts of the layout."""
    line = {
        "type": "line",
        "x0": block,
        "x1": block,
        "yref": "paper",
        "y0": 0,
        "y1": 1,
        "line": {"dash": "dash", **GREY},
    }
    notes = [{"x": block, "y": 1, "yref": "paper", "yanchor": "bottom", "text": "block", "showarrow": False}]
    if set_mm:
        notes.append(
            {
                "x": set_mm,
                "ax": 0,
                "y": 0,
                "ay": 0,
                "axref": "x",
                "ayref": "y",
                "text": "",
                "arrowhead": 2,
                "arrowside": "end+start",
                "showarrow": True,
                "arrowwidth": 1.2,
            }
        )
        notes.append(
            {"x": 0.5 * set_mm, "y": 0, "yanchor": "bottom", "text": f"set {set_mm:.3f} mm", "showarrow": False}
        )
    return {"shapes": [line], "annotations": notes}


def rate_curve(run: Run) -> Panel | None:
    """Slope of the characteristic over travel, phase by phase; None if no phase has three steps."""
    traces = []
    for number, (label, travel, force) in enumerate(phases(run)):
        apart = np.append(True, np.abs(np.diff(travel)) > 1e-9 * np.ptp(travel))
        if apart.sum() > 2:
            rates = np.gradient(force[apart], travel[apart])
            traces.append(curve(travel[apart], rates, number, marker=5, name=label))
    if not traces:
        return None
    rate = run.summary["rate_N_per_mm"]
    first = f"The rate begins at {rate:.4g} N/mm" if rate else "The rate over the travel"
    return Panel(
        "rate",
        first,
        f"{first}. Slope of the characteristic over travel, each phase a line.",
        traces,
        {"xaxis": axis("travel, mm"), "yaxis": axis("rate, N/mm", rangemode="tozero")},
        height=HEIGHT,
    )
