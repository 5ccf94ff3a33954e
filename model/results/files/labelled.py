"""All results in a folder as one labelled data set with units."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import xarray as xr

from coilset.model.base.errors import reading
from coilset.model.results.files.opened import open_run
from coilset.model.results.records.units import unit_of


def labelled(folder: str | Path) -> xr.Dataset:
    """Read the results of `coilset solve` or `coilset sweep`.

    Args:
        folder: the results folder.

    Returns:
        Of a run: the columns of history.csv and seats.csv over `step`, all of points.nc, and each number of
        summary.json as `summary_…`, with `units`; its words and the case (JSON) are attributes. Of a sweep: sweep.nc.

    Raises:
        InputError: if there are no such results in it, or a file of them cannot be read.
    """
    folder = Path(folder)
    if (folder / "sweep.nc").is_file():
        with reading(folder / "sweep.nc"), xr.open_dataset(folder / "sweep.nc", engine="h5netcdf") as file:
            return file.load()
    run = open_run(folder)
    data = run.data.copy()
    add_summary(data, run.summary)
    data.attrs["case"] = json.dumps(run.case)
    return data


def add_summary(data: xr.Dataset, summary: Mapping[str, Any]) -> None:
    """Add each number of a summary as `summary_…` with its `units`, NaN for none, and its words as attributes."""
    for name, value in summary.items():
        if isinstance(value, int | float) or value is None:
            number = float("nan") if value is None else float(value)
            data[f"summary_{name}"] = ((), number, {"units": unit_of(name)})
        elif isinstance(value, str):
            data.attrs[name] = value
