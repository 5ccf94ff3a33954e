"""Conditions of a wish: the number of a run that each concerns, where it is read, and its deviation."""

import copy
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from coilset.model.base.errors import InputError
from coilset.model.design.wish import Conditions, WishSpec
from coilset.model.results.records.units import unit_of

GROUP = "such_that."  # before the names of a wish's conditions
MEASURING_STEPS = 2  # equal steps to a height at which a force is measured, and back: the path is elastic, or nearly so


@dataclass(frozen=True)
class Condition:
    """One condition.

    Attributes:
        name: as in the wish, with a number if it is one of several forces.
        wish: the target value.
        height: at which a force is prescribed, mm; None for numbers of the summary.
        phase: of the load program, at whose end the force is read; None for numbers of the summary.
    """

    name: str
    wish: float
    height: float | None = None
    phase: int | None = None

    @property
    def short_name(self) -> str:
        """Without the group of the wish; of a number of the summary, its name there."""
        return self.name.removeprefix(GROUP)

    @property
    def words(self) -> str:
        """For progress and messages."""
        return self.short_name if self.height is None else f"force at {self.height:g} mm"

    @property
    def asks(self) -> str | float:
        """What its value is, whatever is wished of it: a name of the summary, or the height of a force, mm."""
        return self.name if self.height is None else self.height

    @property
    def unit(self) -> str:
        """Of its value."""
        return unit_of(self.name) if self.height is None else "N"

    def off(self, value: float) -> float:
        """Deviation of a value from its target, relative to the target."""
        return (value - self.wish) / abs(self.wish)


def conditions(spec: WishSpec, base: Mapping[str, Any]) -> tuple[list[Condition], dict[str, Any]]:
    """The conditions of a wish, and its case extended by what is needed to evaluate them.

    Args:
        spec: WishSpec.
        base: raw data of the case, checked.

    Returns:
        Conditions in the order of the wish; raw data of the case, whose load program goes to all the heights.

    Raises:
        InputError: a condition needs a released spring, but the program does not release it.
    """
    data = copy.deepcopy(dict(base))
    program = data["loading"]
    if isinstance(program, dict):  # {accuracy: …, program: […]}
        program = program["program"]
    found = [Condition(f"{GROUP}{name}", value) for name, value in _numbers(spec.such_that)]
    missing = sorted({at.height for at in spec.such_that.force_at if _phase(program, at.height) is None}, reverse=True)
    released = _is_release(program[-1])
    needing = [one.name for one in found if "after" in one.name or "set_mm" in one.name or "residual" in one.name]
    if not released and (needing or missing):
        name = needing[0] if needing else f"{GROUP}force_at"
        raise InputError("needs an unloaded spring at the end; let the load program end with {to: {force: 0}}", name)
    for height in missing:
        program.append({"to": {"height": height}, "steps": MEASURING_STEPS})
    if missing:
        program.append({"to": {"force": 0}, "steps": MEASURING_STEPS})
    for number, at in enumerate(spec.such_that.force_at):
        name = f"{GROUP}force_at" + (f".{number}" if len(spec.such_that.force_at) > 1 else "")
        found.append(Condition(name, at.N, at.height, _phase(program, at.height)))
    return found, data


def _numbers(wished: Conditions) -> list[tuple[str, float]]:
    return [(name, value) for name, value in wished if isinstance(value, float | int)]


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
