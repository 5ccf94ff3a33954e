"""A sweep as one labelled data set in memory: inputs, responses, characteristic and status of each case."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from coilset.model.core.base.version import versions
from coilset.model.core.case.names import entry_name
from coilset.model.core.case.settings import located
from coilset.model.core.results.files.folder import whole
from coilset.model.core.results.files.netcdf import reserve
from coilset.model.core.results.records.units import words_and_unit
from coilset.model.tools.sweep.journal import Records
from coilset.model.tools.sweep.keys import as_rod
from coilset.model.tools.sweep.parquet import corrects, responses_of, words_of_warnings
from coilset.model.tools.sweep.plan import Plan
from coilset.model.tools.sweep.spec import are_numbers

MOST_CASES = 20_000  # in a data set and its figures; all cases of a larger sweep are in its Parquet file
ROUNDING = 1e-9  # mm, N or MPa: a response below is one of arithmetic, as the set of a spring that stays elastic
CURVE = {"travel_mm": "mm", "seat_height_mm": "mm", "force_N": "N", "phase": "1"}


def collect(plan: Plan, folder: str | Path, most: int = MOST_CASES) -> xr.Dataset:
    """The cases of a plan, from the journals of its folder.

    Args:
        folder: of the sweep.
        most: number of cases; of more, so many that are evenly spread over the plan are taken.

    Returns:
        xarray.Dataset with the dimensions `case` and `step`. A case that has not been run has the status "missing"; a
        case that failed has no responses, but its reason and its characteristic so far. Characteristics shorter than
        the longest are filled with NaN. A response with the name of an input gets the suffix `_found`; what rods
        computed of a sweep of uniform rods, the prefix `rod_`.
    """
    n = min(len(plan), most)
    chosen = [place * len(plan) // n for place in range(n)]
    places: dict[str, list[int]] = {}
    for place, case in enumerate(chosen):
        places.setdefault(plan.keys[case], []).append(place)
        if case < plan.spec.rods:
            places.setdefault(as_rod(plan.keys[case]), []).append(place)
    status, reason = np.full(n, "missing", dtype=object), np.full(n, "", dtype=object)
    warnings = np.full(n, "", dtype=object)
    seconds = np.full(n, np.nan)
    responses: dict[str, np.ndarray] = {}
    curves: dict[str, dict[int, np.ndarray]] = {name: {} for name in CURVE}
    for record in Records(folder, places):
        at = places[record["key"]]
        for name, column in record["steps"].items():  # none of a uniform rod
            if name in curves:
                curves[name].update(dict.fromkeys(at, np.array(column, dtype=float)))
        for name, value in responses_of(plan, record).items():
            responses.setdefault(name, np.full(n, np.nan))[at] = value
        if not corrects(plan, record):
            status[at], reason[at], seconds[at] = record["status"], record["reason"], record["seconds"]
            warnings[at] = words_of_warnings(record)
    for column in responses.values():
        column[np.abs(column) < ROUNDING] = 0.0
    data: dict[str, Any] = {
        name: ("case", column, _attributes(*words_and_unit(name))) for name, column in responses.items()
    }
    data |= {
        f"curve_{name}": (
            ("case", "step"),
            _filled(curve, n),
            _attributes(*words_and_unit(name)) | {"units": CURVE[name]},
        )
        for name, curve in curves.items()
    }
    data |= {
        "status": ("case", status),
        "reason": ("case", reason),
        "warnings": ("case", warnings),
        "seconds": ("case", seconds, {"units": "s"}),
    }
    coordinates: dict[str, Any] = {name: ("case", *_input(plan, k, chosen)) for k, name in enumerate(plan.names)}
    attributes: dict[str, Any] = {
        "title": f"sweep {plan.path.stem}",
        "versions": versions(),
        "design": plan.spec.design,
        "model": plan.spec.model,
        "inputs": plan.names,
        "cases": len(plan),
    }
    attributes |= _recipe(plan)
    if plan.spec.samples is not None:
        attributes |= {"samples": plan.spec.samples, "seed": plan.spec.seed}
    return xr.Dataset(data, coordinates | {"key": ("case", [plan.keys[case] for case in chosen])}, attributes)


def _recipe(plan: Plan) -> dict[str, str]:
    """What makes a case of its inputs, as texts of JSON: the base case, the entries that an input sets, and its values
    by their words where they are no numbers."""
    folder = plan.case_path.parent.absolute()
    base = {name: located(name, value, folder) for name, value in plan.base.items()}
    choices = {
        name: {str(row[k]): row[k] for row in plan.rows}
        for k, name in enumerate(plan.names)
        if not plan.rows.is_numeric(k)
    }
    entries = {name: plan.entries(name) for name in plan.names}
    return {name: json.dumps(value) for name, value in (("base", base), ("entries", entries), ("choices", choices))}


def _attributes(words: str, unit: str) -> dict[str, str]:
    return {"long_name": words, "units": unit}


def _filled(curves: dict[int, np.ndarray], n: int) -> np.ndarray:
    """Characteristics of all cases, shape (n, longest), filled with NaN."""
    filled = np.full((n, max((len(curve) for curve in curves.values()), default=0)), np.nan)
    for place, curve in curves.items():
        filled[place, : len(curve)] = curve
    return filled


def _input(plan: Plan, k: int, chosen: Sequence[int]) -> tuple[Any, dict[str, str]]:
    """Values of an input for some cases, words where they are not all numbers, and its attributes."""
    vary, values = plan.spec.vary[plan.names[k]], [plan.rows[case][k] for case in chosen]
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
