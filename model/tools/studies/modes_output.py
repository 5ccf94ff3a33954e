"""Modes as files: a table, a time series of each mode for ParaView, and a figure."""

from pathlib import Path

import matplotlib as mpl
import meshio
import numpy as np
from matplotlib.figure import Figure

from coilset.model.core.base.style import STYLE
from coilset.model.core.results.files.folder import subfolder, write_table
from coilset.model.core.results.records.labels import plain
from coilset.model.core.results.surface import Inside
from coilset.model.physics.vibration.modes import Modes
from coilset.model.tools.figures.png import save
from coilset.model.tools.figures.series import PER_ELEMENT, tube_cells
from coilset.model.tools.figures.vtkhdf import write_vtkhdf
from coilset.model.tools.figures.wire_surface import surface

COLUMNS = ("mode", "frequency_Hz", "eigenvalue_per_s2", "mass_x_kg", "mass_y_kg", "mass_z_kg", "inertia_z_kg_mm2")
PICTURES = 24  # of one period
SWING = 0.15  # greatest displacement that is drawn, in heights or diameters of the spring
AROUND = 12  # points around the wire
SHOWN, ROWS, WIDTH = 8, 2, 2.1  # modes in the figure, and inches of one


def write_modes(folder: Path, modes: Modes, turns: np.ndarray, x: np.ndarray, radius: np.ndarray) -> list[Path]:
    """Write modes.csv, and mode-01.vtkhdf … with one period of each mode as a time series.

    Args:
        folder: made if needed.
        turns: of the stations, shape (n + 1,).
        x: positions of the stations at rest, shape (n + 1, 3), mm.
        radius: of the wire, shape (n,), mm.
    """
    subfolder(folder.parent, folder.name)
    rows = [
        [k + 1, *map(float, (f, λ, *m))]
        for k, (f, λ, m) in enumerate(zip(modes.frequencies, modes.eigenvalues, modes.masses, strict=True))
    ]
    write_table(folder / "modes.csv", COLUMNS, rows)
    size, rings = SWING * _size(x), PER_ELEMENT * len(radius) + 1
    cells, files = tube_cells(rings, AROUND), [folder / "modes.csv"]
    for number, shape in enumerate(modes.shapes[..., :3], start=1):
        amount = np.linalg.norm(shape, axis=1)
        amounts = np.repeat(0.5 * (amount[1:] + amount[:-1])[:, None], AROUND, axis=1)
        series = []
        for k in range(PICTURES + 1):
            part = np.sin(2.0 * np.pi * k / PICTURES)
            places, shade = surface(turns, x + size * part * shape, radius, amounts, Inside.of(False, 1), rings)
            data = {"amplitude": shade[:, :-1].ravel()}
            series.append((k / PICTURES, meshio.Mesh(places[:, :-1].reshape(-1, 3), cells, point_data=data)))
        files.append(write_vtkhdf(folder / f"mode-{number:02d}.vtkhdf", series))
    return files


def draw_modes(path: Path, modes: Modes, x: np.ndarray, title: str, source: str) -> None:
    """Draw the first modes at both ends of their swing, each seen from the side where it moves most.

    Args:
        path: PNG.
        x: positions of the stations at rest, shape (n + 1, 3), mm.
        title, source: lines above and below.
    """
    count = min(SHOWN, len(modes.eigenvalues))
    columns = -(-count // ROWS)
    with mpl.rc_context(STYLE):
        tall = min(max(WIDTH * np.ptp(x[:, 2]) / np.ptp(x[:, 0]), 0.6 * WIDTH), 3.0 * WIDTH) + 0.4
        figure = Figure(figsize=(WIDTH * columns + 0.6, tall * ROWS + 0.6), layout="constrained")
        for number in range(count):
            shape = modes.shapes[number, :, :3]
            axes = figure.add_subplot(ROWS, columns, number + 1)
            _, vectors = np.linalg.eigh(shape[:, :2].T @ shape[:, :2])
            aside = vectors[:, 1]
            axes.plot(x[:, :2] @ aside, x[:, 2], color="0.75", lw=1.6)
            for sign, colour in ((1.0, "C3"), (-1.0, "C0")):
                moved = x + sign * SWING * _size(x) * shape
                axes.plot(moved[:, :2] @ aside, moved[:, 2], color=colour, lw=0.9)
            axes.set(aspect="equal", title=f"{number + 1}: {plain(float(modes.frequencies[number]), 4)} Hz")
            axes.set_axis_off()
        figure.suptitle(f"{title}\ngrey at rest, red and blue the ends of the swing, enlarged", fontsize=9)
        figure.supxlabel(source, fontsize=6, color="0.5", x=0.99, ha="right")
    save(figure, path)


def _size(x: np.ndarray) -> float:
    """Half of the sum of width and height, mm."""
    return 0.5 * float(np.ptp(x[:, 0]) + np.ptp(x[:, 2]))
