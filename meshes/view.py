"""The spring in 3D: its wire as a tube, cut where its ends are ground."""

from pathlib import Path

import numpy as np
import pyvista as pv

from coilset.meshes.springs.geometry import Spring

STATIONS_PER_TURN = 64


def tube(spring: Spring, sides: int = 32) -> pv.PolyData:
    """The wire's surface as a `pyvista.PolyData` that carries the turn as data.

    Args:
        spring: `Spring`.
        sides: number of corners of the cross-section.
    """
    turns = np.linspace(0.0, spring.turns, int(np.ceil(STATIONS_PER_TURN * spring.turns)) + 1)
    line = pv.PolyData(spring.centre_line(turns), lines=[len(turns), *range(len(turns))])
    line["turn"], line["radius"] = turns, 0.5 * spring.wire_diameter(turns)
    surface = line.tube(scalars="radius", absolute=True, n_sides=sides, capping=True)
    for end, normal, level in ((spring.bottom, (0, 0, 1), 0.0), (spring.top, (0, 0, -1), spring.free_length)):
        if end.tip_thickness < 1:
            surface = surface.triangulate().clean().clip_closed_surface(normal=normal, origin=(0, 0, level))
    return surface


def picture(spring: Spring, path: str | Path) -> None:
    """Draw the spring as a PNG, seen from the side and slightly above; needs a display."""
    plotter = pv.Plotter(off_screen=True, window_size=(900, 900))
    plotter.set_background("white")
    plotter.add_mesh(tube(spring), color="lightsteelblue", smooth_shading=True, specular=0.3)
    middle = 0.5 * spring.free_length
    plotter.camera_position = [(0, -10, middle + 3), (0, 0, middle), (0, 0, 1)]
    plotter.camera.parallel_projection = True
    plotter.reset_camera(render=False)
    plotter.screenshot(str(path))
    plotter.close()
