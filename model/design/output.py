"""Files of a search: found.yaml, design.json and trade_offs.csv."""

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import yaml

from coilset.model.design.conditions import Condition
from coilset.model.design.search import TOLERANCE, Found, Search
from coilset.model.design.trade_offs import TradeOff
from coilset.model.design.wish import Wish
from coilset.model.results.files.folder import whole, write_table
from coilset.model.results.records.provenance import origin

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


def found_data(search: Search, found: Found) -> dict[str, Any]:
    """Raw data of the case found; `coilset solve` accepts it as a file."""
    return search.evaluator.data(found.x, search.plan)


def report(wish: Wish, search: Search, found: Found, rows: Sequence[TradeOff], seconds: float) -> dict[str, Any]:
    """The content of design.json, as plain data."""
    case = wish.check(found_data(search, found))
    values = zip(search.conditions, found.best.values.tolist(), found.off.tolist(), strict=True)
    return {
        "met": found.met,
        "found": dict(zip(search.evaluator.names, found.x.tolist(), strict=True)),
        "conditions": [condition(one, value, off) for one, value, off in values],
        "method": "equations" if len(search.conditions) == len(found.x) else "least squares",
        "tolerance": TOLERANCE,
        "slopes": {
            one.name: dict(zip(search.evaluator.names, row, strict=True))
            for one, row in zip(search.conditions, _slopes(search, found), strict=True)
        },
        "evaluations": search.evaluator.count,
        "seconds": seconds,
        "warnings": found.best.summary["warnings"],
        "trade_offs": [asdict(row) | {"possible": row.possible} for row in rows],
        "summary": dict(found.best.summary),
        "wish": wish.spec.model_dump(mode="json", by_alias=True, exclude_defaults=True),
        "origin": origin(case),
    }


def condition(one: Condition, value: float, off: float) -> dict[str, Any]:
    """A condition and its deviation; `residual` is relative to the target."""
    return {
        "name": one.name,
        "height_mm": one.height,
        "wish": one.wish,
        "unit": one.unit,
        "value": value,
        "residual": off,
        "met": abs(off) <= TOLERANCE,
    }


def write(folder: Path, wish: Wish, search: Search, found: Found, rows: Sequence[TradeOff], seconds: float) -> None:
    """Write all files; design.json last.

    Raises:
        CoilsetError: if one cannot be written.
    """
    words = ", ".join(f"{name} = {value:.9g}" for name, value in zip(search.evaluator.names, found.x, strict=True))
    with whole(folder / "found.yaml") as path:
        data = yaml.safe_dump(
            found_data(search, found), sort_keys=False, allow_unicode=True, default_flow_style=None, width=120
        )
        path.write_text(HEAD.format(file=wish.file.name, found=words) + data, encoding="utf-8")
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
        content = report(wish, search, found, rows, seconds)
        path.write_text(json.dumps(content, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")


def _slopes(search: Search, found: Found) -> list[list[float]]:
    """Change of each condition's value with each unknown, in their units."""
    scale = [abs(one.wish) for one in search.conditions]
    return [
        [slope * size / width for slope, width in zip(row, search.width, strict=True)]
        for row, size in zip(found.slopes.tolist(), scale, strict=True)
    ]
