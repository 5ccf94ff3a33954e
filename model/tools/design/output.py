"""Files of a search: found.yaml, design.json and trade_offs.csv."""

import copy
import json
import os
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import yaml

from coilset.model.core.results.files.folder import whole, write_table
from coilset.model.core.results.records.provenance import origin
from coilset.model.tools.design.choices import Options
from coilset.model.tools.design.conditions import LIMITS, Condition
from coilset.model.tools.design.design import Solution
from coilset.model.tools.design.file import Design
from coilset.model.tools.design.search import TOLERANCE, Found, Search
from coilset.model.tools.design.trade_offs import TradeOff

FILES = (
    "design.json",
    "found.yaml",
    "trade_offs.csv",
    "evaluations.jsonl",
    "report.html",
)  # the first shows that all are complete
HEAD = (
    "# Found by coilset design from {file}: {found}.\n# Its steps are recorded, so that it reproduces these numbers.\n"
)


def found_data(found: Found) -> dict[str, Any]:
    """Raw data of the case found; `coilset solve` accepts it as a file."""
    return found.search.evaluator.data(found.x, found.search.plan)


def with_files(data: dict[str, Any], folder: Path) -> dict[str, Any]:
    """The case with copies, in the folder, of the files that it names by absolute paths, so that it runs elsewhere.

    Raises:
        CoilsetError: if one cannot be copied.
    """
    data = copy.deepcopy(data)
    for place, entry in ((data, "material"), (data.get("spring", {}), "file")):
        named = place.get(entry)
        if isinstance(named, str) and os.path.isabs(named):
            source = Path(named)
            with whole(folder / source.name) as path:
                path.write_bytes(source.read_bytes())
            place[entry] = source.name
    return data


def report(design: Design, solution: Solution, rows: Sequence[TradeOff], seconds: float) -> dict[str, Any]:
    """The content of design.json, as plain data."""
    found, search = solution.found, solution.found.search
    case = design.check(found_data(found))
    values = zip(search.conditions, found.best.values.tolist(), found.off.tolist(), strict=True)
    return {
        "met": found.met,
        "found": dict(zip(search.evaluator.names, found.x.tolist(), strict=True)),
        "unknowns": {name: unknown(design, name) for name in search.evaluator.names},
        "conditions": [condition(one, value, off) for one, value, off in values],
        "method": method(search),
        "is_one_of_many": found.is_one_of_many,
        "tolerance": TOLERANCE,
        "slopes": {
            one.name: dict(zip(search.names, row, strict=True))
            for one, row in zip(search.conditions, _slopes(search, found), strict=True)
        },
        "evaluations": search.evaluator.count,
        "seconds": seconds,
        "choices": None if solution.options is None else choices(solution.options),
        "warnings": found.best.summary["warnings"],
        "trade_offs": [asdict(row) | {"possible": row.possible} for row in rows],
        "summary": dict(found.best.summary),
        "file": design.spec.model_dump(mode="json", by_alias=True, exclude_defaults=True),
        "origin": origin(case),
    }


def condition(one: Condition, value: float, off: float) -> dict[str, Any]:
    """A condition and its deviation; `residual` is relative to the target, or to SIZE_OF_ZERO."""
    limit = next((name for name, sense in LIMITS.items() if sense == one.sense), "equals")
    return {
        "name": one.name,
        "words": one.words,
        "height_mm": one.height,
        "kind": limit,
        "target": one.target,
        "unit": one.unit,
        "value": value,
        "residual": off,
        "met": abs(one.missed(off)) <= TOLERANCE,
        "active": one.is_active(off),
    }


def unknown(design: Design, name: str) -> dict[str, Any]:
    """An unknown in words, and the entries that it drives."""
    one = design.spec.find[name]
    named = one.named(name, design.base)
    return {"words": named.words, "unit": named.unit, "entries": one.driven(name), "low": one.low, "high": one.high}


def method(search: Search) -> str:
    """How the conditions determine the solution."""
    if search.is_open:
        return "nearest to the case"
    return "equations" if search.is_square else "least squares"


def choices(options: Options) -> dict[str, Any]:
    """The combinations that were evaluated, and how many there are."""
    return {
        "total": options.total,
        "tried": [
            {"chosen": dict(one.chosen), "is_best": one is options.best, "reason": one.reason}
            | (
                {"found": None, "values": None, "off": None, "met": False}
                if one.found is None
                else {
                    "found": dict(zip(one.found.search.evaluator.names, one.found.x.tolist(), strict=True)),
                    "values": one.found.best.values.tolist(),
                    "off": one.off,
                    "met": one.found.met,
                }
            )
            for one in options.tried
        ],
    }


def write(folder: Path, design: Design, solution: Solution, rows: Sequence[TradeOff], seconds: float) -> None:
    """Write all files; design.json last.

    Raises:
        CoilsetError: if one cannot be written.
    """
    found, search = solution.found, solution.found.search
    words = ", ".join(f"{name} = {value:.9g}" for name, value in zip(search.evaluator.names, found.x, strict=True))
    with whole(folder / "found.yaml") as path:
        case = with_files(found_data(found), folder)
        data = yaml.safe_dump(case, sort_keys=False, allow_unicode=True, default_flow_style=None, width=120)
        path.write_text(HEAD.format(file=design.file.name, found=words) + data, encoding="utf-8")
    names, rest = search.evaluator.names, ("off", "possible", "wire_length_mm", "free_length_before_mm", "torque")
    write_table(
        folder / "trade_offs.csv",
        ["of", "value", *names, *rest],
        (
            [row.of, row.value, *(row.unknowns[name] for name in names), *(getattr(row, name) for name in rest)]
            for row in rows
        ),
    )
    with whole(folder / "design.json") as path:
        content = report(design, solution, rows, seconds)
        path.write_text(json.dumps(content, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")


def _slopes(search: Search, found: Found) -> list[list[float]]:
    """Change of each condition's value with each unknown, in their units."""
    scale = [one.size for one in search.conditions]
    return [
        [slope * size / width for slope, width in zip(row, search.width, strict=True)]
        for row, size in zip(found.slopes.tolist(), scale, strict=True)
    ]
