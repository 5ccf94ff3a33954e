"""Stress over the wire's section where the residual shear at the inside of the coil is largest, up to its edge."""

from typing import Any

import numpy as np
from scipy.interpolate import LinearNDInterpolator
from scipy.spatial import Delaunay

from coilset.model.core.base.style import round_end
from coilset.model.core.results.files.opened import Run
from coilset.model.tools.figures.panels.panel import DIVERGING, Panel, Trace, axis, with_unit
from coilset.model.tools.figures.rings import FilledSection
from coilset.model.tools.figures.wire_surface import inside, outline

PIXELS = 121  # of a map, across the wire
BEYOND = 1.04  # wire radii up to which colours go: the rim is drawn over them
LEAST_SCALE = 1.0  # MPa: the scale of a section without stress
WITHIN = 0.999  # of the wire radius: inside the chords of the rim's polygon, cos(π/96) = 0.99946


def element_at(turns: np.ndarray, turn: float | None) -> int:
    """Number of the element at a turn; that in the middle of the wire if there is none.

    Args:
        turns: of the stations, shape (n + 1,).
        turn: such as `residual_shear_inside_turn` of a summary.
    """
    n = len(turns) - 1
    return n // 2 if turn is None else int(np.clip(np.searchsorted(turns, turn, side="right") - 1, 0, n - 1))


def shear_map(run: Run) -> Panel:
    """Shear about the wire's axis, one map per snapshot."""
    return _panel(run, "section_shear", "shear", 0, "; positive as in a compressed spring")


def normal_map(run: Run) -> Panel:
    """Normal stress, one map per snapshot."""
    return _panel(run, "section_normal", "normal stress", 1, "")


def _panel(run: Run, name: str, quantity: str, which: int, sign: str) -> Panel:
    turns = run.data["turn"].values
    element = element_at(turns, run.summary.get("residual_shear_inside_turn"))
    turn = 0.5 * float(turns[element : element + 2].sum())
    radius = float(run.data["wire_radius"].values[element])
    y, z = (run.data[axis_name].values[element, 0] for axis_name in "yz")
    corners = outline(run)
    section = FilledSection(np.stack([y, z], axis=-1) / radius, corners)
    fields = [_stresses(run, number, element, section) for number in range(len(run.snapshots))]
    triangles, traces = Delaunay(section.places * radius), []
    for number, both in enumerate(fields):
        end = round_end(max(LEAST_SCALE, *(float(np.abs(field).max()) for field in both)))
        traces.append(_map(triangles, both[which], radius, end, number, corners))
    dots = {"type": "scatter", "mode": "markers", "x": y, "y": z, "marker": {"size": 2, "color": "#404040"}}
    traces.append({**dots, "hoverinfo": "skip", "showlegend": False})
    low, high = (with_unit(float(f(fields[-1][which])), "").strip() for f in (np.min, np.max))
    finding = f"At {run.snapshots[-1]} the {quantity} at turn {turn:.2f} ranges from {low} to {high} MPa"
    return Panel(
        name,
        finding,
        f"Map of the wire's section at turn {turn:.2f}, where the residual shear at the inside of the coil is largest. "
        f"{finding}{sign}.",
        traces,
        _layout(radius, np.cos(inside(run).angle) > 0, corners),
        tuple(run.snapshots),
        height=430,
        note="Dots are the points at which the section is integrated; the stress on the rim is integrated there, too.",
    )


def _stresses(run: Run, snapshot: int, element: int, section: FilledSection) -> tuple[np.ndarray, np.ndarray]:
    """Shear about the wire's axis and normal stress at the section's places."""

    def stress(name: str) -> np.ndarray:
        return section.values(
            *(
                run.data[of].sel(component=name).values[snapshot, element].mean(axis=0)
                for of in ("point_state", "surface")
            )
        )

    return section.shear_around(stress("t12"), stress("t13"), inside(run)), stress("s11")


def _map(
    triangles: Delaunay, values: np.ndarray, radius: float, end: float, choice: int, corners: np.ndarray | None
) -> Trace:
    """Values on a grid of pixels; beyond the rim those of the rim, or none if the wire is not round."""
    reach = radius * _reach(corners)
    line = np.linspace(-BEYOND * reach, BEYOND * reach, PIXELS)
    y, z = np.meshgrid(line, line)
    distance = np.hypot(y, z)
    within = np.minimum(1.0, WITHIN * radius / np.maximum(distance, 1e-12)) if corners is None else 1.0
    field = LinearNDInterpolator(triangles, values)(y * within, z * within)
    if corners is None:
        field[distance > BEYOND * radius] = np.nan
    return {
        "type": "heatmap",
        "x": line,
        "y": line,
        "z": field,
        "zmin": -end,
        "zmax": end,
        "zsmooth": "best",
        "colorscale": DIVERGING,
        "meta": {"choice": choice},
        "colorbar": {"title": {"text": "MPa"}, "thickness": 12, "len": 0.85},
        "hovertemplate": "%{z:.0f} MPa<extra></extra>",
    }


def _reach(corners: np.ndarray | None) -> float:
    """How far the section reaches along its axes, in wire radii."""
    return 1.0 if corners is None else float(np.abs(corners).max())


def _layout(radius: float, inwards: bool, corners: np.ndarray | None) -> dict[str, Any]:
    """A square map; the area outside the wire is covered in the background colour."""
    edge = BEYOND * 1.06 * radius * _reach(corners)
    around = radius * np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 181))
    if corners is not None:
        around = radius * (corners @ [1.0, 1j])
    rim = "M" + " L".join(f"{at.real:.5g},{at.imag:.5g}" for at in around) + " Z"
    beyond = f"M{-edge},{-edge} L{edge},{-edge} L{edge},{edge} L{-edge},{edge} Z{rim}"
    square = {"range": [-edge, edge], "constrain": "domain", "showgrid": False, "zeroline": False}
    towards = f"{'towards' if inwards else 'away from'} the coil's axis, mm"
    cover = {"type": "path", "path": beyond, "fillrule": "evenodd", "fillcolor": "paper", "line": {"width": 0}}
    line = {"type": "path", "path": rim, "line": {"width": 1, "color": "#808080"}}
    return {
        "showlegend": False,
        "xaxis": axis(towards, **square),
        "yaxis": axis("across, mm", scaleanchor="x", **square),
        "shapes": [cover, line],
    }
