"""Checks of two springs, one inside the other: those of each, and the room between them."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from coilset.meshes.springs.geometry import Spring
from coilset.model.core.base.errors import InputError
from coilset.model.core.case import Case
from coilset.model.tools.checks.check import Check
from coilset.model.tools.checks.permissible import COMPUTED
from coilset.model.tools.checks.table import checks
from coilset.model.tools.sheet.case_sheet import case_sheet
from coilset.model.tools.sheet.from_results import Found


def nested(summary: Mapping[str, Any], springs: Mapping[str, tuple[Case, Spring, Found]]) -> list[Check]:
    """All checks of a nest.

    Args:
        summary: of the nest.
        springs: by their names, those that the seats reached.
    """
    source = f"between the springs, at a height of {summary['clearance_min_height_mm']:.4g} mm"
    found = [
        Check("clearance", summary["clearance_min_mm"], low=0.0, unit="mm", source=source, sure=COMPUTED),
    ]
    for name, (case, spring, run) in springs.items():
        found += [replace(one, name=f"{name}: {one.name}") for one in _own(case, spring, run)]
    return found


def _own(case: Case, spring: Spring, run: Found) -> list[Check]:
    """Of one spring: heights of the common seats are steps on the way, and no lengths at which it works."""
    try:
        made = case_sheet(case, spring, run)
    except InputError:  # no cylinder of one wire
        return checks(case, spring, run)
    return checks(case, spring, run, made if case.working else replace(made, lengths=()))
