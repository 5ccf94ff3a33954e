"""Limits of results: between which values they must be, and whether a run meets them."""

from collections.abc import Iterator, Mapping
from difflib import get_close_matches
from typing import Any

from coilset.meshes.springs.geometry import Spring
from coilset.model.core.base.errors import InputError
from coilset.model.core.base.warning import Warning
from coilset.model.core.case import Case
from coilset.model.core.results.records.record import Limit
from coilset.model.core.results.records.summary_entries import NUMBERS
from coilset.model.core.results.records.units import without_unit, words_and_unit
from coilset.model.physics.working.working import is_working_number, names_of, place_of
from coilset.model.tools.limits.limit_entries import GRADE, About, AnyLimit
from coilset.model.tools.standards import en13906, en15800
from coilset.model.tools.standards.cylinder import Cylinder

OTHERS = {"free_length": "free_length_after_mm", "rate": "rate_30_70_after_N_per_mm"}
"""Results by their names on a drawing, where it means the finished spring."""


def case_limits(case: Case, spring: Spring, shear_modulus: float) -> tuple[Limit, ...]:
    """The limits of a case, for its spring.

    Raises:
        InputError: a name that is no result of this case, or a tolerance that the standard does not have.
    """
    numbers = [*NUMBERS, *(names_of(case.working.model_dump()) if case.working else ())]
    found = []
    for name, limit in (case.limits or {}).items():
        place = f"limits.{name}"
        full = _full(name, numbers, place)
        low, high, source = _range(full, limit, spring, shear_modulus, place)
        found.append(Limit(full, low, high, source))
    return tuple(found)


def _full(name: str, numbers: list[str], place: str) -> str:
    """The name in the summary of a result that may lack its unit."""
    stems = {without_unit(one)[0]: one for one in numbers} | OTHERS
    full = name if name in numbers else stems.get(name)
    if full is None:
        near = get_close_matches(name, [*stems, *numbers], 1)
        hint = f"is {near[0]} meant?" if near else "lengths are named in working, as in working: {lengths: [37]}"
        raise InputError(f"is no number of this case's results; {hint}", place)
    return full


def _range(name: str, limit: AnyLimit, spring: Spring, shear_modulus: float, place: str) -> tuple[float, float, str]:
    if isinstance(limit, list):
        return limit[0], limit[1], "given"
    if isinstance(limit, About) and not isinstance(limit.tolerance, str):
        return limit.nominal - limit.tolerance, limit.nominal + limit.tolerance, "given"
    text = limit if isinstance(limit, str) else str(limit.tolerance)
    grade = en15800_grade(text)
    cylinder = Cylinder.of(spring)
    d, D, n, length = cylinder.d, cylinder.D, cylinder.n, cylinder.length
    is_force = is_working_number(name) and name.startswith("force_at_")
    if not is_force and name != "free_length_after_mm":
        raise InputError("EN 15800 has tolerances of free_length and of force_at_…; give two numbers", place)
    reason = en15800.outside(d, D, n, length)
    if reason:
        raise InputError(f"EN 15800 does not cover this spring: {reason}; give two numbers", place)
    if isinstance(limit, About):
        nominal, source = limit.nominal, text
    elif is_force:
        nominal, source = (
            en13906.rate(shear_modulus, d, D, n) * (length - place_of(name)[1]),
            f"{text}, about R (L0 − L)",
        )
    else:
        nominal, source = length, f"{text}, about the drawn length"
    spread = (
        en15800.force_tolerance(grade, d, D, n, nominal)
        if is_force
        else en15800.tolerances(grade, shear_modulus, d, D, n, length).free_length
    )
    return nominal - spread, nominal + spread, source


def en15800_grade(text: str) -> en15800.Grade:
    """The grade in `EN 15800 grade 2`."""
    found = GRADE.fullmatch(text)
    assert found is not None
    return en15800.GRADES[int(found[1])]


def judged(limits: tuple[Limit, ...], summary: Mapping[str, Any]) -> tuple[dict[str, Any], ...]:
    """Entries of summary.json, one for each limit: the value, whether it is met, and by how much."""
    found = []
    for limit in limits:
        value = summary.get(limit.name)
        entry = {"name": limit.name, "value": value, "low": limit.low, "high": limit.high, "source": limit.source}
        margin = None if value is None else limit.margin(value)
        found.append(entry | {"met": margin is not None and margin >= 0.0, "margin": margin})
    return tuple(found)


def limit_warnings(entries: tuple[dict[str, Any], ...]) -> Iterator[Warning]:
    """Limits that are not met."""
    for entry in entries:
        if entry["met"]:
            continue
        words, unit = words_and_unit(entry["name"])
        bounds = f"{entry['low']:.6g} to {entry['high']:.6g} {unit} ({entry['source']})"
        value = entry["value"]
        if value is None:
            yield Warning("limit", entry["name"], f"the {words} must be {bounds}, but this run has none")
            continue
        off = f"outside by {-entry['margin']:.4g} {unit}"
        message = f"the {words} is {value:.6g} {unit}, {off}; it must be {bounds}"
        beyond = entry["low"] if value < entry["low"] else entry["high"]
        yield Warning("limit", entry["name"], message, value, beyond, unit)
