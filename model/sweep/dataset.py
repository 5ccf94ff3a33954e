"""A sweep as one labelled data set: inputs, responses, characteristic and status of each case."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from coilset.model.base.version import versions
from coilset.model.case.names import entry_name
from coilset.model.case.settings import located
from coilset.model.results.files.folder import whole
from coilset.model.results.files.netcdf import reserve
from coilset.model.results.records.units import quantity
from coilset.model.sweep.journal import read_records
from coilset.model.sweep.plan import Plan
from coilset.model.sweep.spec import are_numbers

CURVE = {"travel_mm": "mm", "seat_height_mm": "mm", "force_N": "N", "phase": "1"}


def collect(plan: Plan, journal: str | Path) -> xr.Dataset:
    """All cases of a plan, from the journal.

    Args:
        plan: Plan.
        journal: path of the journal.

    Returns:
        xarray.Dataset with the dimensions `case` and `step`. A case that has not been run has the status "missing"; a
        case that failed has no responses, but its reason and its characteristic so far. Characteristics shorter than
        the longest are filled with NaN. A response with the name of an input gets the suffix `_found`.
    """
    places: dict[str, list[int]] = {}
    for place, key in enumerate(plan.keys):
        places.setdefault(key, []).append(place)
    records = {record["key"]: record for record in read_records(journal) if record["key"] in places}
    n = len(plan)
    status, reason = np.full(n, "missing", dtype=object), np.full(n, "", dtype=object)
    warnings = np.full(n, "", dtype=object)
    seconds = np.full(n, np.nan)
    responses: dict[str, np.ndarray] = {}
    longest = max((len(record["steps"].get("force_N", ())) for record in records.values()), default=0)
    curves = {name: np.full((n, longest), np.nan) for name in CURVE}
    for key, record in records.items():
        at = places[key]
        status[at], reason[at], seconds[at] = record["status"], record["reason"], record["seconds"]
        warnings[at] = ", ".join(warning["name"] for warning in record["summary"].get("warnings", ()))
        for name, curve in curves.items():
            column = np.array(record["steps"].get(name, ()), dtype=float)
            curve[at, : len(column)] = column
        if record["status"] == "done":
            for name, value in record["summary"].items():
                if value is None or (isinstance(value, (int, float)) and not isinstance(value, bool)):
                    name = f"{name}_found" if name in plan.names else name
                    column = responses.setdefault(name, np.full(n, np.nan))
                    column[at] = np.nan if value is None else value
    data: dict[str, Any] = {name: ("case", column, _attributes(*quantity(name))) for name, column in responses.items()}
    data |= {
        f"curve_{name}": (("case", "step"), curve, _attributes(*quantity(name)) | {"units": CURVE[name]})
        for name, curve in curves.items()
    }
    data |= {
        "status": ("case", status),
        "reason": ("case", reason),
        "warnings": ("case", warnings),
        "seconds": ("case", seconds, {"units": "s"}),
    }
    coordinates: dict[str, Any] = {name: ("case", *_input(plan, k)) for k, name in enumerate(plan.names)}
    attributes: dict[str, Any] = {
        "title": f"sweep {plan.path.stem}",
        "versions": versions(),
        "design": plan.spec.design,
        "inputs": plan.names,
    }
    attributes |= _recipe(plan)
    if plan.spec.samples is not None:
        attributes |= {"samples": plan.spec.samples, "seed": plan.spec.seed}
    return xr.Dataset(data, coordinates | {"key": ("case", plan.keys)}, attributes)


def _recipe(plan: Plan) -> dict[str, str]:
    """What makes a case of its inputs, as texts of JSON: the base case, the entries that an input sets, and its values
    by their words where they are no numbers."""
    folder = plan.case_path.parent.absolute()
    base = {name: located(name, value, folder) for name, value in plan.base.items()}
    choices = {
        name: {str(row[k]): row[k] for row in plan.rows}
        for k, name in enumerate(plan.names)
        if not are_numbers([row[k] for row in plan.rows])
    }
    entries = {name: plan.entries(name) for name in plan.names}
    return {name: json.dumps(value) for name, value in (("base", base), ("entries", entries), ("choices", choices))}


def _attributes(words: str, unit: str) -> dict[str, str]:
    return {"long_name": words, "units": unit}


def _input(plan: Plan, k: int) -> tuple[Any, dict[str, str]]:
    """Values of an input for all cases, words where they are not all numbers, and its attributes."""
    vary, values = plan.spec.vary[plan.names[k]], [row[k] for row in plan.rows]
    words = vary.label or _plain_words(plan)[k]
    if not are_numbers(values):
        return np.array([str(value) for value in values], dtype=object), _attributes(words, vary.unit or "")
    units = {entry_name(entry).unit for entry in plan.entries(plan.names[k])}
    own = units.pop() if len(units) == 1 else ""
    return np.array(values, dtype=float), _attributes(words, own if vary.unit is None else vary.unit)


def _plain_words(plan: Plan) -> list[str]:
    """Names of inputs in words; the entries themselves if two of them had the same."""
    found = [entry_name(name, plan.base).words for name in plan.names]
    return found if len(set(found)) == len(found) else list(plan.names)


def write(path: str | Path, data: xr.Dataset) -> None:
    """Write the data set as NetCDF 4, compressed."""
    packed = {name: {"zlib": True, "complevel": 1} for name in data.data_vars if data[name].dtype.kind == "f"}
    with whole(path) as partial:
        reserve(partial, data.nbytes)
        data.to_netcdf(partial.absolute(), engine="h5netcdf", encoding=packed)
