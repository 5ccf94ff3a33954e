"""What a step changes: named arrays at the last equilibrium and as trial values, and the only transitions between them.

Body, contacts, seats and solver register their arrays here; a checkpoint needs no more than these.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import Enum

import numpy as np


class Where(Enum):
    """What the first axis of an array counts, which determines how ranks share the array."""

    STATION = "stations of the line"
    ELEMENT = "elements of the line"
    CELL = "cells of a solid"
    UNKNOWN = "unknowns of the system"
    SHARED = "the same on every rank"


@dataclass(frozen=True)
class Field:
    """An array of the state.

    Attributes:
        trial: written by evaluations; always the same array object, so that others may hold a reference.
        equilibrium: its values when the last equilibrium was committed, in the same shape; the same array as `trial`
            where it is kept once.
        where: what the first axis counts.
    """

    trial: np.ndarray
    equilibrium: np.ndarray
    where: Where


class State:
    """Named fields, committed and restored together, so that a failed step leaves no trace."""

    def __init__(self) -> None:
        self._fields: dict[str, Field] = {}
        self._before: dict[str, np.ndarray] = {}
        self._overwritten: set[str] = set()

    def add(self, name: str, trial: np.ndarray, where: Where, in_place: bool = False) -> Field:
        """Register an array: it becomes the field's trial array itself, and a copy of it the equilibrium.

        Args:
            name: of the field.
            trial: the array.
            where: what its first axis counts.
            in_place: whether it is written only when a step ends, so that it needs no copy; `overwrite` comes before
                where the step may yet be given up.

        Raises:
            ValueError: if the name is taken.
        """
        if name in self._fields:
            raise ValueError(f"the state has a field '{name}' already")
        self._fields[name] = field = Field(trial, trial if in_place else trial.copy(), where)
        return field

    def include(self, prefix: str, part: "State") -> None:
        """Include the fields of a part, their names preceded by `prefix`; the part keeps them too."""
        for name, field in part.items():
            self._fields[f"{prefix}{name}"] = field

    def __getitem__(self, name: str) -> Field:
        return self._fields[name]

    def __contains__(self, name: str) -> bool:
        return name in self._fields

    def items(self) -> Iterator[tuple[str, Field]]:
        """Names and fields in order of registration."""
        return iter(self._fields.items())

    def overwrite(self, name: str) -> None:
        """Keep what a field in place holds: until the next `commit`, `restore` brings it back."""
        values = self._fields[name].equilibrium
        np.copyto(self._before.setdefault(name, np.empty_like(values)), values)
        self._overwritten.add(name)

    def commit(self) -> None:
        """Make the trial arrays the new equilibrium."""
        self._overwritten.clear()
        for field in self._fields.values():
            if field.trial is not field.equilibrium:
                np.copyto(field.equilibrium, field.trial)

    def restore(self) -> None:
        """Reset the trial arrays to the last equilibrium."""
        for name in self._overwritten:
            np.copyto(self._fields[name].equilibrium, self._before[name])
        self._overwritten.clear()
        for field in self._fields.values():
            if field.trial is not field.equilibrium:
                np.copyto(field.trial, field.equilibrium)

    def copy(self) -> dict[str, np.ndarray]:
        """A copy of the last equilibrium, to be restored later."""
        return {name: field.equilibrium.copy() for name, field in self._fields.items()}

    def put_back(self, arrays: Mapping[str, np.ndarray]) -> None:
        """Make the result of `copy` the last equilibrium again; the trial arrays are unchanged until `restore`."""
        for name, field in self._fields.items():
            np.copyto(field.equilibrium, arrays[name])
