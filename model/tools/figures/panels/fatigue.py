"""Where the wire breaks first: the usage of its fatigue strength on its surface, unrolled and on the spring."""

import numpy as np

from coilset.model.core.results.files.opened import Run
from coilset.model.tools.figures.panels.panel import Panel, axis
from coilset.model.tools.figures.panels.spring_view import PER_ELEMENT, scene_of, shown_surface
from coilset.model.tools.figures.wire_surface import coil_turns, inside, section_turns, surface

NOTE = "1 where the wire just endures: amplitude of fully reversed stress that damages as much, over that endured."
MARKED = f"{NOTE} The square is where the wire would break first."
NARROW = 1.25  # times as far away as in a view over the whole width
PROUD = 1.15  # of the wire's radius: where the mark is, so that the surface does not hide half of it


def fatigue_map(run: Run) -> Panel | None:
    """Usage over turn and angle, a criterion to choose; None without `endurance` in the case."""
    if "fatigue_usage" not in run.data:
        return None
    data = run.data["fatigue_usage"].values.mean(axis=2)  # of an element's sections
    names = [str(name) for name in run.data["criterion"].values]
    turns = section_turns(run).mean(axis=1)
    points = data.shape[-1]
    angle = _angles(run)
    order = np.argsort(angle)
    entries = {entry["criterion"]: entry for entry in run.summary["fatigue"]}
    worst = min(entries.values(), key=lambda entry: entry["safety"])
    last = sorted(range(len(names)), key=lambda number: -entries[names[number]]["safety"])
    names, data = [names[number] for number in last], data[last]
    traces = [
        {
            "type": "heatmap",
            "x": turns,
            "y": angle[order],
            "z": data[number][:, order].T,
            "colorscale": "Viridis",
            "zmin": 0.0,
            "zmax": float(max(data.max(), 1.0)),
            "colorbar": {"title": {"text": "used part"}, "thickness": 14},
            "meta": {"choice": number},
            "hovertemplate": "turn %{x:.2f}, %{y:.0f}°<br>%{z:.2f}<extra></extra>",
        }
        for number in range(len(names))
    ]
    mark = {"size": 10, "symbol": "square", "color": "#d55e00"}
    place = {"x": [worst["turn"]], "y": [worst["angle_deg"]], "marker": mark, "showlegend": False}
    traces.append({"type": "scatter", "mode": "markers", **place})
    finding = (
        f"The wire would break first at turn {worst['turn']:.2f}, {worst['angle_deg']:z.0f}° from the inside of the "
        f"coil; safety {worst['safety']:.2f} by {worst['criterion']}"
    )
    return Panel(
        "fatigue",
        finding,
        f"{finding}. Used part of the fatigue strength over the turns and the angle about the wire, {points} points.",
        traces,
        {"xaxis": axis("turn from the bottom tip"), "yaxis": axis("angle from the inside of the coil, degrees")},
        tuple(names),
        choice="criterion",
        height=420,
        note=NOTE,
    )


def fatigue_view(run: Run) -> Panel | None:
    """The spring at its greatest working force, coloured by the usage of the criterion that is worst."""
    if "fatigue_usage" not in run.data:
        return None
    used, data = run.data["fatigue_usage"].values.mean(axis=2), run.data
    number = int(np.argmax(used.reshape(len(used), -1).max(axis=1)))
    name = str(data["criterion"].values[number])
    heights = np.ptp(data["working_position"].values[..., 2], axis=1)
    x = data["working_position"].values[int(np.argmin(heights))]
    rings = PER_ELEMENT * (len(x) - 1) + 1
    places, shown = surface(
        data["turn"].values, x, data["wire_radius"].values, used[number], inside(run), rings, coil=coil_turns(run)
    )
    trace = {
        "type": "surface",
        "cmin": 0.0,
        "cmax": float(max(shown.max(), 1.0)),
        "colorscale": "Viridis",
        "colorbar": {"title": {"text": "used part"}, "thickness": 14, "len": 0.8},
        "lighting": {"ambient": 0.75, "diffuse": 0.5, "specular": 0.1},
        **shown_surface(places, shown),
    }
    entry = next(one for one in run.summary["fatigue"] if one["criterion"] == name)
    turns = data["turn"].values
    ring = round((rings - 1) * float((entry["turn"] - turns[0]) / (turns[-1] - turns[0])))
    corner = int(np.argmin(np.abs((_angles(run) - entry["angle_deg"] + 180.0) % 360.0 - 180.0)))
    centre = places[ring, :-1].mean(axis=0)
    mark = dict(zip("xyz", (np.array([one]) for one in centre + PROUD * (places[ring, corner] - centre)), strict=True))
    marker = {"size": 6, "symbol": "square", "color": "#d55e00"}
    first = {"type": "scatter3d", "mode": "markers", **mark, "marker": marker, "showlegend": False, "hoverinfo": "skip"}
    finding = f"Used part of the fatigue strength on the spring, by {name}: up to {shown.max():.2f}"
    corners = np.stack([places.reshape(-1, 3).min(axis=0), places.reshape(-1, 3).max(axis=0)])
    layout = scene_of(corners, NARROW)
    return Panel("fatigue_spring", finding, f"{finding}.", [trace, first], layout, height=520, note=MARKED)


def _angles(run: Run) -> np.ndarray:
    """Of the points on the surface from the inside of the coil, degrees within ±180, shape (points,)."""
    angles: np.ndarray = (run.data["angle"].values - np.degrees(inside(run).angle) + 180.0) % 360.0 - 180.0
    return angles
