"""The spring through its load program, as a GIF."""

from pathlib import Path

import numpy as np
import pyvista as pv
from PIL import Image

from coilset.model.core.base.errors import CoilsetError
from coilset.model.core.base.style import DIVERGING, QUARTERED, colour_bar, round_end
from coilset.model.core.results.files.folder import whole
from coilset.model.core.results.files.opened import Run
from coilset.model.tools.figures.display import ensure
from coilset.model.tools.figures.scene import ABOVE
from coilset.model.tools.figures.wire_surface import closed, frames, tubes

NAME = "animation.gif"
SIZE = (720, 540)  # pixels
MOST = 80  # pictures
RINGS = 40  # of the wire, a turn
EACH, LAST = 120, 1500  # milliseconds that a picture stays, and the last one
LIGHT = {"ambient": 0.45, "diffuse": 0.6, "specular": 0.0}  # colours stay close to those of the bar
BAR = "shear about the wire's axis, positive with the load, MPa"


def animate(run: Run) -> Path:
    """Write animation.gif: the wire at every step, coloured by the shear stress on its surface, all on one scale.

    Returns:
        The file.

    Raises:
        CoilsetError: if there is no display and none can be started, or the file cannot be written.
    """
    run.require_steps()
    if not ensure():
        raise CoilsetError(f"{NAME} is not drawn: there is no display and no Xvfb")
    shown = frames(run, MOST)
    places, stress = closed(*tubes(run, shown, int(RINGS * np.ptp(run.data["turn"].values)) + 1))
    pictures = [Image.fromarray(one) for one in _draw(shown.labels, places, stress)]
    path = run.folder / NAME
    with whole(path) as partial:
        stays = [EACH] * (len(pictures) - 1) + [LAST]
        pictures[0].save(partial, save_all=True, append_images=pictures[1:], duration=stays, loop=0)
    return path


def _draw(labels: tuple[str, ...], places: np.ndarray, stress: np.ndarray) -> list[np.ndarray]:
    """A picture for each moment."""
    end = round_end(float(np.abs(stress).max()), QUARTERED)
    plotter = pv.Plotter(off_screen=True, window_size=SIZE)
    try:
        plotter.set_background("white")
        wire = pv.StructuredGrid(*np.moveaxis(places[0], -1, 0))
        wire["MPa"] = stress[0].ravel(order="F")
        bar = colour_bar(BAR, (14, 13), (0.2, 0.6), (0.02, 0.12))
        plotter.add_mesh(
            wire, scalars="MPa", clim=(-end, end), cmap=DIVERGING, smooth_shading=False, scalar_bar_args=bar, **LIGHT
        )
        low, high = places.reshape(-1, 3).min(axis=0), places.reshape(-1, 3).max(axis=0)
        across, tall = float(np.max((high - low)[:2])), float((high - low)[2])
        middle, away = 0.5 * (low + high), 10.0 * (across + tall)
        plotter.camera_position = [
            middle + away * np.array([0.0, -1.0, ABOVE]),
            middle - [0.0, 0.0, 0.1 * tall],
            (0, 0, 1),
        ]
        plotter.camera.parallel_projection = True
        plotter.camera.parallel_scale = max(
            0.5 * (tall + ABOVE * across) / 0.65, 0.5 * across / 0.9 * SIZE[1] / SIZE[0]
        )
        pictures = []
        for label, place, value in zip(labels, places, stress, strict=True):
            wire.points[:] = np.stack([place[..., k].ravel(order="F") for k in range(3)], axis=-1)
            wire["MPa"] = value.ravel(order="F")
            plotter.add_text(label, position=(12, SIZE[1] - 30), font_size=10, color="black", name="label")
            pictures.append(plotter.screenshot(return_img=True))
        return pictures
    finally:
        plotter.close()
