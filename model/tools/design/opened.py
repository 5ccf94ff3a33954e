"""Results of `coilset design` as a labelled data set with units."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from coilset.model.core.base.errors import reading
from coilset.model.core.results.files.labelled import add_summary
from coilset.model.core.results.records.units import unit_of
from coilset.model.tools.design.conditions import GROUP, without_limit
from coilset.model.tools.sweep.journal import read_records

FILE = "design.json"


def open_design(folder: str | Path) -> xr.Dataset:
    """Read the results of a search.

    Args:
        folder: the results folder.

    Returns:
        Over `evaluation`: each unknown by its name in the file, and the value of each condition (NaN of a run that
        failed), with `units` and, of a condition, its `target`, or its limits `at_least` and `at_most`. Scalars:
        `found_` and the unknown, and `summary_…` of the spring that was found. `slope` over `condition` and `unknown`,
        in their units. Over `trade_off`: what is `changed` and its value, `possible`, and estimates of the unknowns,
        `estimate_` and the unknown. The case (JSON) and whether all conditions are `met` are attributes.

    Raises:
        InputError: if a file cannot be read.
    """
    folder = Path(folder)
    with reading(folder / FILE):
        design, records = read_design(folder)
        data = _searched(design, records)
        _add_trade_offs(data, design)
        add_summary(data, design["summary"])
        data.attrs |= {
            "case": json.dumps(design["origin"]["case"]),
            "versions": design["origin"]["versions"],
            "met": int(design["met"]),
            "method": design["method"],
        }
    return data


def read_design(folder: Path) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """The content of design.json, and the record of each evaluation; the journal may hold those of other designs.

    Raises:
        InputError: if a file cannot be read.
    """
    with reading(folder / FILE):
        design = json.loads((folder / FILE).read_text(encoding="utf-8"))
        heights = {one["name"]: one["height_mm"] for one in design["conditions"]}
        subject = [
            *design["found"],
            *(without_limit(name) if height is None else height for name, height in heights.items()),
        ]
    return design, [one for one in read_records(folder / "evaluations.jsonl") if one.get("of", subject) == subject]


def _searched(design: dict[str, Any], records: list[dict[str, Any]]) -> xr.Dataset:
    """Evaluations, solution, and slopes."""
    data = xr.Dataset(coords={"evaluation": np.arange(1, len(records) + 1)})
    for place, (name, value) in enumerate(design["found"].items()):
        units = {"units": design["unknowns"][name]["unit"] or "1"}
        data[name] = ("evaluation", [record["x"][place] for record in records], units)
        data[f"found_{name}"] = ((), value, units)
    for place, one in enumerate(design["conditions"]):
        column = [_number(next(iter(record["values"][place:]), None)) for record in records]  # failed: one
        of = {"units": one["unit"], "target" if one["kind"] == "equals" else one["kind"]: one["target"]}
        name = without_limit(one["name"]).removeprefix(GROUP)
        data[name] = ("evaluation", column, (data[name].attrs if name in data else {}) | of)
    names = [name.removeprefix(GROUP) for name in design["slopes"]]
    sought = list(next(iter(design["slopes"].values())))
    slopes = np.array([list(row.values()) for row in design["slopes"].values()]).reshape(len(names), len(sought))
    return data.assign(slope=(("condition", "unknown"), slopes)).assign_coords(condition=names, unknown=sought)


def _add_trade_offs(data: xr.Dataset, design: dict[str, Any]) -> None:
    rows = design["trade_offs"]
    if not rows:
        return
    for name, of in (("changed", "of"), ("changed_to", "value")):
        data[name] = ("trade_off", [str(row[of]) for row in rows])
    data["possible"] = ("trade_off", [bool(row["possible"]) for row in rows])
    for name in design["found"]:
        column = [_number(row["unknowns"][name]) for row in rows]
        data[f"estimate_{name}"] = ("trade_off", column, {"units": design["unknowns"][name]["unit"] or "1"})
    for name in ("wire_length_mm", "free_length_before_mm"):
        data[f"estimate_{name}"] = ("trade_off", [_number(row[name]) for row in rows], {"units": unit_of(name)})


def _number(value: float | None) -> float:
    """NaN for none."""
    return float("nan") if value is None else float(value)
