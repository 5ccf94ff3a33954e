"""Fields of the section for ParaView, and the figure of its stresses."""

from pathlib import Path

import matplotlib as mpl
import numpy as np
import pyvista
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from coilset.model.core.base.style import DIVERGING, STYLE, levels
from coilset.model.core.results.files.folder import subfolder
from coilset.model.core.results.files.grid_file import write_grid
from coilset.model.core.results.records.labels import plain
from coilset.model.physics.slice.analysis import SliceAnalysis, SliceSnapshot
from coilset.model.physics.slice.watch import shear
from coilset.model.physics.solid.continuum import mises
from coilset.model.tools.figures.png import save

FAINT = 1e-4  # of the largest stress: less is what the iteration leaves, as in an elastic spring after its release


def write_fields(folder: Path, analysis: SliceAnalysis) -> None:
    """One .vtu file per snapshot: the section in its current position, with its fields.

    Fields: `displacement` (mm), `place` (ξ outward, η upward from the wire's centre, mm), `stress` (11, 22, 33, 12, 13,
    23 with 1 along the wire, 2 outward, 3 upward, MPa), `shear stress` in the section and `von Mises stress` (MPa),
    `plastic work` (N/mm²).
    """
    folder = subfolder(folder, "fields")
    lattice = analysis.lattice
    start = lattice.positions(analysis.body.start)
    for number, shot in enumerate(analysis.result.snapshots):
        grid = pyvista.UnstructuredGrid({pyvista.CellType.TRIANGLE: lattice.triangles}, shot.x)
        grid.point_data["displacement"] = shot.x - start
        grid.point_data["place"] = np.pad(lattice.places, ((0, 0), (0, 1)))
        grid.point_data["stress"] = shot.stress
        grid.point_data["shear stress"] = shear(shot.stress)
        grid.point_data["von Mises stress"] = mises(shot.stress)
        grid.point_data["plastic work"] = shot.work
        write_grid(folder / f"{number:02d}_{shot.name.replace(' ', '_')}.vtu", grid)


def around_the_wire(places: np.ndarray, stress: np.ndarray) -> np.ndarray:
    """Shear stress along circles about the section's centre, positive anticlockwise in (ξ, η), MPa."""
    distance = np.hypot(*places.T)
    turned = stress[:, 4] * places[:, 0] - stress[:, 3] * places[:, 1]
    return turned / np.where(distance > 0, distance, 1.0)


def figure(path: Path, analysis: SliceAnalysis) -> None:
    """Stress over the section at maximum force and at the end: shear, von Mises stress, and along a diameter."""
    shots = analysis.result.snapshots
    loaded = max(shots, key=lambda shot: abs(shot.force))
    last = shots[-1]
    stressed = float(np.abs(last.stress).max()) > FAINT * float(np.abs(loaded.stress).max())
    rows = [loaded, last] if stressed and last is not loaded else [loaded]
    with mpl.rc_context(STYLE):
        sheet = Figure(figsize=(10.5, 3.3 * len(rows)), layout="constrained")
        axes = sheet.subplots(len(rows), 3, squeeze=False)
        for row, shot in zip(axes, rows, strict=True):
            _row(sheet, row, analysis, shot)
        law, coil = analysis.law.name, analysis.coil
        least, most = (plain(float(f(mises(rows[-1].stress))), 2) for f in (np.min, np.max))
        none = "" if stressed else f"; at {last.name} no stress remains"
        sheet.suptitle(
            f"At {rows[-1].name} the von Mises stress runs from {least} to {most} MPa{none}\n({law}, "
            f"D = {2 * coil.radius:g} mm; the coil's axis is on the left)"
        )
        save(sheet, path)


def _row(sheet: Figure, row: list[Axes], analysis: SliceAnalysis, shot: SliceSnapshot) -> None:
    lattice, when = analysis.lattice, f"{shot.name}, {round(shot.force, 2) + 0.0:.2f} N"
    around = around_the_wire(lattice.places, shot.stress)
    limit, von_mises = max(float(np.abs(around).max()), 1e-9), mises(shot.stress)
    for axes, values, shades, colours, name in (
        (row[0], around, levels(-limit, limit), DIVERGING, "shear about the wire's axis"),
        (row[1], von_mises, levels(0.0, float(von_mises.max())), "viridis", "von Mises stress"),
    ):
        shown = axes.tricontourf(*lattice.places.T, lattice.triangles, values, levels=shades, cmap=colours)
        for side in lattice.rim:
            axes.plot(*lattice.places[side].T, "k-", lw=0.8)
        axes.set(aspect="equal", xlabel="outward, ξ in mm", ylabel="upward, η in mm", title=f"{name}\n{when}")
        sheet.colorbar(shown, ax=axes, label="MPa", shrink=0.9)
    ξ = analysis.line.places[:, 0]
    hole = np.flatnonzero(np.diff(ξ) > 1.5 * (ξ[1] - ξ[0])) + 1  # no line across it
    ξ, τ, σ = (np.insert(values, hole, np.nan) for values in (ξ, shot.line[:, 4], shot.line[:, 0]))
    row[2].plot(ξ, τ, "C0-", lw=1.4, label="shear τ13, upward")
    row[2].plot(ξ, σ, "C1--", lw=1.1, label="normal stress σ11")
    row[2].axhline(0, color="k", lw=0.5)
    row[2].set(xlabel="ξ on the line η = 0, in mm", ylabel="stress in MPa", title=f"from inside to outside\n{when}")
    row[2].grid(lw=0.3)
    row[2].legend(fontsize=8)
