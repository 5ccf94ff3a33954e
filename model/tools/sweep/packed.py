"""Inputs and keys of very many cases in little memory: a number takes 8 bytes, a key 25, no Python object."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np

from coilset.model.tools.sweep.keys import KEY_LENGTH
from coilset.model.tools.sweep.spec import are_numbers

Row = tuple[Any, ...]  # the inputs of a case


class Rows:
    """Rows of a table, kept by columns.

    Args:
        columns: each a float array, or a list of any values; of equal length.
    """

    def __init__(self, columns: Sequence[np.ndarray | list[Any]]) -> None:
        self.columns = columns
        self.added: list[Row] = []
        self._length = len(self.columns[0]) if self.columns else 0

    @classmethod
    def of(cls, rows: Iterable[Row]) -> "Rows":
        """From rows."""
        return cls([list(column) for column in zip(*rows, strict=True)])

    def is_numeric(self, k: int) -> bool:
        """Whether column k has only numbers."""
        column = self.columns[k]
        return isinstance(column, np.ndarray) or are_numbers(column)

    def content(self) -> bytes:
        """All values, for a digest."""
        columns = (
            column.tobytes() if isinstance(column, np.ndarray) else repr(column).encode() for column in self.columns
        )
        return b"|".join(columns)

    def __len__(self) -> int:
        return self._length + len(self.added)

    def __iter__(self) -> Iterator[Row]:
        return map(self.__getitem__, range(len(self)))

    def __getitem__(self, at: int) -> Row:
        if at >= self._length:
            return self.added[at - self._length]
        return tuple(column[at].item() if isinstance(column, np.ndarray) else column[at] for column in self.columns)


class Strings:
    """Keys of cases.

    Args:
        keys: in order, ASCII; or the array of them.
    """

    def __init__(self, keys: Iterable[str] | np.ndarray) -> None:
        if not isinstance(keys, np.ndarray):
            keys = np.fromiter((key.encode() for key in keys), dtype=f"S{KEY_LENGTH}")
        self.array: np.ndarray = keys

    def add(self, key: str) -> None:
        """Append one."""
        self.array = np.append(self.array, np.array([key.encode()], dtype=self.array.dtype))

    def __len__(self) -> int:
        return len(self.array)

    def __iter__(self) -> Iterator[str]:
        return map(self.__getitem__, range(len(self)))

    def __getitem__(self, at: int) -> str:
        key: bytes = self.array[at]
        return key.decode()

    def __contains__(self, key: object) -> bool:
        return isinstance(key, str) and bool((self.array == key.encode()).any())

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Strings) and np.array_equal(self.array, other.array)

    __hash__ = None  # type: ignore[assignment]  # it may grow
