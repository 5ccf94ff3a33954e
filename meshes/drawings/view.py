"""The spring in 3D: its wire as a tube, cut where its ends are ground."""

from pathlib import Path

import numpy as np
import pyvista as pv
from vtkmodules.vtkCommonDataModel import vtkPlane, vtkPlaneCollection
from vtkmodules.vtkFiltersGeneral import vtkClipClosedSurface

from coilset.meshes.sections.boundary import Boundary
from coilset.meshes.springs.geometry import Spring

STATIONS_PER_TURN = 64
SIDES, CORNERS = 32, 96  # of the section of round wire, and of the outline of a wire that is not round


def tube(spring: Spring) -> pv.PolyData:
    """The wire's surface as a `pyvista.PolyData` that carries the turn as data."""
    first, last = spring.corners[[0, -1]]
    turns = np.linspace(first, last, int(np.ceil(STATIONS_PER_TURN * (last - first))) + 1)
    if spring.section is not None:
        return _cut(_outlined(spring, spring.section, turns), spring)
    line = pv.PolyData(spring.centre_line(turns), lines=[len(turns), *range(len(turns))])
    line["turn"], line["radius"] = turns, 0.5 * spring.wire_diameter(turns)
    return _cut(line.tube(scalars="radius", absolute=True, n_sides=SIDES, capping=True), spring)


def _outlined(spring: Spring, section: Boundary, turns: np.ndarray) -> pv.PolyData:
    """The surface of a wire that is not round: quadrilaterals between its outlines, and both end faces."""
    outwards = spring.centre_line(turns) * [1.0, 1.0, 0.0]
    along = spring.tangent(turns)
    outwards -= np.sum(outwards * along, axis=1)[:, None] * along
    outwards /= np.linalg.norm(outwards, axis=1)[:, None]
    upwards = np.cross(outwards, along) * spring.hand
    corners, radius = section.points(CORNERS), 0.5 * spring.wire_diameter(turns)
    y, z = corners[..., None].swapaxes(0, 1)
    ring = radius[:, None, None] * (z * upwards[:, None] - y * outwards[:, None])
    n, m = len(turns), len(corners)
    number = np.arange(n * m).reshape(n, m)
    beside = np.roll(number, -1, axis=1)
    sides = np.stack([number[:-1], beside[:-1], beside[1:], number[1:]], axis=-1).reshape(-1, 4)
    faces = np.concatenate([np.insert(sides, 0, 4, axis=1).ravel(), [m, *number[0][::-1]], [m, *number[-1]]])
    surface = pv.PolyData((spring.centre_line(turns)[:, None] + ring).reshape(-1, 3), faces=faces)
    surface["turn"] = np.repeat(turns, m)
    return surface


def _cut(surface: pv.PolyData, spring: Spring) -> pv.PolyData:
    """What the grinding of the ends leaves of a closed surface.

    Both planes cut at once: where a flat side of the wire grazes the first, slivers without area are missing in its
    ground face, and pyvista's `clip_closed_surface` refuses to cut such a surface again.
    """
    planes = vtkPlaneCollection()
    for end, up, level in ((spring.bottom, 1.0, 0.0), (spring.top, -1.0, spring.free_length)):
        if end.tip_thickness < 1:
            plane = vtkPlane()
            plane.SetNormal(0.0, 0.0, up)
            plane.SetOrigin(0.0, 0.0, level)
            planes.AddItem(plane)
    if not planes.GetNumberOfItems():
        return surface
    clip = vtkClipClosedSurface()
    clip.SetInputData(surface.triangulate().clean())
    clip.SetClippingPlanes(planes)
    clip.Update()
    return pv.PolyData(clip.GetOutput())


def picture(spring: Spring, path: str | Path) -> None:
    """Draw the spring as a PNG, seen from the side and slightly above; needs a display."""
    plotter = pv.Plotter(off_screen=True, window_size=(900, 900))
    plotter.set_background("white")
    surface = tube(spring)
    plotter.add_mesh(surface, color="lightsteelblue", smooth_shading=True, split_sharp_edges=True, specular=0.3)
    middle = 0.5 * spring.free_length
    plotter.camera_position = [(0, -10, middle + 3), (0, 0, middle), (0, 0, 1)]
    plotter.camera.parallel_projection = True
    plotter.reset_camera(render=False)
    plotter.screenshot(str(path))
    plotter.close()
