"""Residual stress around the wire as a diffractometer sees it, beside the stress at the points of the surface."""

from pathlib import Path

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from coilset.model.core.base.style import STYLE
from coilset.model.tools.figures.png import save

ANGLES = np.arange(-180.0, 181.0, 15.0)


def draw(data: xr.Dataset, path: str | Path, turn: float, spot: float = 1.0, depth: float = 0.0) -> None:
    """Write a PNG of ±45° and of the stress along the wire over the angle about its axis.

    Args:
        data: of `coilset.open`.
        path: the PNG file.
        turn, spot, depth: as of `xray`.

    Raises:
        InputError: as `xray`.
    """
    rows = [data.xray(turn, float(angle), spot, depth) for angle in ANGLES]
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.4, 3.8), layout="constrained")
        axes = figure.add_subplot()
        for k, direction in enumerate(("+45°", "-45°", "along")):
            seen, point = ([float(row[name].sel(direction=direction)) for row in rows] for name in ("stress", "point"))
            axes.plot(ANGLES, seen, "-", color=f"C{k}", lw=1.4, label=f"{direction.replace('-', '−')}, as seen")
            axes.plot(ANGLES, point, "o", ms=3, mfc="none", color=f"C{k}", label="at the point")
        axes.axhline(0.0, color="k", lw=0.6)
        axes.set(
            xlabel="angle about the wire's axis from the coil's inside, degrees",
            ylabel="stress in MPa",
            xticks=np.arange(-180, 181, 60),
            title=f"turn {turn:g}, spot {spot:g} mm, depth {depth:g} µm",
        )
        figure.legend(fontsize=8, ncols=3, loc="outside lower center")
        save(figure, Path(path))
