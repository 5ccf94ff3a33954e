"""Read a run's folder as named columns of numbers and texts."""

import csv
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr

UNFINISHED = "unfinished"  # folder of the run that is under way
UNTIMED = ("s", "seconds")  # columns of tables that hold times, which no two runs share


@dataclass(frozen=True)
class Column:
    """One quantity of a run.

    Attributes:
        values: floats, whole numbers or texts, any shape.
        scale: magnitude that differences are measured by if it is larger than all values, in their unit.
    """

    values: np.ndarray
    scale: float = 0.0

    @property
    def kind(self) -> str:
        """`real`, `count` or `text`."""
        return {"f": "real", "i": "count", "u": "count", "b": "count"}.get(self.values.dtype.kind, "text")


def read_run(folder: Path) -> dict[str, Column]:
    """All columns of the files in a run's folder, by file and name."""
    readers = {".json": read_json, ".csv": read_csv, ".nc": read_netcdf, ".npz": read_npz}
    found = {}
    for path in sorted(folder.iterdir()):
        if path.suffix in readers:
            found |= {f"{path.name} {name}": column for name, column in readers[path.suffix](path).items()}
    return found


def read_csv(path: Path) -> dict[str, Column]:
    """One column for each of the file's."""
    with open(path, encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return {name: column([number(row[name]) for row in rows]) for name in (rows[0] if rows else ())}


def read_netcdf(path: Path) -> dict[str, Column]:
    """One column for each variable, but for each component of `history` and of `resultants`: their units differ."""
    found = {}
    with xr.open_dataset(path, engine="h5netcdf") as data:
        for name, variable in data.variables.items():
            last = {"point_state": "component", "resultants": "resultant"}.get(name)
            parts = {f"{name} {one}": data[name].sel({last: one}) for one in data[last].values} if last else {}
            found |= {label: column(part.values) for label, part in (parts or {name: variable}).items()}
    return found


def read_npz(path: Path) -> dict[str, Column]:
    """One column for each array."""
    with np.load(path) as file:
        return {name: column(file[name]) for name in file.files}


def read_json(path: Path) -> dict[str, Column]:
    """One column for each entry of a summary; checks and columns of tables of a record of verification."""
    data = json.loads(path.read_text(encoding="utf-8"))
    if "checks" not in data:
        return {name: column([value]) for name, value in data.items() if name != "origin"}  # it holds the date
    found = {}
    for place, check in enumerate(data["checks"]):
        # a number that ought to vanish is measured by what it may be
        scale = max(abs(check["reference"]), 0.0 if check["kind"] == "relative" else check["tolerance"])
        label = f"{place + 1}: {check['quantity']}"
        found[f"{label}, ours"] = column([check["ours"]], scale)
        found[f"{label}, reference"] = column([check["reference"]])
        passed = check["passed"] if "passed" in check else check["verdict"] == "met"  # of records before verdicts
        found[f"{label}, passed"] = column([passed])
    for table in data["tables"]:
        for place, name in enumerate(table["columns"]):
            if name not in UNTIMED:
                label = f"table {table['title']!r}, {place + 1}: {name}"
                found |= by_kind(label, [row[place] for row in table["rows"]])
    return found | {"notes": column(data["notes"])}


def by_kind(label: str, values: list) -> dict[str, Column]:
    """A table's column that may hold numbers as well as texts, split."""
    texts = [value for value in values if isinstance(value, str)]
    numbers = [value for value in values if not isinstance(value, str)]
    parts = {label: numbers, f"{label} (texts)": texts}
    return {name: column(part) for name, part in parts.items() if part}


def number(text: str) -> float | int | str:
    """What a cell of a CSV file holds; an empty one is not a number."""
    for kind in (int, float):
        try:
            return kind(text or "nan")
        except ValueError:
            pass
    return text


def column(values, scale: float = 0.0) -> Column:
    """A Column; None is not a number."""
    if isinstance(values, list):
        plain = [json.dumps(value) if isinstance(value, list | dict) else value for value in values]
        values = np.array([np.nan if value is None else value for value in plain])
    values = np.asarray(values)
    if values.dtype.kind == "O":
        values = values.astype(str)
    return Column(values, abs(scale))
