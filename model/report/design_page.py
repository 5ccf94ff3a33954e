"""The page of a design: what to wind, how well it meets the wish, and what else could be had."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from coilset.model.base.errors import reading
from coilset.model.case import Case
from coilset.model.case.reference import entry_unit, entry_words
from coilset.model.design.conditions import GROUP
from coilset.model.design.opened import FILE, read_design
from coilset.model.report.answer import Number, answer
from coilset.model.report.page import made_with
from coilset.model.report.panel import Panel, axis, curve
from coilset.model.report.render import write_page
from coilset.model.results.records.labels import plain
from coilset.model.sweep.dataset import quantity

LEAST_OFF = 1e-12  # relative, to which the figure goes down


def write_design_report(folder: str | Path) -> Path:
    """Write report.html into the folder of a finished design.

    Returns:
        The file.

    Raises:
        InputError: if a file cannot be read. CoilsetError: if the page cannot be written.
    """
    folder = Path(folder)
    design, records = read_design(folder)
    with reading(folder / FILE):
        case = (folder / "found.yaml").read_text(encoding="utf-8")
        design["summary"]["set_mm"], design["origin"]["case"], design["trade_offs"]
    names = list(design["found"])
    found = [
        Number(entry_words(name), f"{plain(value, 6)} {_unit(name)}".strip()) for name, value in design["found"].items()
    ]
    return write_page(
        folder,
        "design",
        [("The search", [search(design, records)])],
        {},
        title=f"{folder.resolve().name}: {', '.join(f'{one.term} {one.value}' for one in found)}",
        subtitle=f"{', '.join(entry_words(name) for name in names)} for {_wish(design)}",
        design=design,
        found=found,
        conditions=[_condition(one) for one in design["conditions"]],
        answer=answer(design["summary"]),
        unknowns=[_head(name) for name in names],
        slopes=_slopes(design, names),
        trade_offs=[_trade_off(row, names) for row in design["trade_offs"]],
        case=case,
        made_with=made_with(design["origin"]),
    )


def search(design: Mapping[str, Any], records: Sequence[Mapping[str, Any]]) -> Panel:
    """How far each evaluation was from the conditions."""
    wishes = [one["wish"] for one in design["conditions"]]
    numbers = np.arange(1, len(records) + 1)
    traces = []
    for place, (one, wish) in enumerate(zip(design["conditions"], wishes, strict=True)):
        off = [_off(record["values"][place : place + 1], wish) for record in records]
        traces.append(curve(numbers, np.array(off), place, marker=7, name=_named(one)))
    ended = "met all conditions" if design["met"] else "came as near as the bounds allow"
    finding = f"The search {ended} after {design['evaluations']} evaluations"
    return Panel(
        "search",
        finding,
        f"{finding}. Distance of each condition from its wish, relative, over the evaluations.",
        traces,
        {
            "xaxis": axis("evaluation", dtick=1 if len(records) < 16 else None),
            "yaxis": axis("off by, relative", type="log", exponentformat="power"),
        },
    )


def _off(values: list[float | None], wish: float) -> float:
    """Relative distance; NaN of a run that failed."""
    if not values or values[0] is None:
        return float("nan")
    return max(abs(values[0] - wish) / abs(wish), LEAST_OFF)


def _unit(name: str) -> str:
    return entry_unit(Case, name)


def _head(name: str) -> str:
    unit = _unit(name)
    return entry_words(name) + (f", {unit}" if unit else "")


def _named(condition: Mapping[str, Any]) -> str:
    if condition["height_mm"] is not None:
        return f"force at {condition['height_mm']:g} mm"
    return quantity(condition["name"].removeprefix(GROUP))[0]


def _wish(design: Mapping[str, Any]) -> str:
    return " and ".join(f"{_named(one)} {one['wish']:g} {one['unit']}" for one in design["conditions"])


def _condition(one: Mapping[str, Any]) -> dict[str, Any]:
    return {
        "words": _named(one),
        "wish": f"{one['wish']:g} {one['unit']}",
        "value": f"{plain(one['value'], 7)} {one['unit']}",
        "off": f"{100.0 * abs(one['residual']):.1g} %",
        "met": one["met"],
    }


def _slopes(design: Mapping[str, Any], names: list[str]) -> list[tuple[str, list[str]]]:
    """Each condition, and its change with each unknown."""
    rows = ((f"{_named(one)}, {one['unit']}", design["slopes"][one["name"]]) for one in design["conditions"])
    return [(words, [plain(row[name]).replace("-", "−") for name in names]) for words, row in rows]


def _of(name: str) -> str:
    """What is other than in the wish: an entry of the case, or a condition."""
    return entry_words(name) if "." in name else quantity(name)[0]


def _trade_off(row: Mapping[str, Any], names: list[str]) -> dict[str, Any]:
    force = "N" if row["of"].startswith("force at ") else ""
    value = plain(row["value"], 6) if isinstance(row["value"], float) else str(row["value"])
    numbers = [
        *(row["unknowns"][name] for name in names),
        row["wire_length_mm"],
        row["free_length_before_mm"],
        row["torque"],
    ]
    return {
        "of": f"{_of(row['of'])} {value} {_unit(row['of']) or quantity(row['of'])[1] or force}".strip(),
        "numbers": ["–" if number is None else plain(number, 5) for number in numbers],
        "possible": row["possible"],
    }
