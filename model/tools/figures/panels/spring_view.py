"""The spring in 3D, to rotate and to step through its load program, coloured by the stress on its surface."""

from typing import Any

import numpy as np

from coilset.model.core.base.style import round_end
from coilset.model.core.results.files.opened import Run
from coilset.model.tools.figures.panels.panel import DIVERGING, Panel, Trace, axis, with_unit
from coilset.model.tools.figures.wire_surface import bent_frames, closed, frames, tubes

RINGS = 6000  # of all moments of a page together
MOST = 60  # moments
PER_TURN = 24  # rings, for which moments are left out
PER_ELEMENT = 4
DIAGONAL, TALLEST = 1.75, 1.3  # of the box of a 3D view, in plotly's units of a scene: a cube has √3 and 1


def scene_of(corners: np.ndarray, far: float = 1.0) -> dict[str, Any]:
    """Layout of a 3D view in which a box fits, however slender.

    Args:
        corners: lowest and highest corner of the box, shape (2, 3), mm.
        far: factor on the distance of the eye, above 1 in a narrow figure.
    """
    size = np.ptp(corners, axis=0)
    ratio = size * min(DIAGONAL / np.linalg.norm(size), TALLEST / size[2])
    return {
        "scene": {
            **{f"{name}axis": axis(f"{name}, mm", range=corners[:, k].tolist()) for k, name in enumerate("xyz")},
            "aspectmode": "manual",
            "aspectratio": dict(zip("xyz", ratio.tolist(), strict=True)),
            "camera": {
                "eye": {"x": 1.5 * far, "y": -1.5 * far, "z": 0.6 * far},
                "center": {"x": 0.0, "y": 0.0, "z": -0.1},
            },
        },
        "margin": {"l": 0, "r": 0, "t": 0, "b": 0},
    }


def surface_trace(end: float) -> Trace:
    """The look of a wire's surface, coloured by stresses up to `end`, MPa."""
    return {
        "type": "surface",
        "cmin": -end,
        "cmax": end,
        "colorscale": DIVERGING,
        "colorbar": {"title": {"text": "MPa"}, "thickness": 14, "len": 0.8},
        "lighting": {"ambient": 0.75, "diffuse": 0.5, "specular": 0.1},
        "hovertemplate": "%{surfacecolor:.0f} MPa<br>height %{z:.1f} mm<extra></extra>",
    }


def shown_surface(places: np.ndarray, stress: np.ndarray) -> Trace:
    """The places of a surface, shape (rings, angles, 3), and its colours."""
    return {**dict(zip("xyz", np.moveaxis(places, -1, 0), strict=True)), "surfacecolor": stress}


def spring_view(run: Run) -> Panel:
    """One tube per step, all on one scale."""
    turns = float(np.ptp(run.data["turn"].values))
    turned = run.is_turned
    shown = bent_frames(run) if turned else frames(run, int(np.clip(RINGS / (PER_TURN * turns), 2, MOST)))
    kind, full = "shear", "shear stress about the wire's axis"
    colours = "Red is sheared as in a compressed spring, blue as in one that is pulled."
    if turned:
        kind, full, colours = "stress along the wire", "stress along the wire", "Red is tension, blue compression."
    rings = min(PER_ELEMENT * (run.data.sizes["station"] - 1), RINGS // len(shown.labels)) + 1
    places, stress = closed(*tubes(run, shown, rings))
    end = round_end(float(np.abs(stress).max()))
    surfaces = [shown_surface(place, value) for place, value in zip(places, stress, strict=True)]
    corners = np.stack([places.reshape(-1, 3).min(axis=0), places.reshape(-1, 3).max(axis=0)])
    low, high = (with_unit(value, "MPa") for value in (stress[-1].min(), stress[-1].max()))
    return Panel(
        "spring",
        f"At {run.snapshots[-1]} the {kind} on the surface runs from {low} to {high}",
        f"The spring in three dimensions at {len(shown.labels)} moments of its load program, coloured by the "
        f"{full} on its surface from {-end:g} to {end:g} MPa. "
        f"At the end it is {low} to {high}.",
        [surface_trace(end)],
        scene_of(corners),
        frames=surfaces,
        moments=shown.labels,
        height=520,
        note=f"{colours} Drag to rotate, scroll or pinch to zoom; the slider steps through the load program.",
    )
