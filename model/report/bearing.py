"""How the seats bear: where the force passes, and where along the wire coils and seats press."""

import numpy as np

from coilset.model.report.panel import COLOURS, LINE, Panel, axis
from coilset.model.results.opened import Run

FAINT = 0.02  # of the greatest force: a smaller one passes anywhere


def force_centre(run: Run) -> Panel | None:
    """Path of the force centre on both seats; None for a spring without steps."""
    if "bottom_centre_x_mm" not in run.data:
        return None
    traces, away = [], 0.0
    for number, seat in enumerate(("bottom", "top")):
        x, y, force = (run.data[f"{seat}_{name}"].values for name in ("centre_x_mm", "centre_y_mm", "force_N"))
        bears = np.abs(force) > FAINT * np.nanmax(np.abs(force), initial=0.0)
        traces.append(
            {
                "type": "scatter",
                "mode": "lines+markers",
                "name": f"{seat} seat",
                "x": x[bears],
                "y": y[bears],
                "text": [f"step {n}" for n in run.data["step"].values[bears]],
                "marker": {"size": 5},
                "line": {**LINE, "color": COLOURS[number]},
            }
        )
        away = max(away, float(np.hypot(x[bears], y[bears]).max(initial=0.0)))
    finding = f"The force passes up to {away:.3g} mm beside the axis"
    return Panel(
        "force_centre",
        finding,
        f"{finding}. Path of the force centre on each seat, seen along the axis.",
        traces,
        {"xaxis": axis("x, mm", zeroline=True), "yaxis": axis("y, mm", scaleanchor="x", zeroline=True)},
        height=420,
    )


def contact(run: Run) -> Panel | None:
    """Pressure of each kind of contact along the wire in each step; None where nothing ever bears."""
    if "pressure" not in run.data:
        return None
    pressure, kinds = run.data["pressure"], [str(name) for name in run.data["contact"].values]
    heights, traces = run.data["seat_height_mm"].values, []
    bears = [kind for kind in kinds if float(np.nanmax(pressure.sel(contact=kind).values)) > 0.0]
    if not bears:
        return None
    text = [f"step {n}, {h:.4g} mm high" for n, h in zip(run.data["step"].values, heights, strict=True)]
    turns = run.data["wire_turn"].values
    for number, kind in enumerate(bears):
        values = pressure.sel(contact=kind).values
        traces.append(
            {
                "type": "heatmap",
                "x": turns,
                "y": run.data["step"].values,
                "z": values,
                "zmin": 0.0,
                "text": [[line] * len(turns) for line in text],
                "colorscale": "Viridis",
                "meta": {"choice": number},
                "colorbar": {"title": {"text": "N/mm"}, "thickness": 14},
                "hovertemplate": "turn %{x:.2f}, %{text}<br>%{z:.3g} N/mm<extra></extra>",
            }
        )
    greatest = float(np.nanmax(pressure.values))
    finding = f"Contact bears up to {greatest:.3g} N per millimetre of wire"
    return Panel(
        "contact",
        finding,
        f"{finding}. Force per length of wire over the turns and the steps.",
        traces,
        {"xaxis": axis("turn from the bottom tip"), "yaxis": axis("step")},
        tuple(bears),
        choice="contact of",
    )
