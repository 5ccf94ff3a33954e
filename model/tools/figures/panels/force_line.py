"""The force line: the line of action of the spring's force in three views, and over travel; how heads move, and why."""

from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from coilset.model.core.results.files.opened import Run
from coilset.model.core.results.records.labels import plain
from coilset.model.tools.figures.panels.panel import GREY, Panel, axis, curve
from coilset.model.tools.figures.panels.phases import over_travel
from coilset.model.tools.figures.panels.seats import significant

LINES = 4  # states whose lines are drawn in a view
PER_TURN = 48  # points of the wire in a view
PLANES = "lower", "upper"
ENDS = "bottom", "top"
ACROSS = {"sideways", "tilt", "side_force", "tilt_moment"}  # what a program drives across the axis


def side_view_x(run: Run) -> Panel | None:
    """The force line seen along y; None without `force_line` in the case, or without a force."""
    return _side_view(run, 0)


def side_view_y(run: Run) -> Panel | None:
    """The force line seen along x; None as above."""
    return _side_view(run, 1)


def _side_view(run: Run, across: int) -> Panel | None:
    steps = _steps(run)
    if not len(steps):
        return None
    name, data, turn = "xy"[across], run.data, run.data["turn"].values
    wire = CubicSpline(turn, data["step_position"].values[steps[-1]], axis=0)(
        np.linspace(turn[0], turn[-1], round(PER_TURN * np.ptp(turn)) + 1)
    )
    traces = [curve(wire[:, across], wire[:, 2], GREY, width=1.0, opacity=0.5, name="wire in the last of these states")]
    for number, step in enumerate(steps):
        places = [
            float(data[f"{end}_shift_{name}_mm"].values[step] + data[f"{end}_centre_{name}_mm"].values[step])
            for end in ENDS
        ]
        label = (
            f"{plain(float(data['travel_mm'].values[step]))} mm, {plain(abs(float(data['force_N'].values[step])))} N"
        )
        traces.append(curve(places, [0.0, float(data["seat_height_mm"].values[step])], number, marker=5, name=label))
    spec = run.case["force_line"]
    reach = [float(wire[:, across].min()), float(wire[:, across].max())]
    traces += [
        curve(reach, [spec[plane]] * 2, GREY, dash="dot", width=1.0, name=f"{plane} plane")
        for plane in PLANES
        if spec[plane] is not None
    ]
    if spec["damper"] is not None:
        point, along = (np.array(spec["damper"][entry]) for entry in ("point", "direction"))
        if along[2]:
            z = np.array([0.0, float(wire[:, 2].max())])
            at = point[across] + along[across] / along[2] * (z - point[2])
            traces.append(curve(at, z, GREY, dash="dash", width=1.5, name="damper's axis"))
    finding = _finding(run, steps[-1])
    return Panel(
        f"force_line_{name}",
        finding,
        f"{finding}. Force line from seat to seat seen along {'yx'[across]}.",
        traces,
        {"xaxis": axis(f"{name}, mm"), "yaxis": axis("height above the bottom seat, mm", scaleanchor="x")},
        height=520,
    )


def view_along_axis(run: Run) -> Panel | None:
    """Where the force line crosses the planes, seen along the spring's axis; None as above."""
    steps = _steps(run)
    if not len(steps):
        return None
    strong, traces = significant(run), []
    text = [f"step {step}" for step in run.data["step"].values[strong]]
    for number, plane in enumerate(_planes(run)):
        x, y = (run.data[f"line_{plane}_{name}_mm"].values[strong] for name in "xy")
        traces.append(curve(x, y, number, marker=5, name=f"{plane} plane", text=text))
        end = {"symbol": "square", "size": 9, "color": traces[-1]["line"]["color"]}
        last = curve(x[-1:], y[-1:], number, showlegend=False)
        traces.append(last | {"mode": "markers", "marker": end})
    if not traces:
        return None
    return Panel(
        "force_line_z",
        "The force line wanders over the planes; the square is the last state",
        "Where the force line crosses the planes, step by step, seen along the axis.",
        traces,
        {"xaxis": axis("x, mm", zeroline=True), "yaxis": axis("y, mm", scaleanchor="x", zeroline=True)},
        height=480,
    )


def side_force(run: Run) -> Panel | None:
    """Force across the axis over travel; None without `force_line` unless the program drives a head across the axis."""
    if not len(_steps(run)) and not _is_driven(run):
        return None
    force = run.data["side_force_N"].values
    finding = f"The side force comes to {plain(float(np.nanmax(force)))} N"
    return Panel(
        "side_force",
        finding,
        f"{finding}. Force of the top seat across the spring's axis over travel.",
        over_travel(run, [(force, {"name": "side force", "colour": 0, "marker": 4})]),
        {"xaxis": axis("travel, mm"), "yaxis": axis("side force, N", rangemode="tozero")},
        height=480,
    )


def sideways(run: Run) -> Panel | None:
    """How far the heads move across the axis over travel; None unless the program drives a head so, as the next two."""
    return _of_heads(run, "heads_sideways", "shift_{}_mm", "move sideways by", "sideways", "mm")


def tilts(run: Run) -> Panel | None:
    """Rotation of the heads across the axis over travel."""
    return _of_heads(run, "heads_tilt", "tilt_{}_deg", "tilt by", "tilt", "°")


def tilt_moments(run: Run) -> Panel | None:
    """Moments on the spring across its axis over travel, about the heads' points."""
    return _of_heads(run, "heads_moment", "moment_{}_Nmm", "bend the spring with", "moment across the axis", "N mm")


def _of_heads(run: Run, name: str, column: str, verb: str, label: str, unit: str) -> Panel | None:
    """x and y of a vector of both heads, those that are not zero throughout."""
    if not _is_driven(run):
        return None
    data = {(end, x): run.data[f"{end}_{column.format(x)}"].values for end in ENDS for x in "xy"}
    most = max(float(np.nanmax(np.hypot(data[end, "x"], data[end, "y"]))) for end in ENDS)
    if not most > 0.0:
        return None
    shown = [
        (values, {"name": f"{end} seat, {x}", "colour": number, "marker": 4})
        for number, ((end, x), values) in enumerate(data.items())
        if np.nanmax(np.abs(values)) > 1e-9 * most
    ]
    finding = f"The seats {verb} up to {plain(most)}{'' if unit == '°' else ' '}{unit}"
    return Panel(
        name,
        finding,
        f"{finding}. Components along x and y over travel.",
        over_travel(run, shown),
        {"xaxis": axis("travel, mm"), "yaxis": axis(f"{label}, {unit}")},
        height=480,
    )


def _is_driven(run: Run) -> bool:
    """Whether the program drives a head across the axis, of a spring that is pressed or pulled."""
    targets = [phase["to"] for phase in run.case["loading"] if isinstance(phase.get("to"), dict)]
    given = {name for to in targets for end in ENDS for name, value in (to.get(end) or {}).items() if value is not None}
    return bool(given & ACROSS) and not run.is_turned


def _planes(run: Run) -> list[str]:
    return [plane for plane in PLANES if run.case["force_line"][plane] is not None]


def _steps(run: Run) -> np.ndarray:
    """Steps whose lines are drawn, on the way to the greatest force; none without an entry or a force."""
    spec: dict[str, Any] | None = run.case.get("force_line")
    if spec is None or "bottom_centre_x_mm" not in run.data or not run.data["force_N"].values.any():
        return np.empty(0, int)
    force = np.abs(run.data["force_N"].values)
    strong = np.flatnonzero(significant(run)[: int(np.nanargmax(force)) + 1])
    return strong[np.unique(np.linspace(0, len(strong) - 1, min(LINES, len(strong))).round().astype(int))]


def _finding(run: Run, step: int) -> str:
    """The side force at a step."""
    force, side = (abs(float(run.data[name].values[step])) for name in ("force_N", "side_force_N"))
    return f"At {plain(force)} N the spring pushes aside with {plain(side)} N"
