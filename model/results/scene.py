"""The spring in 3D: its wire as a tube at several moments, coloured by the stress in it."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pyvista as pv

from coilset.model.results.folder import whole
from coilset.model.results.record import Snapshot

POINTS_PER_ELEMENT = 6
BAR = {
    "color": "black", "n_labels": 5, "fmt": "%.0f", "title_font_size": 17, "label_font_size": 16,
    "position_x": 0.3, "width": 0.4, "position_y": 0.02, "height": 0.13,
}  # fmt: skip


def tube(x: np.ndarray, radius: np.ndarray, values: np.ndarray, name: str) -> pv.PolyData:
    """A smooth tube through the stations; `radius` and `values` per station, shape (n + 1,)."""
    line = pv.Spline(x, POINTS_PER_ELEMENT * (len(x) - 1) + 1)
    along = np.linspace(0.0, 1.0, line.n_points)
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(x, axis=0), axis=1))])
    line["radius"] = np.interp(along, length / length[-1], radius)
    line[name] = np.interp(along, length / length[-1], values)
    return line.tube(scalars="radius", absolute=True, n_sides=24)


def springs(path: str | Path, snapshots: Sequence[Snapshot], wire_radius: np.ndarray) -> None:
    """Draw the snapshots side by side, coloured by the greatest shear stress in each cross-section, surface included.

    Args:
        path: PNG to write.
        snapshots: Snapshots from left to right.
        wire_radius: of the elements, shape (n,), mm.
    """
    name = "greatest shear stress in the section, MPa"
    radius = 0.5 * (np.append(wire_radius, wire_radius[-1]) + np.append(wire_radius[0], wire_radius))
    width = 1.35 * (np.ptp(snapshots[0].x[:, 0]) + 2.0 * radius.max())
    stresses = [np.maximum(shot.shear.max(axis=(1, 2)), shot.surface_shear.max(axis=(1, 2))) for shot in snapshots]
    greatest = max(float(stress.max()) for stress in stresses)
    plotter = pv.Plotter(off_screen=True, window_size=(1500, 620))
    plotter.set_background("white")
    for place, (shot, stress) in enumerate(zip(snapshots, stresses, strict=True)):
        values = 0.5 * (np.append(stress, stress[-1]) + np.append(stress[0], stress))
        mesh = tube(shot.x + np.array([place * width, 0.0, 0.0]), radius, values, name)
        plotter.add_mesh(
            mesh, scalars=name, clim=(0.0, max(greatest, 1e-9)), cmap="viridis", smooth_shading=True,
            scalar_bar_args=BAR,
        )  # fmt: skip
        label = f"{shot.name}\n{shot.height:.2f} mm, {abs(shot.force):.0f} N"
        foot = [place * width, 0.0, float(snapshots[0].x[:, 2].max()) + 2.2 * radius.max()]
        plotter.add_point_labels([foot], [label], font_size=20, text_color="black", shape=None, show_points=False,
                                 always_visible=True, justification_horizontal="center")  # fmt: skip
    plotter.camera_position = [(0.5 * width * (len(snapshots) - 1), -10.0 * width, 2.2 * width),
                               (0.5 * width * (len(snapshots) - 1), 0.0, float(snapshots[0].x[:, 2].mean())),
                               (0, 0, 1)]  # fmt: skip
    plotter.camera.parallel_projection = True
    plotter.camera.parallel_scale = 0.2 * width * len(snapshots)
    try:
        with whole(path) as partial:
            plotter.screenshot(str(partial))
    finally:
        plotter.close()
