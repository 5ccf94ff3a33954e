"""All results in a folder as one labelled data set with units."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from coilset.model.core.base.errors import reading
from coilset.model.core.results.files.netcdf import read_netcdf
from coilset.model.core.results.files.opened import is_slice, open_run, table
from coilset.model.core.results.records.units import unit_of


def labelled(folder: str | Path) -> xr.Dataset:
    """Read the results of `coilset solve`, `coilset slice` or `coilset sweep`.

    Args:
        folder: the results folder.

    Returns:
        Of a run: the columns of history.csv and seats.csv over `step`, all of points.nc, and each number of
        summary.json as `summary_…`, with `units`; its words and the case (JSON) are attributes. Of a slice: the
        columns of history.csv, the summary, and the stress of the section at the snapshots. Of a sweep: sweep.nc.

    Raises:
        InputError: if there are no such results in it, or a file of them cannot be read.
    """
    folder = Path(folder)
    if (folder / "sweep.nc").is_file():
        with reading(folder / "sweep.nc"):
            return read_netcdf(folder / "sweep.nc")
    if is_slice(folder):
        return _slice(folder)
    run = open_run(folder)
    data = run.data.copy()
    add_summary(data, run.summary)
    data.attrs["case"] = json.dumps(run.case)
    return data


def _slice(folder: Path) -> xr.Dataset:
    with reading(folder / "summary.json"):
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    with reading(folder / "history.csv"):
        data = table(folder / "history.csv")
    add_summary(data, summary)
    data.attrs["case"] = json.dumps(summary["origin"]["case"])
    return data.merge(_sections(folder / "fields"))


def _sections(folder: Path) -> xr.Dataset:
    """Stress of a slice's section at its snapshots; empty if there are none, or of an earlier version."""
    import pyvista

    files = sorted(folder.glob("*.vtu"))
    grids = [pyvista.read(file) for file in files]
    if not grids or any("place" not in grid.point_data for grid in grids):
        return xr.Dataset()
    stress = np.stack([np.asarray(grid.point_data["stress"]) for grid in grids])
    place = np.asarray(grids[0].point_data["place"])[:, :2]
    return xr.Dataset(
        {
            "section_stress": (("snapshot", "point", "component"), stress, {"units": "MPa"}),
            "section_place": (("point", "across"), place, {"units": "mm", "about": "outward, upward"}),
        },
        {
            "snapshot": [file.stem.partition("_")[2].replace("_", " ") for file in files],
            "component": ["s11", "s22", "s33", "t12", "t13", "t23"],
        },
    )


def add_summary(data: xr.Dataset, summary: Mapping[str, Any]) -> None:
    """Add each number of a summary as `summary_…` with its `units`, NaN for none, and its words as attributes."""
    # all at once: each update aligns every index of the data again
    data.update(
        {
            f"summary_{name}": ((), float("nan") if value is None else float(value), {"units": unit_of(name)})
            for name, value in summary.items()
            if isinstance(value, int | float) or value is None
        }
    )
    data.attrs.update({name: value for name, value in summary.items() if isinstance(value, str)})
