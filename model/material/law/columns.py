"""Columns of numbers in a CSV file, as tests are recorded."""

import csv
import itertools
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from coilset.model.base.entry import shortened
from coilset.model.base.errors import InputError


@dataclass(frozen=True)
class Columns:
    """The columns of a file.

    Attributes:
        path: of the file.
        names: in its header.
        rows: cells by the names, with the number of their line.
    """

    path: Path
    names: tuple[str, ...]
    rows: tuple[tuple[int, dict[str, str]], ...]

    def numbers(self, name: str) -> np.ndarray:
        """A column, shape (rows,).

        Raises:
            InputError: if a cell is not a number.
        """
        return np.array([self._number(row[name], name, line) for line, row in self.rows])

    def lacks(self, name: str, wanted: str) -> InputError:
        """The error for a column that is not there; `wanted` are those that a user gives, in words."""
        there = shortened(", ".join(self.names))
        return InputError(f"is missing; the columns are {wanted}, but here {there}", f"column {name}", self.path)

    def _number(self, text: str | None, name: str, line: int) -> float:
        try:
            value = float(text or "")
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise InputError(f"'{shortened(text or '')}' is not a number", f"line {line}, column {name}", self.path)
        return value


def read_columns(path: str | Path) -> Columns:
    """Read a CSV file with a header; lines above it that begin with # are comments.

    Raises:
        InputError: if it cannot be read, if its columns are not separated by commas, or a row has more cells than the
            header.
    """
    path = Path(path)
    try:
        with open(path, newline="", encoding="utf-8-sig") as file:
            comments = 0
            for line in file:
                if not line.startswith("#"):
                    break
                comments += 1
            else:
                line = ""
            reader = csv.DictReader(itertools.chain([line], file), strict=True)
            reader.fieldnames = names = tuple(name.strip() for name in reader.fieldnames or ())
            _check_separator(names, comments + 1, path)
            rows = tuple((comments + reader.line_num, row) for row in reader)
    except UnicodeDecodeError:
        raise InputError("it is not a text file in UTF-8", "", path) from None
    except (OSError, csv.Error) as error:
        raise InputError(f"cannot be read ({getattr(error, 'strerror', None) or error})", "", path) from error
    for number, row in rows:
        if None in row:
            raise InputError(
                f"has more cells than the header, which names {len(names)}; numbers have a decimal point, as in 0.5",
                f"line {number}",
                path,
            )
    return Columns(path, names, rows)


def _check_separator(names: tuple[str, ...], line: int, path: Path) -> None:
    if len(names) == 1:
        found = next((sign for sign in (";", "\t") if sign in names[0]), None)
        if found:
            said = "tabs" if found == "\t" else f"'{found}'"
            raise InputError(
                f"the columns are separated by {said}; separate them by commas, and give numbers "
                "with a decimal point, as in 0.5",
                f"line {line}",
                path,
            )
