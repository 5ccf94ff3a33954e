"""The spring in 3D: its wire as a tube at several moments, coloured by the stress in it."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyvista as pv
import pyvista.plotting

from coilset.model.core.base.style import DIVERGING, SEQUENTIAL, colour_bar, round_end
from coilset.model.core.results.files.opened import Run
from coilset.model.core.results.files.png_file import write
from coilset.model.core.results.records.labels import plain
from coilset.model.tools.figures.wire_surface import Frames, closed, loading_stress, tubes

RINGS_PER_ELEMENT = 4
MOST_SPRINGS = 4  # side by side
WIDTH, LEAST_HEIGHT, MOST_HEIGHT = 1500, 620, 1500  # of the picture, pixels
LABELS, BAR = 100, 130  # pixels above the springs and below them
COLUMN = 320  # pixels per label
LINE = 0.012  # radius of the force line over the width of the spring
ABOVE = 0.22  # tangent of the angle of view above the horizontal


@dataclass(frozen=True)
class Arrangement:
    """Arrangement of springs in a picture so that all of them fit, however tall.

    Attributes:
        height: of the picture, pixels.
        scale: pixels per millimetre.
        column: distance from spring to spring, mm.
    """

    height: int
    scale: float
    column: float

    @classmethod
    def of(cls, across: float, tall: float, springs: int) -> "Arrangement":
        """That of a number of springs of the given width and height, mm."""
        seen = tall + ABOVE * across
        scale = min(WIDTH / (1.35 * across * springs), (MOST_HEIGHT - LABELS - BAR) / seen)
        column = max(1.35 * across, min(COLUMN, WIDTH / springs) / scale)
        return cls(max(LEAST_HEIGHT, round(seen * scale) + LABELS + BAR), scale, column)


def chosen(force: np.ndarray) -> list[int]:
    """The snapshots of springs.png by their forces: the start, the maximum load, and the last ones, in their order."""
    if len(force) <= MOST_SPRINGS:
        return list(range(len(force)))
    loaded = int(np.abs(force).argmax())
    latest = [number for number in reversed(range(len(force))) if number not in (0, loaded)]
    return sorted({0, loaded, *latest[: MOST_SPRINGS - len({0, loaded})]})


def springs(path: str | Path, run: Run) -> None:
    """Draw snapshots side by side, coloured by the stress that loads the wire most, `loading_stress`.

    Args:
        path: PNG to write.
        run: opened results.
    """
    name, loading = loading_stress(run)
    data, snapshots = run.data, chosen(run.data["force"].values)
    radius, positions = data["wire_radius"].values, data["position"].values[snapshots]
    rings = RINGS_PER_ELEMENT * len(radius) + 1
    shown = Frames(tuple(caption(run, number) for number in snapshots), positions, loading[snapshots].mean(axis=2))
    places, stresses = closed(*tubes(run, shown, rings))
    x = positions.reshape(-1, 3)
    low, high = float(x[:, 2].min() - radius.max()), float(x[:, 2].max() + radius.max())
    across = float(np.ptp(x[:, :2], axis=0).max()) + 2.0 * float(radius.max())
    aside = 0.5 * float(x[:, 0].min() + x[:, 0].max())  # a buckled spring deflects to one side
    view = Arrangement.of(across, high - low, len(snapshots))
    end = round_end(float(np.abs(stresses).max()))
    signed = loading.min() < 0.0
    middle = aside + 0.5 * view.column * (len(snapshots) - 1)
    bar = colour_bar(name, (17, 16), (0.3, 0.4), (12 / view.height, (BAR - 28.0) / view.height))  # one size in pixels
    plotter = pv.Plotter(off_screen=True, window_size=(WIDTH, view.height))
    plotter.set_background("white")
    arbor = run.case.get("contact", {}).get("arbor")
    for place, number in enumerate(snapshots):
        if arbor:
            half = (place * view.column, 0.0, 0.5 * (low + high))
            rod = pv.Cylinder(center=half, direction=(0, 0, 1), radius=0.5 * arbor, height=1.1 * (high - low))
            plotter.add_mesh(rod, color="lightgrey", smooth_shading=True, split_sharp_edges=True)
        ends = force_line(run, number)
        if ends is not None:
            first, last = ends + np.array([place * view.column, 0.0, 0.0])
            plotter.add_mesh(pv.Tube(first, last, radius=LINE * across), color="black")
        mesh = pv.StructuredGrid(*np.moveaxis(places[place] + np.array([place * view.column, 0.0, 0.0]), -1, 0))
        mesh[name] = stresses[place].ravel(order="F")
        plotter.add_mesh(
            mesh,
            scalars=name,
            clim=(-end if signed else 0.0, end),
            cmap=DIVERGING if signed else SEQUENTIAL,
            smooth_shading=True,
            split_sharp_edges=True,  # or the cut ends look like balls
            scalar_bar_args=bar,
        )
        foot = [aside + place * view.column, 0.0, high + (0.5 * ABOVE * across + 15.0 / view.scale)]
        plotter.add_point_labels(
            [foot],
            [shown.labels[place]],
            font_size=20,
            text_color="black",
            shape=None,
            show_points=False,
            always_visible=True,
            justification_horizontal="center",
        )
    centre, away = 0.5 * (low + high) + 0.5 * (LABELS - BAR) / view.scale, 10.0 * (high - low + across)
    plotter.camera_position = [(middle, -away, centre + ABOVE * away), (middle, 0.0, centre), (0, 0, 1)]
    plotter.camera.parallel_projection = True
    plotter.camera.parallel_scale = 0.5 * view.height / view.scale
    try:
        pixels = plotter.screenshot(return_img=True)
        write(path, pixels, "; ".join(label.replace("\n", ": ") for label in shown.labels))
    finally:
        plotter.close()


def force_line(run: Run, number: int) -> np.ndarray | None:
    """Both ends of the force line at a snapshot, at the seats, shape (2, 3), mm; None without `force_line` or force."""
    last = np.flatnonzero(run.data["phase"].values == number - 1)
    if run.case.get("force_line") is None or not len(last):
        return None
    heights = 0.0, float(run.data["seat_height_mm"].values[last[-1]])
    ends = [
        [float(run.data[f"{end}_{of}_{name}_mm"].values[last[-1]]) for of in ("shift", "centre") for name in "xy"]
        for end in ("bottom", "top")
    ]
    found = np.array([[x + ex, y + ey, z] for (x, y, ex, ey), z in zip(ends, heights, strict=True)])
    return found if np.isfinite(found).all() else None


def caption(run: Run, number: int) -> str:
    """Name, height and force of a snapshot, the force of a pulled spring with its sign; rounding counts as zero. Of a
    torsion spring rotation and torque."""
    if run.is_turned:
        last = np.flatnonzero(run.data["phase"].values == number - 1)
        values = (run.data[name].values for name in ("turn_deg", "torque_Nmm"))
        turn, torque = (float(one[last[-1]]) if len(last) else 0.0 for one in values)
        return f"{run.snapshots[number]}\n{plain(turn)}°, {plain(torque if abs(torque) > 1e-3 else 0.0)} N mm"
    height, force = (float(run.data[name].values[number]) for name in ("height", "force"))
    force = force if abs(force) > 1e-6 * float(np.abs(run.data["force"].values).max()) else 0.0
    return f"{run.snapshots[number]}\n{plain(height, 5)} mm, {plain(force)} N"
