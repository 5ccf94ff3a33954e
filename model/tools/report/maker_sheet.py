"""The maker's sheet of a run: the formulas of the standards beside the results of the run."""

from typing import Any

from coilset.model.core.base.errors import InputError
from coilset.model.core.case import check
from coilset.model.core.results.files.opened import Run
from coilset.model.core.results.records.labels import plain
from coilset.model.tools.sheet import from_results
from coilset.model.tools.sheet.case_sheet import case_sheet
from coilset.model.tools.sheet.rows import Row, sections


def maker_sheet(run: Run) -> list[tuple[str, list[dict[str, Any]]]]:
    """Headings with their rows as texts; none of a spring that the standards have no formulas for."""
    try:
        case = check(run.case)
        sheet = case_sheet(case, case.spring.build(), from_results.read(run.folder))
    except InputError:  # no cylinder, or a file of the case that has gone
        return []
    return [(title, [_texts(row) for row in rows]) for title, rows in sections(sheet)]


def _texts(row: Row) -> dict[str, Any]:
    return {
        "label": row.label.strip(),
        "value": _number(row.value, row.unit),
        "found": _number(row.found, row.unit),
        "formula": row.formula,
        "sure": row.sure,
        "why": row.why if row.found is not None or row.value is None else "",
    }


def _number(value: float | None, unit: str) -> str:
    return "" if value is None else f"{plain(value, 5)} {unit}".strip().replace("-", "−")
