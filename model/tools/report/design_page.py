"""The page of a design: what to wind, how well it meets the conditions, and what else could be had."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from coilset.model.core.base.errors import InputError, reading
from coilset.model.core.case.names import EntryName, entry_name
from coilset.model.core.results.files.opened import Run, open_run
from coilset.model.core.results.records.labels import plain
from coilset.model.tools.design.conditions import GROUP, LIMITS, SENSES, Condition
from coilset.model.tools.design.opened import FILE, read_design
from coilset.model.tools.figures.panels.characteristic import characteristic
from coilset.model.tools.figures.panels.panel import Panel, axis, curve
from coilset.model.tools.figures.panels.spring_view import spring_view
from coilset.model.tools.report.answer import Number, answer
from coilset.model.tools.report.render import write_page
from coilset.model.tools.report.run_page import made_with

LEAST_OFF = 1e-12  # relative, to which the figure goes down
FOUND = "found"  # the folder of the results of found.yaml, beside it
FINER = ("mesh", "contact", "accuracy")  # entries of a case that a finer run of it has otherwise


def write_design_report(folder: str | Path) -> Path:
    """Write report.html into the folder of a finished design.

    Its folder `found`, if it holds the results of found.yaml, gives the characteristic and the spring in 3D.

    Returns:
        The file.

    Raises:
        InputError: if a file cannot be read. CoilsetError: if the page cannot be written.
    """
    folder = Path(folder)
    design, records = read_design(folder)
    with reading(folder / FILE):
        case = (folder / "found.yaml").read_text(encoding="utf-8")
        design["summary"]["set_mm"], design["origin"]["case"], design["trade_offs"], design["choices"]
        design["is_one_of_many"]
        names = [EntryName(one["words"], one["unit"]) for one in design["unknowns"].values()]
        sought = [
            EntryName(design["unknowns"][name]["words"], design["unknowns"][name]["unit"])
            for name in next(iter(design["slopes"].values()))
        ]
    found = [
        Number(name.words, f"{plain(value, 6)} {name.unit}".strip())
        for name, value in zip(names, design["found"].values(), strict=True)
    ]
    targets = " and ".join(f"{one['words']} {_of_file(one).wanted}" for one in design["conditions"])
    run = found_run(folder, design)
    drawn = [] if run is None else [("The spring that was found", [characteristic(run), spring_view(run)])]
    return write_page(
        folder,
        "design",
        [*drawn, ("The search", [search(design, records)])],
        {},
        title=f"{folder.resolve().name}: {', '.join(f'{one.term} {one.value}' for one in found)}",
        subtitle=f"{', '.join(name.words for name in names)} for {targets}",
        design=design,
        found=found,
        is_drawn=run is not None,
        conditions=[_condition(one) for one in design["conditions"]],
        answer=answer(design["summary"]),
        unknowns=[name.head for name in names],
        sought=[name.head for name in sought],
        slopes=_slopes(design),
        choices=_choices(design),
        trade_offs=[_trade_off(row, design) for row in design["trade_offs"]],
        case=case,
        made_with=made_with(design["origin"]),
    )


def found_run(folder: Path, design: Mapping[str, Any]) -> Run | None:
    """The results of the case that was found, in the design's folder; None without them, or if they are of another."""
    try:
        run = open_run(folder / FOUND)
        run.require_steps()
    except InputError:
        return None
    cases = ({name: case[name] for name in case if name not in FINER} for case in (run.case, design["origin"]["case"]))
    return run if next(cases) == next(cases) else None


def search(design: Mapping[str, Any], records: Sequence[Mapping[str, Any]]) -> Panel:
    """How far each evaluation was from the conditions."""
    numbers = np.arange(1, len(records) + 1)
    traces = []
    for place, one in enumerate(design["conditions"]):
        off = [_off(record["values"][place : place + 1], _of_file(one)) for record in records]
        traces.append(curve(numbers, np.array(off), place, marker=7, name=_named(one)))
    ended = "met all conditions" if design["met"] else "came as near as the bounds allow"
    finding = f"The search {ended} after {design['evaluations']} evaluations"
    return Panel(
        "search",
        finding,
        f"{finding}. Relative deviation of each condition from its target, over the evaluations.",
        traces,
        {
            "xaxis": axis("evaluation", dtick=1 if len(records) < 16 else None),
            "yaxis": axis("deviation, relative", type="log", exponentformat="power"),
        },
    )


def _of_file(one: Mapping[str, Any]) -> Condition:
    return Condition(one["name"], one["target"], one["height_mm"], sense=LIMITS.get(one["kind"], 0))


def _off(values: list[float | None], condition: Condition) -> float:
    """The relative deviation by which a condition is missed; NaN of a run that failed."""
    if not values or values[0] is None:
        return float("nan")
    return max(abs(condition.missed(condition.off(values[0]))), LEAST_OFF)


def _named(one: Mapping[str, Any]) -> str:
    """The result, and the limit if there is one."""
    return f"{one['words']}, {SENSES[_of_file(one).sense]}".rstrip(", ")


def _condition(one: Mapping[str, Any]) -> dict[str, Any]:
    wanted, inside = _of_file(one), one["met"] and not one["active"]
    off = _percent(one["residual"]) if one["target"] else f"{plain(abs(one['value']), 2)} {one['unit']}"
    return {
        "words": one["words"],
        "target": wanted.wanted,
        "value": f"{plain(one['value'], 7)} {one['unit']}",
        "off": off + (" inside the limit" if inside else ""),
        "met": "yes, not active" if inside else ("yes" if one["met"] else "no") + (", active" if wanted.sense else ""),
    }


def _percent(part: float) -> str:
    percent = 100.0 * abs(part)
    return f"{plain(percent, 2)} %" if percent >= 1e-3 else "below 0.001 %"


def _slopes(design: Mapping[str, Any]) -> list[tuple[str, list[str]]]:
    """Each condition, and its change with each unknown."""
    rows = ((f"{_named(one)}, {one['unit']}", design["slopes"][one["name"]]) for one in design["conditions"])
    return [(words, [plain(value).replace("-", "−") for value in row.values()]) for words, row in rows]


def _choices(design: Mapping[str, Any]) -> dict[str, Any] | None:
    """The combinations of values that were evaluated; None without choices."""
    choices = design["choices"]
    if choices is None:
        return None
    tried, units = choices["tried"], [one["unit"] for one in design["conditions"]]
    unknowns = design["unknowns"]
    others = [name for name in unknowns if name not in tried[0]["chosen"]]
    among = (
        f"All {len(tried)} combinations"
        if len(tried) == choices["total"]
        else f"The {len(tried)} of {choices['total']} combinations next to the solution with any value: the best of "
        "these need not be the best of all"
    )
    rows = []
    for one in tried:
        numbers = [*one["chosen"].values(), *((one["found"] or {}).get(name) for name in others)]
        values = one["values"] or [None] * len(units)
        off = "yes" if one["met"] else one["reason"] or f"no, off by {100.0 * one['off']:.2g} %"
        cells = ["–" if value is None else plain(value, 6) for value in (*numbers, *values)]
        rows.append({"cells": cells, "met": off, "is_best": one["is_best"]})
    heads = [EntryName(unknowns[name]["words"], unknowns[name]["unit"]).head for name in (*tried[0]["chosen"], *others)]
    return {
        "about": among,
        "rows": rows,
        "heads": [*heads, *(f"{_named(one)}, {one['unit']}" for one in design["conditions"])],
    }


def _trade_off(row: Mapping[str, Any], design: Mapping[str, Any]) -> dict[str, Any]:
    numbers = [*row["unknowns"].values(), row["wire_length_mm"], row["free_length_before_mm"], row["torque"]]
    return {
        "of": _other(row, design),
        "numbers": ["–" if number is None else plain(number, 5) for number in numbers],
        "possible": row["possible"],
    }


def _other(row: Mapping[str, Any], design: Mapping[str, Any]) -> str:
    """What differs: a condition with another target, or an entry of the case with another value."""
    if row["of"].startswith(GROUP):
        one = next(one for one in design["conditions"] if one["name"] == row["of"])
        return f"{one['words']} {replace(_of_file(one), target=row['value']).wanted}"
    name = entry_name(row["of"], design["origin"]["case"])
    value = plain(row["value"], 6) if isinstance(row["value"], float) else str(row["value"])
    return f"{name.words} {value} {name.unit}".strip()
