"""Conditions of a design: the number of a run that each concerns, where it is read, and its deviation."""

import copy
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from coilset.model.core.base.errors import InputError
from coilset.model.core.case.case import check
from coilset.model.core.case.material import case_elastic, case_law
from coilset.model.core.results.records.units import unit_of, words_and_unit
from coilset.model.physics.working.working import is_working_number, place_of
from coilset.model.tools.design.file import Conditions, DesignFile, Limits
from coilset.model.tools.limits.limits import case_limits

GROUP = "such_that."  # before the names of conditions
MEASURING_STEPS = 2  # equal steps to a height at which a force is measured, and back: the path is elastic, or nearly so


EQUALS, AT_MOST, AT_LEAST = 0, 1, -1
SENSES = {EQUALS: "", AT_MOST: "at most ", AT_LEAST: "at least "}
LIMITS = {"at_most": AT_MOST, "at_least": AT_LEAST}
SIZE_OF_ZERO = 100.0  # mm, N, MPa or degrees: deviations from a target of 0 are relative to it
ACTIVE = 1e-6  # relative distance from its limit up to which an inequality decides on the solution


def without_limit(name: str) -> str:
    """The name of a condition without that of its limit: the result that it concerns."""
    return name.removesuffix(".at_most").removesuffix(".at_least")


@dataclass(frozen=True)
class Condition:
    """One condition.

    Attributes:
        name: as in the file, with a number if it is one of several forces, and the limit if it is an inequality.
        target: the value, or the limit.
        height: at which a force is prescribed, mm; None for numbers of the summary.
        phase: of the load program, at whose end the force is read; None for numbers of the summary.
        sense: 0 of an equation, 1 of an upper limit, −1 of a lower one.
    """

    name: str
    target: float
    height: float | None = None
    phase: int | None = None
    sense: int = EQUALS

    @property
    def short_name(self) -> str:
        """Without the group and the limit; of a number of the summary, its name there."""
        return without_limit(self.name).removeprefix(GROUP).removeprefix("working.")

    @property
    def words(self) -> str:
        """The result, for progress and messages."""
        return words_and_unit(self.short_name)[0] if self.height is None else f"force at {self.height:g} mm"

    @property
    def wanted(self) -> str:
        """The target in words, such as `25 mm` or `at most 160 N`."""
        return f"{SENSES[self.sense]}{self.target:g} {self.unit}"

    @property
    def subject(self) -> str | float:
        """Identifies its value, whatever its target: a name of the summary, or the height of a force, mm."""
        return without_limit(self.name) if self.height is None else self.height

    @property
    def unit(self) -> str:
        """Of its value."""
        return unit_of(self.short_name) if self.height is None else "N"

    @property
    def size(self) -> float:
        """To which deviations are relative: the target's size, or SIZE_OF_ZERO."""
        return abs(self.target) or SIZE_OF_ZERO

    def off(self, value: float) -> float:
        """Deviation of a value from its target, relative to `size`."""
        return (value - self.target) / self.size

    def deviation(self, off: float) -> str:
        """A relative deviation in words: per cent of the target, or of 0 in its unit."""
        return f"{100.0 * abs(off):.2g} %" if self.target else f"{self.size * abs(off):.2g} {self.unit}"

    def missed(self, off: float) -> float:
        """The part of a relative deviation by which the condition is not met."""
        return off if self.sense == EQUALS else self.sense * max(self.sense * off, 0.0)

    def is_active(self, off: float) -> bool:
        """Whether it decides on a solution with this deviation; an equation always does."""
        return self.sense == EQUALS or self.sense * off >= -ACTIVE


def conditions(spec: DesignFile, base: Mapping[str, Any]) -> tuple[list[Condition], dict[str, Any]]:
    """The conditions of a design, and its case extended by the entries needed to evaluate them.

    Args:
        base: raw data of the case, checked.

    Returns:
        Conditions in the order of the file; raw data of the case, whose load program goes to all the heights.

    Raises:
        InputError: a condition needs a released spring, but the program does not release it.
    """
    data = copy.deepcopy(dict(base))
    program = data["loading"]
    found = [one for name, value in _results(spec.such_that) for one in _conditions(f"{GROUP}{name}", value)]
    numbers = spec.such_that.working
    found += [one for name, value in numbers.items() for one in _conditions(f"{GROUP}working.{name}", value)]
    _visit(data, numbers)
    missing = sorted({at.height for at in spec.such_that.force_at if _phase(program, at.height) is None}, reverse=True)
    released = _is_release(program[-1])
    found += _of_case(base, data, {one.subject for one in found})
    needing = [one.name for one in found if "after" in one.name or "set_mm" in one.name or "residual" in one.name]
    if not released and (needing or missing):
        name = needing[0] if needing else f"{GROUP}force_at"
        raise InputError(
            "needs an unloaded spring at the end; let the load program end with {to: {force: 0}}", without_limit(name)
        )
    for height in missing:
        program.append({"to": {"height": height}, "steps": MEASURING_STEPS})
    if missing:
        program.append({"to": {"force": 0}, "steps": MEASURING_STEPS})
    for number, at in enumerate(spec.such_that.force_at):
        name = f"{GROUP}force_at" + (f".{number}" if len(spec.such_that.force_at) > 1 else "")
        found += _conditions(name, at.N, at.height, _phase(program, at.height))
    if data.get("ends", "seats") == "seats":
        _refuse_tension(found)
    elif _only_pulls(base):
        _refuse_compression(found)
    return found, data


def _only_pulls(data: Mapping[str, Any]) -> bool:
    """Whether the spring of raw data has hooks, or is pulled by its whole load program."""
    if data["spring"].get("hooks"):
        return True
    targets = [phase["to"] for phase in data["loading"] if "to" in phase]
    values = [to.get("force", to.get("travel")) if isinstance(to, dict) else None for to in targets]
    numbers = [value for value in values if value is not None]
    return len(numbers) == len(targets) and min(numbers, default=0.0) < 0.0 and max(numbers) <= 0.0


def _refuse_compression(found: Iterable[Condition]) -> None:
    """Refuse forces above 0 of a spring that is pulled, which no search would meet."""
    for one in found:
        is_force = one.height is not None or one.short_name.startswith("force_at_") or one.short_name == "force_max_N"
        if is_force and one.target > 0.0:
            problem = f"is {one.target:g}; must be below 0 of a spring that is pulled, as its forces are negative"
            raise InputError(f"{problem}; give {-one.target:g}", one.name)


def _refuse_tension(found: Iterable[Condition]) -> None:
    """Refuse forces and sets below 0 of a spring between seats, which only press."""
    for one in found:
        is_of_press = one.height is not None or one.short_name in ("set_mm", "force_max_N")
        if is_of_press and one.target <= 0.0 and one.sense == EQUALS:
            raise InputError(f"is {one.target:g}; must be greater than 0 of a spring between seats", one.name)


def _of_case(base: Mapping[str, Any], data: dict[str, Any], given: set[str | float]) -> Iterator[Condition]:
    """The limits of the case, of results on which the file has no condition of its own; `data` as of `_visit`."""
    case = check(copy.deepcopy(dict(base)))
    if not case.limits:
        return
    spring = case.spring.build()
    shear_modulus = case_elastic(case, case_law(case, spring)).shear_modulus
    for (entry, limit), own in zip(case.limits.items(), case_limits(case, spring, shear_modulus), strict=True):
        place = f"limits.{entry}"
        if isinstance(limit, str):
            raise InputError(f"the middle of {limit} moves with the spring; give its nominal, or two numbers", place)
        if not is_working_number(own.name) and own.name not in Conditions.model_fields:
            raise InputError("a design has no condition on it; leave it out", place)
        if own.low == 0.0 or own.high == 0.0:
            raise InputError("must not be 0: conditions are met relative to their size", place)
        working = is_working_number(own.name)
        name = f"{GROUP}working.{own.name}" if working else f"{GROUP}{own.name}"
        if name not in given:
            _visit(data, [own.name] if working else [])
            yield from _conditions(name, Limits(at_least=own.low, at_most=own.high))


def _visit(data: dict[str, Any], names: Iterable[str]) -> None:
    """Let the case of these numbers of working states go there."""
    for name in names:
        kind, value = place_of(name)
        there = data.setdefault("working", {}) or {}
        values = there.setdefault("lengths" if kind == "length" else "forces", [])
        if value not in values:
            values.append(value)
        data["working"] = there


def _results(wanted: Conditions) -> list[tuple[str, float | Limits]]:
    return [(name, value) for name, value in wanted if isinstance(value, float | int | Limits)]


def _conditions(
    name: str, wanted: float | Limits, height: float | None = None, phase: int | None = None
) -> list[Condition]:
    """One equation, or an inequality for each limit."""
    if not isinstance(wanted, Limits):
        return [Condition(name, wanted, height, phase)]
    return [
        Condition(f"{name}.{limit}", value, height, phase, sense)
        for limit, sense in LIMITS.items()
        if (value := getattr(wanted, limit)) is not None
    ]


def _phase(program: Sequence[Mapping[str, Any]], height: float) -> int | None:
    """Number of the last phase that goes to a height, None if there is none."""
    there = [
        number
        for number, phase in enumerate(program)
        if isinstance(phase.get("to"), dict) and phase["to"].get("height") == height
    ]
    return there[-1] if there else None


def _is_release(phase: Mapping[str, Any]) -> bool:
    return isinstance(phase.get("to"), dict) and phase["to"].get("force") == 0
