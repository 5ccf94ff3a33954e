"""Names of the entries of a case in words, with their units: the same on pages, in the terminal and in figures."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from coilset.model.core.case.case import Case
from coilset.model.core.case.reference import entry_unit


@dataclass(frozen=True)
class EntryName:
    """An entry in words.

    Attributes:
        words: such as `wire diameter`, `pitch at turn 3.5` or `height of phase 1`.
        unit: of its number; empty where it has none.
    """

    words: str
    unit: str

    @property
    def head(self) -> str:
        """Words and unit, for the head of a column or an axis."""
        return self.words + (f", {self.unit}" if self.unit else "")


def entry_name(entry: str, case: Mapping[str, Any] | None = None) -> EntryName:
    """The name of an entry.

    Args:
        entry: its path, such as `spring.pitch.values.2`.
        case: raw data of the case, which gives the turns of a table; without it their number in the table is named.
    """
    first, *rest = entry.split(".")
    return EntryName(_words(first, rest, case or {}).replace("_", " "), entry_unit(Case, entry))


def _words(first: str, rest: list[str], case: Mapping[str, Any]) -> str:
    if first == "loading" and len(rest) > 1 and rest[0].isdigit():
        return f"{rest[-1]} of phase {int(rest[0]) + 1}"
    if len(rest) > 1 and rest[-1].isdigit():  # of a list, as a table's
        quantity, number = rest[:-1], int(rest[-1])
        if quantity[-1] != "values":
            return f"{', '.join(quantity)}, number {number + 1}"
        turn = _turn(case, [first, *quantity[:-1]], number)
        return f"{', '.join(quantity[:-1])} " + (f"at turn {turn:g}" if turn is not None else f"at point {number + 1}")
    if first == "spring" and len(rest) > 1:  # of a shape or an end, whose last name alone is not enough
        return ", ".join(rest)
    if rest and rest[-1].isdigit():
        return f"{first}, number {int(rest[-1]) + 1}"
    return (rest or [first])[-1]


def _turn(case: Mapping[str, Any], path: list[str], number: int) -> float | None:
    """The turn of a point of a table; None if the case has no such table."""
    table: Any = case
    for name in path:
        table = table.get(name) if isinstance(table, Mapping) else None
    turns = table.get("turns") if isinstance(table, Mapping) else None
    return turns[number] if isinstance(turns, list | tuple) and number < len(turns) else None
