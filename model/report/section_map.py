"""Stress over the wire's section at mid height, to its rim."""

import numpy as np
from matplotlib.tri import LinearTriInterpolator, Triangulation

from coilset.model.report.panel import DIVERGING, Panel, Trace, axis
from coilset.model.report.scale import round_end
from coilset.model.report.wire import inside
from coilset.model.results.opened import Run
from coilset.model.results.rings import ROUND, refined, rings

PIXELS = 121  # of a map, across the wire
BEYOND = 1.04  # wire radii up to which colours go: the rim is drawn over them


def section_map(run: Run) -> Panel:
    """Shear about the wire's axis and normal stress, a pair of maps a snapshot."""
    traces, ends, (places, carry, radius) = [], [], _places(run)
    element = len(run.data["turn"]) // 2
    for number in range(len(run.snapshots)):
        fields = _stresses(run, number, element, places, carry)
        end = round_end(max(float(np.abs(field).max()) for field in fields))
        ends.append(fields)
        for column, values in enumerate(fields):
            traces.append(_map(places * radius, values, radius, end, number, column))
    last = ends[-1][0]
    points = np.stack([run.data[name].values[element] for name in "yz"])
    for column in (0, 1):
        traces.append({"type": "scatter", "mode": "markers", "x": points[0], "y": points[1], "hoverinfo": "skip",
                       "marker": {"size": 2, "color": "#404040"}, "showlegend": False, **_axes(column)})  # fmt: skip
    finding = f"At {run.snapshots[-1]} the shear at mid height runs from {last.min():.0f} to {last.max():.0f} MPa"
    return Panel(
        "section", finding, f"Two maps of the wire's section at mid height. {finding}; positive as in a compressed spring.",
        traces, _layout(radius, np.cos(inside(run).angle) > 0), tuple(run.snapshots), height=430,
        note="Dots are the points at which the section is integrated; the stress on the rim is integrated there as well.",
    )  # fmt: skip


def _places(run: Run) -> tuple[np.ndarray, np.ndarray, float]:
    """Places in wire radii, the matrix that carries values at the section points to those within, and the radius."""
    element = len(run.data["turn"]) // 2
    radius = float(run.data["wire_radius"].values[element])
    points = np.stack([run.data[name].values[element] for name in "yz"], axis=-1) / radius
    inner, carry = rings(points)
    angle = 2.0 * np.pi * np.arange(ROUND) / ROUND
    return np.concatenate([inner, np.stack([np.cos(angle), np.sin(angle)], axis=-1)]), carry, radius


def _stresses(run: Run, snapshot: int, element: int, places: np.ndarray, carry: np.ndarray) -> tuple[np.ndarray, ...]:
    def stress(name: str) -> np.ndarray:
        within, rim = (run.data[kind].sel(component=name).values[snapshot, element].mean(axis=0)
                       for kind in ("history", "surface"))  # fmt: skip
        return np.concatenate([carry @ within, refined(rim, ROUND)])

    y, z = places.T
    distance = np.maximum(np.hypot(y, z), 1e-12)
    here = inside(run)
    around = here.sign * np.cos(here.angle) * (stress("t13") * y - stress("t12") * z) / distance
    return around, stress("s11")


def _map(places: np.ndarray, values: np.ndarray, radius: float, end: float, choice: int, column: int) -> Trace:
    """Values on a grid of pixels; beyond the rim those of the rim."""
    line = np.linspace(-BEYOND * radius, BEYOND * radius, PIXELS)
    y, z = np.meshgrid(line, line)
    distance = np.hypot(y, z)
    within = np.minimum(1.0, 0.9995 * radius / np.maximum(distance, 1e-12))
    triangles = Triangulation(*places.T)
    field = LinearTriInterpolator(triangles, values)(y * within, z * within).filled(np.nan)
    field[distance > BEYOND * radius] = np.nan
    bar = {"title": {"text": "MPa"}, "thickness": 12, "len": 0.85, "x": 0.45 + 0.55 * column}
    return {
        "type": "heatmap", "x": line, "y": line, "z": field, "zmin": -end, "zmax": end, "zsmooth": "best",
        "colorscale": DIVERGING, "meta": {"choice": choice}, "colorbar": bar,
        "hovertemplate": "%{z:.0f} MPa<extra></extra>", **_axes(column),
    }  # fmt: skip


def _axes(column: int) -> dict[str, str]:
    return {} if column == 0 else {"xaxis": "x2", "yaxis": "y2"}


def _layout(radius: float, inwards: bool) -> dict[str, object]:
    towards = f"{'towards' if inwards else 'away from'} the coil's axis, mm"
    edge = BEYOND * 1.06 * radius
    layout: dict[str, object] = {"showlegend": False, "shapes": [], "annotations": []}
    corners = f"M{-edge},{-edge} L{edge},{-edge} L{edge},{edge} L{-edge},{edge} Z"
    circle = "M" + " L".join(f"{radius * np.cos(a):.5g},{radius * np.sin(a):.5g}"
                             for a in np.linspace(0.0, 2.0 * np.pi, 181)) + " Z"  # fmt: skip
    for column, name in enumerate(("shear about the wire's axis", "normal stress")):
        number = "" if column == 0 else "2"
        domain = [0.0, 0.44] if column == 0 else [0.55, 0.99]
        layout[f"xaxis{number}"] = axis(towards, domain=domain, range=[-edge, edge], constrain="domain", showgrid=False)
        layout[f"yaxis{number}"] = axis("across, mm" if column == 0 else "", range=[-edge, edge], anchor=f"x{number}",
                                        scaleanchor=f"x{number}", showgrid=False)  # fmt: skip
        on = {"xref": f"x{number}", "yref": f"y{number}"}
        layout["shapes"].append({"type": "path", "path": corners + circle, "fillrule": "evenodd", "layer": "above",  # type: ignore[attr-defined]
                                 "fillcolor": "paper", "line": {"width": 0}, **on})  # fmt: skip
        layout["shapes"].append({"type": "circle", "x0": -radius, "x1": radius, "y0": -radius, "y1": radius,  # type: ignore[attr-defined]
                                 "line": {"width": 1, "color": "#808080"}, **on})  # fmt: skip
        layout["annotations"].append({"text": name, "showarrow": False, "x": sum(domain) / 2, "y": 1.0, "xref": "paper",  # type: ignore[attr-defined]
                                      "yref": "paper", "yanchor": "bottom"})  # fmt: skip
    return layout
