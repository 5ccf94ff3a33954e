"""The page of a sweep: all its cases in a table to filter, sort and open, and which input matters most."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from coilset.model.core.base.errors import reading
from coilset.model.core.results.files.labelled import labelled
from coilset.model.tools.figures.panels.panel import COLOURS, Panel, axis
from coilset.model.tools.findings import findings
from coilset.model.tools.findings.capability import capabilities
from coilset.model.tools.findings.histogram import histogram
from coilset.model.tools.findings.sensitivity import rank_correlation
from coilset.model.tools.report.answer import Number
from coilset.model.tools.report.render import write_page
from coilset.model.tools.report.warning_words import in_words
from coilset.model.tools.sweep.multifidelity import QUANTILES, as_rods, of_response

FILE = "sweep.nc"
SHOWN = ("set_mm", "force_max_N", "rate_N_per_mm", "residual_shear_inside_MPa", "status", "warnings")  # at first
ANSWERS = SHOWN[:4]
CURVES = 4_000_000  # numbers of all characteristics together, at most; beyond, a page shows none
ENOUGH = 8  # cases from which a rank correlation has a meaning
DIGITS = 6  # of a number in the table


def write_sweep_report(folder: str | Path) -> Path:
    """Write report.html into the folder of a sweep.

    Returns:
        The file.

    Raises:
        InputError: if the data cannot be read, or a file that the case names has gone. CoilsetError: if the page
            cannot be written.
    """
    folder = Path(folder)
    with reading(folder / FILE):
        data = labelled(folder)
        of = next((name for name in ANSWERS if name in data and data[name].notnull().any()), "seconds")
        shown = as_rods(data)
        columns = _columns(shown, of)
    capable = capabilities(data)
    panels = [panel for panel in (_deciding(shown, of), _spread(shown, of)) if panel is not None]
    counts = {status: int((data["status"] == status).sum()) for status in ("done", "failed", "missing")}
    names = [data[name].attrs["long_name"] for name in _list(data.attrs["inputs"])]
    cases, sample = f"{data.attrs.get('cases', data.sizes['case']):,} cases", ""
    if data.sizes["case"] < data.attrs.get("cases", 0):
        sample = f"A sample of {data.sizes['case']:,} of the {cases}, evenly spread over the plan"
    uniform = "; uniform rods, without ends and contacts" if data.attrs.get("model") == "uniform_rod" else ""
    uniform += ", corrected by the rods among them" if any(str(name).startswith("rod_") for name in data) else ""
    return write_page(
        folder,
        "sweep",
        [("Limits", [histogram(one) for one in capable]), ("Which input matters most", panels)],
        {"columns": columns, "curves": _curves(data), "files": _files(data)},
        title=f"{folder.resolve().name}: {cases}",
        subtitle=f"{sample or cases}; {', '.join(names)} varied ({data.attrs['design'].replace('_', ' ')}){uniform}",
        sample=sample,
        answer=[
            Number(
                "cases of the sample" if sample else "cases",
                f"{counts['done']} done",
                f"{counts['failed']} failed, {counts['missing']} missing",
            ),
            *(_range(data, shown[name]) for name in ANSWERS if name in data),
        ],
        warnings=_warnings(data),
        capable=[one.row | {"advice": one.advice} for one in capable],
        by=capable[0].by if capable else "",
        finding=findings.extent(shown, of),
        made_with="; ".join(filter(None, (data.attrs["title"], data.attrs.get("versions", "")))),
    )


# ---- what the scripts take -------------------------------------------------------------------------------------------


def _columns(data: xr.Dataset, of: str) -> list[dict[str, Any]]:
    """Columns: number of the case, inputs, responses that are shown at first, and the others."""
    n = data.sizes["case"]
    numbers = np.arange(n) * int(data.attrs.get("cases", n)) // n + 1 if n else np.zeros(0)
    found = [_column("case", "case", "", numbers, True, "")]
    inputs = _list(data.attrs["inputs"])
    rest = [name for name in data.data_vars if data[name].dims == ("case",) and name not in SHOWN]
    first = [name for name, _, _ in _ranked(data, of)]
    roles = dict(zip(("x", "c"), dict.fromkeys([*first, *_inputs(data)]), strict=False)) | {"y": of}
    for name in (*inputs, *(name for name in SHOWN if name in data), *rest):
        attrs = data[name].attrs
        role = next((role for role, one in roles.items() if one == name), "")
        found.append(
            _column(
                str(name),
                attrs.get("long_name", str(name)),
                attrs.get("units", ""),
                data[name].values,
                name in inputs or name in SHOWN,
                role,
            )
        )
    return found


def _column(name: str, words: str, unit: str, values: np.ndarray, shown: bool, role: str) -> dict[str, Any]:
    numeric = values.dtype.kind in "fiu"
    listed = [None if value != value else value for value in values.tolist()] if numeric else list(map(str, values))
    return {
        "name": name,
        "words": words,
        "unit": unit,
        "numeric": numeric,
        "digits": DIGITS,
        "values": listed,
        "shown": shown,
        "role": role,
    }


def _curves(data: xr.Dataset) -> dict[str, np.ndarray] | None:
    travel, force = data["curve_travel_mm"].values, data["curve_force_N"].values
    return {"travel": travel, "force": force} if 0 < travel.size + force.size <= CURVES else None


def _files(data: xr.Dataset) -> dict[str, Any] | None:
    """What makes a case's file; None of a sweep that does not hold it."""
    if "base" not in data.attrs:
        return None
    return {name: json.loads(data.attrs[name]) for name in ("base", "entries", "choices")}


def _list(value: Any) -> list[str]:
    """An attribute that is a list; a file gives a list of one as a word."""
    return [value] if isinstance(value, str) else list(map(str, value))


# ---- what is said ----------------------------------------------------------------------------------------------------


def _inputs(data: xr.Dataset) -> list[str]:
    return [name for name in _list(data.attrs["inputs"]) if data[name].dtype.kind == "f"]


def _range(data: xr.Dataset, values: xr.DataArray) -> Number:
    """Of a response, as it is shown."""
    name, unit = str(values.name), values.attrs["units"]
    if not bool(values.notnull().any()):
        return Number(values.attrs["long_name"], "not reached")
    low, mean, high = (findings.number(value) for value in (values.min(), values.mean(), values.max()))
    words, extent = values.attrs["long_name"], f"{low} to {high} {unit}"
    try:
        estimates = of_response(data, name)
    except ValueError:  # all cases are of one model
        return Number(words, extent, f"mean {mean} {unit}")
    five, _, most = (findings.number(estimates.quantile(level).value) for level in QUANTILES)
    found = estimates.mean()
    ends = f"{findings.number(found.low)} to {findings.number(found.high)}"
    by = f"mean {findings.number(found.value)} ({ends}) from {len(estimates.rod)} rods and uniform ones, of {extent}"
    return Number(f"{words}, 5 to 95 %", f"{five} to {most} {unit}", by)


def _warnings(data: xr.Dataset) -> list[str]:
    names: dict[str, int] = {}
    for text in data["warnings"].values:
        for name in filter(None, str(text).split(", ")):
            names[name] = names.get(name, 0) + 1
    cases = data.sizes["case"]
    return [
        f"{in_words(name)} (in {f'all {cases}' if count == cases else f'{count} of {cases}'} cases)"
        for name, count in names.items()
    ]


def _ranked(data: xr.Dataset, of: str) -> list[tuple[str, float, np.ndarray]]:
    """Inputs with their rank correlation with a response and its interval, the strongest first.

    None of too few cases, and of a response that never changes.
    """
    values = data[of].values
    good = np.isfinite(values)
    if good.sum() < ENOUGH or np.ptp(values[good]) == 0.0:
        return []
    varied = [name for name in _inputs(data) if np.ptp(data[name].values[good]) > 0.0]
    if not varied:
        return []
    correlation, interval = rank_correlation(np.stack([data[name].values for name in varied], axis=1), values)
    return sorted(zip(varied, correlation, interval, strict=True), key=lambda one: -abs(one[1]))


def _deciding(data: xr.Dataset, of: str) -> Panel | None:
    """Rank correlation of a response with each input."""
    ranked = _ranked(data, of)
    if not ranked:
        return None
    names = [data[name].attrs["long_name"] for name, _, _ in ranked]
    correlation, interval = np.array([one for _, one, _ in ranked]), np.stack([one for _, _, one in ranked])
    finding = findings.strongest(findings.words(data, of), names, correlation, interval)
    trace = {
        "type": "bar",
        "orientation": "h",
        "x": correlation,
        "y": names,
        "marker": {"color": COLOURS[0]},
        "error_x": {
            "type": "data",
            "symmetric": False,
            "color": "#808080",
            "array": interval[:, 1] - correlation,
            "arrayminus": correlation - interval[:, 0],
        },
        "showlegend": False,
    }
    pairs = ", ".join(f"{name} {value:.2f}" for name, value in zip(names, correlation, strict=True))
    return Panel(
        "deciding",
        finding,
        f"{finding}. Rank correlations: {pairs}.",
        [trace],
        {
            "xaxis": axis("rank correlation", range=[-1.05, 1.05]),
            "yaxis": {"automargin": True, "autorange": "reversed"},
        },
        note="Spearman's and its 95 % interval; 1 if the response always grows with the input.",
    )


def _spread(data: xr.Dataset, of: str) -> Panel | None:
    """How often which value comes."""
    values = data[of].values[np.isfinite(data[of].values)]
    if len(values) < ENOUGH:
        return None
    words, unit, finding = findings.words(data, of), data[of].attrs["units"], findings.middle(data, of)
    trace = {"type": "histogram", "x": values, "marker": {"color": COLOURS[0]}, "showlegend": False}
    return Panel(
        "spread",
        finding,
        f"{finding}. Number of cases over the {words}.",
        [trace],
        {"xaxis": axis(f"{words}, {unit}"), "yaxis": axis("cases"), "bargap": 0.04},
    )
