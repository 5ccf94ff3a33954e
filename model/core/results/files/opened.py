"""Reading a results folder: the summary, the tables and the section points, for reports and studies."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from coilset.model.core.base.columns import number, read_columns
from coilset.model.core.base.errors import InputError, reading
from coilset.model.core.results.files.netcdf import read_netcdf
from coilset.model.core.results.loading import Loading, loading_of
from coilset.model.core.results.records.units import unit_of
from coilset.model.core.rod.elements import THESIS


@dataclass(frozen=True)
class Run:
    """A run, read from its folder.

    Attributes:
        folder: its path.
        summary: of summary.json.
        data: history.csv and seats.csv along the dimension `step`, and all of points.nc; each with its `units`.
    """

    folder: Path
    summary: dict[str, Any]
    data: xr.Dataset

    @property
    def case(self) -> dict[str, Any]:
        """The case with all its defaults."""
        case: dict[str, Any] = self.summary["origin"]["case"]
        return case

    @property
    def is_turned(self) -> bool:
        """Whether the spring is one of torsion."""
        return loading_of(self.summary) is Loading.TURNED

    @property
    def has_steps(self) -> bool:
        """Whether it came to its first step."""
        return "phase" in self.data

    def require_steps(self) -> None:
        """Check whether there is anything to show.

        Raises:
            InputError: it ended before its first step.
        """
        if not self.has_steps:
            raise InputError("the run has no steps: it ended before its first one", "", self.folder)

    @property
    def snapshots(self) -> list[str]:
        """Names of the snapshots: the start, and the end of each phase."""
        return [str(name) for name in self.data["snapshot"].values]


def open_run(folder: str | Path) -> Run:
    """Read a results folder of `coilset solve`.

    Raises:
        InputError: if it holds no run, or a file cannot be read.
    """
    folder = Path(folder)
    for name in ("summary.json", "points.nc", "history.csv", "seats.csv"):  # no pipes either, which never end
        if not (folder / name).is_file():
            within = min(folder.glob("*/points.nc"), default=None)  # of a nest's springs, or of runs in one folder
            hint = f"; is {within.parent} meant?" if within else ""
            problem = _other_results(folder) or f"holds no results of a run: there is no {name}"
            raise InputError(f"{problem}{hint}", "", folder)
    with reading(folder / "summary.json"):
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    with reading(folder / "points.nc"):
        data = current_names(read_netcdf(folder / "points.nc"))
    for name in ("history", "seats"):
        with reading(folder / f"{name}.csv"):
            data = data.merge(table(folder / f"{name}.csv"), compat="override", join="outer")
    if "origin" not in summary:
        raise InputError("is of a version without the case in it; solve it again", "", folder / "summary.json")
    return Run(folder, summary, data)


def is_slice(folder: Path) -> bool:
    """Whether a folder holds the results of `coilset slice`, which has no section points of a rod."""
    return all((folder / name).is_file() for name in ("summary.json", "history.csv")) and not any(
        (folder / name).exists() for name in ("points.nc", "seats.csv")
    )


OTHERS = {"sweep.nc": "a sweep", "design.json": "a design", "nest.csv": "a nest"}
"""Results of other commands, by a file that only they write."""


def _other_results(folder: Path) -> str:
    """That a folder holds results of another command; empty if it has none."""
    if is_slice(folder):
        return "holds a slice, not a run: a slice has neither page nor modes"
    return next((f"holds {words}, not a run" for name, words in OTHERS.items() if (folder / name).is_file()), "")


EARLIER = {"history": "point_state"}
"""Earlier names of variables in points.nc; `history` are the columns of history.csv, over the steps."""


def current_names(data: xr.Dataset) -> xr.Dataset:
    """points.nc with the names of today, and what those of before lack."""
    data = data.rename({old: new for old, new in EARLIER.items() if old in data})
    return data if "abscissa" in data else data.assign(abscissa=("gauss", THESIS.xi))


def table(path: Path) -> xr.Dataset:
    """Columns of a CSV as variables along `step`, NaN for empty fields; also as a spreadsheet saved it.

    Raises:
        InputError, ValueError: if it cannot be read, is empty.
    """
    columns = read_columns(path)
    if not columns.names:
        raise ValueError("it is empty")
    step, *names = columns.names
    if not columns.rows or not names:
        return xr.Dataset()
    values = {name: np.array([number(row.get(name)) for _, row in columns.rows]) for name in names}
    variables = {name: ("step", values[name], {"units": unit_of(name)}) for name in names}
    return xr.Dataset(variables, coords={"step": columns.numbers(step).astype(int)})
