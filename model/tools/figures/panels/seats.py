"""Seats and coils: the force centre, the contact pressure along the wire, and the turns that carry the load."""

from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from coilset.meshes.springs.ends import ENDS
from coilset.model.core.base.style import round_end
from coilset.model.core.results.files.opened import Run
from coilset.model.core.results.records.labels import decimals, plain
from coilset.model.tools.figures.panels.panel import GREY, Panel, Trace, axis, curve
from coilset.model.tools.figures.panels.phases import over_travel

FAINT = 0.02  # of the maximum force: the centre of a smaller one is not significant and is not drawn
REACH = 1.3  # of the figure, in coil radii
CENTRED = 0.002  # of the coil radius: a force that passes nearer to the axis is centred
NEAREST = 0.05  # of the coil radius: what the figure of distances shows at least
NAMED_STEPS = 12  # at the axis of a map at most; of more steps, nine are named
BOTH: dict[str, dict[str, Any]] = {  # both curves of a symmetric spring stay visible
    "bottom": {"name": "bottom seat", "colour": 0, "width": 5.0, "marker": 8, "opacity": 0.45},
    "top": {"name": "top seat", "colour": 1, "width": 1.5, "marker": 4},
}
BESIDE_AXIS = "of the force centre from the axis"


def significant(run: Run) -> np.ndarray:
    """Which steps have a force whose centre is drawn, shape (steps,)."""
    force = np.abs(run.data["force_N"].values)
    return np.asarray(force > FAINT * np.nanmax(force, initial=0.0))


def _has_force(run: Run) -> bool:
    turned = run.is_turned
    return "bottom_centre_x_mm" in run.data and bool(run.data["force_N"].values.any()) and not turned


def _ends(run: Run) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """The centre line of both end coils of the unloaded spring seen along the axis, each from its tip on."""
    turn, x = run.data["turn"].values, run.data["position"].values[0, :, :2]
    line, away = CubicSpline(turn, x), np.linspace(0.0, min(1.0, np.ptp(turn)), 121)
    return {"bottom": tuple(line(turn[0] + away).T), "top": tuple(line(turn[-1] - away).T)}


def _radius(run: Run) -> float:
    """Distance of the tips from the axis, the larger one, mm."""
    return float(np.hypot(*run.data["position"].values[0, [0, -1], :2].T).max())


def force_centre(run: Run) -> Panel | None:
    """Path of the force centre on both seats; None for a spring without steps, or without a force."""
    if not _has_force(run):
        return None
    traces, steps = [], run.data["step"].values[significant(run)]
    for number, (end, (x, y)) in enumerate(_ends(run).items()):
        tip = curve(x[:1], y[:1], number, name=f"wire's tip at the {end}")
        traces.append(curve(x, y, number, width=1.0, opacity=0.6, showlegend=False, hoverinfo="skip"))
        marker = {"symbol": "square", "size": 8, "color": tip["line"]["color"]}
        traces.append(tip | {"mode": "markers", "marker": marker, "hoverinfo": "skip"})
        looks: dict[str, dict[str, Any]] = {"pressure": {"width": 6.0, "opacity": 0.3}, "centre": {"marker": 5}}
        for name, words in (("pressure", f"centre of pressure, {end}"), ("centre", f"force centre, {end}")):
            x, y = (run.data[f"{end}_{name}_{axis_name}_mm"].values[significant(run)] for axis_name in "xy")
            if np.isfinite(x).any():
                text = [f"step {step}" for step in steps]
                traces.append(curve(x, y, number, name=words, text=text, **looks[name]))
    reach = REACH * _radius(run)
    shown = {"range": [-reach, reach], "zeroline": True}
    finding = _at_maximum(run)
    return Panel(
        "force_centre",
        finding,
        f"{finding}. Path of the force centre on each seat, seen along the axis.",
        traces,
        {"xaxis": axis("x, mm", **shown), "yaxis": axis("y, mm", scaleanchor="x", **shown)},
        height=480,
        note=f"The circles are the end coils. Shown up to {REACH:g} coil radii; a double click shows all.",
    )


def _at_maximum(run: Run) -> str:
    """Where the maximum force passes."""
    most = int(np.nanargmax(np.abs(run.data["force_N"].values)))
    force = plain(abs(float(run.data["force_N"].values[most])))
    away = max(float(run.data[f"{end}_eccentricity_mm"].values[most]) for end in ENDS)
    if away < CENTRED * _radius(run):
        return f"At {force} N the force is centred within {plain(max(away, 0.001), 2)} mm"
    return f"At {force} N the force passes {plain(away, 2)} mm beside the axis"


def eccentricity(run: Run) -> Panel | None:
    """Distance of the force centre from the axis over travel; None for a spring without steps, or without a force."""
    if not _has_force(run):
        return None
    radius, strong = _radius(run), significant(run)
    distance = {end: np.where(strong, run.data[f"{end}_eccentricity_mm"].values, np.nan) for end in ENDS}
    most = float(np.nanmax([*distance.values(), np.zeros_like(strong)]))
    traces = over_travel(run, [(values, BOTH[end]) for end, values in distance.items()])
    reach = float(np.clip(1.15 * most, NEAREST * radius, REACH * radius))
    if reach > radius:
        ends = [0.0, float(np.nanmax(np.abs(run.data["travel_mm"].values)))]
        traces.append(curve(ends, [radius] * 2, GREY, dash="dash", width=1.0, name="coil radius at the tip"))
    finding = f"The force passes up to {plain(most, 2)} mm beside the axis"
    return Panel(
        "eccentricity",
        finding,
        f"{finding}. Distance {BESIDE_AXIS} over travel.",
        traces,
        {"xaxis": axis("travel, mm"), "yaxis": axis(f"distance {BESIDE_AXIS}, mm", range=[0.0, reach])},
        height=480,
    )


def contact(run: Run, kinds: str = "") -> Panel | None:
    """Pressure of each kind of contact along the wire, step by step; None without any contact.

    Args:
        run: opened results.
        kinds: part of the names of the kinds that are drawn.
    """
    if "pressure" not in run.data:
        return None
    pressure = run.data["pressure"]
    values = {
        str(kind): np.nan_to_num(pressure.sel(contact=kind).values)
        for kind in pressure["contact"].values
        if kinds in str(kind)
    }
    values = {kind: one for kind, one in values.items() if (one > 0.0).any()}
    if not values:
        return None
    greatest = max(float(one.max()) for one in values.values())
    finding = f"Contact carries up to {greatest:.3g} N per millimetre of wire"
    return Panel(
        "contact",
        finding,
        f"{finding}. Force per length of wire over the turns and, step by step, over the travel.",
        [_pressures(run, one, greatest, number) for number, one in enumerate(values.values())],
        {"xaxis": axis("turn from the bottom tip"), "yaxis": _steps(run)},
        tuple(values),
        choice="contact of",
        height=460,
    )


def _steps(run: Run) -> dict[str, Any]:
    """The axis of a map: steps at equal distances, so that press and release do not cover each other."""
    count = run.data.sizes["step"]
    named = np.unique(np.linspace(0, count - 1, count if count <= NAMED_STEPS else 9).astype(int))
    travel, force = (run.data[name].values[named] for name in ("travel_mm", "force_N"))
    a, b = (decimals(float(np.abs(values).max())) for values in (travel, force))
    texts = [f"{x:.{a}f} mm, {abs(y):,.{b}f} N" for x, y in zip(travel, force, strict=True)]
    return axis("step", tickvals=run.data["step"].values[named].tolist(), ticktext=texts, automargin=True)


def _pressures(run: Run, values: np.ndarray, greatest: float, choice: int) -> Trace:
    """A square where a kind of contact carries load: `values`, shape (steps, points), N/mm, as colours."""
    turns, steps, heights = (run.data[name].values for name in ("wire_turn", "step", "seat_height_mm"))
    row, place = np.nonzero(values > 0.0)
    marker = {
        "symbol": "square",
        "size": 9,
        "color": values[row, place],
        "colorscale": "Viridis",
        "cmin": 0.0,
        "line": {"width": 0.7, "color": GREY},
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


def contact_length(run: Run) -> Panel | None:
    """Length of wire on each seat over travel; None without contact pressure on seats."""
    if "pressure" not in run.data or not any("seat" in str(kind) for kind in run.data["contact"].values):
        return None
    lengths = {end: run.data[f"{end}_length_mm"].values for end in ENDS}
    most = int(np.nanargmax(np.abs(run.data["force_N"].values)))
    bottom, top = (plain(float(one[most]), 3) for one in lengths.values())
    words = (
        f"{bottom} mm of wire on each seat"
        if bottom == top
        else f"{bottom} mm on the bottom and {top} mm on the top seat"
    )
    finding = f"At the maximum force {words}"
    return Panel(
        "contact_length",
        finding,
        f"{finding}. Length of wire in contact with each seat over travel.",
        over_travel(run, [(values, BOTH[end]) for end, values in lengths.items()]),
        {"xaxis": axis("travel, mm"), "yaxis": axis("wire in contact with the seat, mm")},
    )


def active_turns(run: Run) -> Panel | None:
    """Active turns, and turns without contact, over travel; None where they are not known.

    Where coils roll over each other near block, the torque changes while the force hardly does. The turns that carry
    this change are then any number, and lines to them would cover all else: they are counted in the legend instead.
    """
    if "active_turns" not in run.data or not np.isfinite(run.data["active_turns"].values).any():
        return None
    limit, curves = 1.5 * float(np.ptp(run.data["turn"].values)), []
    for name, words, drawn in (
        ("active_turns", "active", {"colour": 2, "width": 1.5, "marker": 4}),
        ("free_turns", "without contact", {"colour": GREY, "width": 1.5, "marker": 4}),
    ):
        values = run.data[name].values
        beyond = int((values > limit).sum())
        name = words + (f" (beyond {limit:g} turns: {beyond} of the steps)" if beyond else "")
        curves.append((np.where(values <= limit, values, np.nan), {"name": name, **drawn}))
    turns = float(run.data["active_turns"].values[int(np.nanargmax(np.abs(run.data["force_N"].values)))])
    finding = f"At the maximum force {turns:.3g} active turns" if turns <= limit else "Turns over travel"
    return Panel(
        "active_turns",
        finding,
        f"{finding}. Turns that carry the load, and turns without contact, over travel.",
        over_travel(run, curves),
        {"xaxis": axis("travel, mm"), "yaxis": axis("turns", range=[0.0, limit])},
    )
