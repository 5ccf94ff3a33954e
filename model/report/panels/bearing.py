"""Seats and coils: the force centre, and the contact pressure along the wire."""

from typing import Any

import numpy as np

from coilset.model.base.style import round_end
from coilset.model.report.panels.panel import Panel, Trace, axis, curve
from coilset.model.results.files.opened import Run

FAINT = 0.02  # of the maximum force: a smaller one passes anywhere
REACH = 1.3  # of the figure, in coil radii
TOLD = 8  # steps whose travel is told at the axis, about


def force_centre(run: Run) -> Panel | None:
    """Path of the force centre on both seats; None for a spring without steps, or without a force."""
    if "bottom_centre_x_mm" not in run.data or not run.data["force_N"].values.any():
        return None
    traces = []
    for number, seat in enumerate(("bottom", "top")):
        x, y, force = (run.data[f"{seat}_{name}"].values for name in ("centre_x_mm", "centre_y_mm", "force_N"))
        bears = np.abs(force) > FAINT * np.nanmax(np.abs(force), initial=0.0)
        steps = [f"step {n}" for n in run.data["step"].values[bears]]
        traces.append(curve(x[bears], y[bears], number, marker=5, name=f"{seat} seat", text=steps))
    most = int(np.nanargmax(np.abs(run.data["force_N"].values)))
    away = max(float(run.data[f"{seat}_eccentricity_mm"].values[most]) for seat in ("bottom", "top"))
    reach = REACH * float(np.nanmax(np.linalg.norm(run.data["position"].values[..., :2], axis=-1)))
    shown = {"range": [-reach, reach], "zeroline": True}
    finding = f"At {abs(run.data['force_N'].values[most]):.4g} N the force passes {away:.2g} mm beside the axis"
    return Panel(
        "force_centre",
        finding,
        f"{finding}. Path of the force centre on each seat, seen along the axis.",
        traces,
        {
            "xaxis": axis("x, mm", **shown),
            "yaxis": axis("y, mm", scaleanchor="x", **shown),
            "shapes": [_coil(float(np.hypot(*run.data["position"].values[0, -1, :2])))],
        },
        height=420,
        note=f"The circle is the coil. Shown up to {REACH:g} coil radii; a double click shows what lies farther away.",
    )


def _coil(radius: float) -> dict[str, Any]:
    """The coil about the axis, as wound."""
    line = {"width": 1, "color": "#808080"}
    return {"type": "circle", "x0": -radius, "x1": radius, "y0": -radius, "y1": radius, "line": line}


def _travels(run: Run) -> dict[str, Any]:
    """The steps, as far from each other as their travels are named: press and release do not cover each other."""
    steps, travel = run.data["step"].values, run.data["travel_mm"].values
    told = slice(None, None, max(len(steps) // TOLD, 1))
    names = [f"{value:.3g}" for value in travel[told]]
    return axis("travel step by step, mm", tickvals=steps[told].tolist(), ticktext=names)


def contact(run: Run) -> Panel | None:
    """Pressure of each kind of contact along the wire over the travel of each step; None without any contact."""
    if "pressure" not in run.data:
        return None
    pressure, traces = run.data["pressure"], []
    bears: list[str] = []
    greatest = float(np.nanmax(pressure.values, initial=0.0))
    for kind in pressure["contact"].values:
        values = np.nan_to_num(pressure.sel(contact=kind).values)
        if (values > 0.0).any():
            traces.append(_pressures(run, values, greatest, len(bears)))
            bears.append(str(kind))
    if not bears:
        return None
    ends = float(run.data["turn"].values[0]), float(run.data["turn"].values[-1])
    finding = f"Contact carries up to {greatest:.3g} N per millimetre of wire"
    return Panel(
        "contact",
        finding,
        f"{finding}. Force per length of wire over the turns and, step by step, over the travel.",
        traces,
        {"xaxis": axis("turn from the bottom tip", range=[ends[0] - 0.1, ends[1] + 0.1]), "yaxis": _travels(run)},
        tuple(bears),
        choice="contact of",
    )


def _pressures(run: Run, values: np.ndarray, greatest: float, choice: int) -> Trace:
    """A square where a kind of contact bears: `values`, shape (steps, points), N/mm, as colours up to `greatest`."""
    turns, steps, heights = (run.data[name].values for name in ("wire_turn", "step", "seat_height_mm"))
    row, place = np.nonzero(values > 0.0)
    marker = {
        "symbol": "square",
        "size": 9,
        "color": values[row, place],
        "colorscale": "Viridis",
        "cmin": 0.0,
        "line": {"width": 0.7, "color": "#808080"},
        "cmax": round_end(greatest),
        "showscale": True,
        "colorbar": {"title": {"text": "N/mm"}, "thickness": 14},
    }
    return {
        "type": "scatter",
        "mode": "markers",
        "x": turns[place],
        "y": steps[row],
        "text": [f"{height:.4g} mm high" for height in heights[row]],
        "marker": marker,
        "meta": {"choice": choice},
        "hovertemplate": "turn %{x:.2f}, step %{y}, %{text}<br>%{marker.color:.3g} N/mm<extra></extra>",
        "showlegend": False,
    }
