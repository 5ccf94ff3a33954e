"""Tables in CSV files, as laboratories and spreadsheets write them.

The cells are separated by commas, semicolons or tabs, whichever the first line has. Between semicolons and tabs numbers
may have a decimal comma.
"""

import csv
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from coilset.model.core.base.entry import shortened
from coilset.model.core.base.errors import InputError

LONGEST_FILE = 100_000_000  # bytes
UNITS = {
    "mm": ("mm", 1.0),
    "in": ("mm", 25.4),
    "N": ("N", 1.0),
    "kN": ("N", 1e3),
    "kgf": ("N", 9.80665),
    "lbf": ("N", 4.4482216152605),
}
"""Units of readings, with ours and by how much a number is to be multiplied."""
FORMULA = re.compile(r"\s*[=+\-@].")
DECIMAL_COMMA = re.compile(r"\s*[-+]?\d*,\d+([eE][-+]?\d+)?\s*")


@dataclass(frozen=True)
class Columns:
    """The columns of a file.

    Attributes:
        path: of the file.
        names: in its header.
        rows: cells by the names, with the number of their line; a short row lacks the last ones.
        head: number of the header's line.
    """

    path: Path
    names: tuple[str, ...]
    rows: tuple[tuple[int, dict[str, str]], ...]
    head: int = 1

    def numbers(self, name: str) -> np.ndarray:
        """A column, shape (rows,).

        Raises:
            InputError: if a cell is not a number.
        """
        return np.array([self._number(row.get(name), name, line) for line, row in self.rows])

    def named(self, units: Mapping[str, str]) -> "Columns":
        """The columns by the names that a reader has for them, with numbers in its units.

        Headings may be in capitals and have another unit, as `Force [kgf]` or `travel_in`.

        Args:
            units: of the columns that are wanted, by their names, such as `force` or `travel_mm`; empty without one.

        Raises:
            InputError: if two columns are the same.
        """
        found = [_name_and_factor(name, units) for name in self.names]
        names = tuple(name for name, _ in found)
        if twice := next((name for k, name in enumerate(names) if name and name in names[:k]), None):
            raise InputError(f"is there twice; the columns are {shortened(', '.join(self.names))}", twice, self.path)
        rows = tuple(
            (line, {name: scaled(cell, factor) for (name, factor), cell in zip(found, row.values(), strict=False)})
            for line, row in self.rows
        )
        return replace(self, names=names, rows=rows)

    def lacks(self, name: str, wanted: str) -> InputError:
        """The error for a column that is not there; `wanted` are those that a user gives, in words."""
        there = shortened(", ".join(self.names))
        return InputError(f"is missing; the columns are {wanted}, but here {there}", f"column {name}", self.path)

    def _number(self, text: str | None, name: str, line: int) -> float:
        value = number(text)
        if not math.isfinite(value):
            raise InputError(f"'{shortened(text or '')}' is not a number", f"line {line}, column {name}", self.path)
        return value


def _name_and_factor(heading: str, units: Mapping[str, str]) -> tuple[str, float]:
    """The name of a column by its heading, and by how much its numbers are to be multiplied."""
    for name, unit in units.items():
        if heading.lower() == name.lower():
            return name, 1.0
        for sign, (ours, factor) in UNITS.items():
            stem = re.escape(name.removesuffix(f"_{unit}"))
            if ours == unit and re.fullmatch(rf"{stem}[ _]*[\[(]?{sign}[\])]?", heading, re.IGNORECASE):
                return name, factor
    return heading, 1.0


def scaled(cell: str, factor: float) -> str:
    """A cell with its number times a factor; what is no number stays as it is."""
    value = number(cell)
    return cell if factor == 1.0 or not math.isfinite(value) else repr(factor * value)


def in_our_unit(quantity: str) -> tuple[str, float]:
    """A quantity such as `force_kgf` by the name that it has in our unit, `force_N`, and the factor of its numbers."""
    for sign, (ours, factor) in UNITS.items():
        if factor != 1.0 and quantity.endswith(f"_{sign}"):
            return f"{quantity.removesuffix(sign)}{ours}", factor
    return quantity, 1.0


def number(text: str | None) -> float:
    """The number in a cell, also with a decimal comma; NaN if there is none."""
    text = text or ""
    try:
        return float(text.replace(",", ".") if DECIMAL_COMMA.fullmatch(text) else text)
    except ValueError:
        return math.nan


def as_text(cells: Iterable[object]) -> list[object]:
    """Cells of a row to write; a word that a spreadsheet would take for a formula, as `=1+2`, gets an apostrophe."""
    return [f"'{cell}" if isinstance(cell, str) and _is_formula(cell) else cell for cell in cells]


def _is_formula(text: str) -> bool:
    return FORMULA.match(text) is not None and not math.isfinite(number(text))


def read_rows(path: str | Path) -> list[tuple[int, list[str]]]:
    """The rows of a CSV file that are not empty, with the numbers of their lines; lines that begin with # are comments.

    Raises:
        InputError: if it cannot be read.
    """
    try:
        with open(path, "rb") as file:
            data = file.read(LONGEST_FILE + 1)
        if len(data) > LONGEST_FILE:
            raise InputError(f"is longer than {LONGEST_FILE / 1e6:g} MB", "", path)
        lines = data.decode("utf-8-sig").splitlines()
        lines = ["" if line.lstrip(' \t"').startswith("#") else line for line in lines]
        reader = csv.reader(lines, delimiter=_separator(lines), strict=True)
        return [(reader.line_num, row) for row in reader if any(map(str.strip, row))]
    except UnicodeDecodeError:
        raise InputError("it is not a text file in UTF-8", "", path) from None
    except (OSError, csv.Error) as error:
        raise InputError(f"cannot be read ({getattr(error, 'strerror', None) or error})", "", path) from error


def read_columns(path: str | Path) -> Columns:
    """Read a CSV file with a header; lines that begin with # are comments.

    Raises:
        InputError: if it cannot be read, or a row has more cells than the header.
    """
    rows = read_rows(path)
    head, names = rows[0] if rows else (1, [])
    names = [name.strip() for name in names]
    for line, row in rows[1:]:
        if len(row) > len(names):
            problem = f"has {len(row)} cells, but the header names {len(names)} columns"
            hint = "numbers between commas have a decimal point, as in 0.5; those with a decimal comma stand between ;"
            raise InputError(f"{problem}; {hint}", f"line {line}", path)
    cells = tuple((line, dict(zip(names, row, strict=False))) for line, row in rows[1:])
    return Columns(Path(path), tuple(names), cells, head)


def _separator(lines: Sequence[str]) -> str:
    """The one between the cells of the first line that is not empty."""
    head = next((line for line in lines if line.strip()), "")
    return next((sign for sign in ";\t" if sign in head), ",")
