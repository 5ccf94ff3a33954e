"""Tests of a material in the laboratory: strain paths and the stresses that they gave, read from CSV files."""

import csv
import itertools
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from coilset.meshes.errors import InputError
from coilset.model.entries.entry import shortened

COLUMNS = ("eps11", "gamma12", "sigma11", "tau12")


@dataclass(frozen=True)
class Test:
    """A strain-controlled test: strain ε11, γ12, shape (rows, 2), and the stress σ11, τ12 it gave, N/mm²."""

    __test__ = False  # not a test of pytest
    name: str
    strain: np.ndarray
    stress: np.ndarray

    @property
    def kind(self) -> str:
        """tension, torsion or combined, by the stresses; a free end's strain in torsion does not count."""
        tension, torsion = np.abs(self.stress).max(axis=0) * (1, math.sqrt(3))
        if torsion < 0.1 * tension:
            return "tension"
        return "torsion" if tension < 0.1 * torsion else "combined"


def read_test(path: str | Path) -> Test:
    """Read a test from a CSV file.

    Lines at the top that begin with # are remarks. Of the columns, eps11, gamma12 (1) and sigma11, tau12 (N/mm²) are
    read; the first row is the unloaded start or the first reading after it.

    Raises:
        InputError: if the file cannot be read, or a column or a number is missing or wrong.
    """
    path = Path(path)
    try:
        with open(path, newline="", encoding="utf-8") as file:
            remarks, lines = 0, iter(file)
            for line in file:
                if not line.startswith("#"):
                    lines = itertools.chain([line], file)
                    break
                remarks += 1
            reader = csv.DictReader(lines)
            missing = [name for name in COLUMNS if name not in (reader.fieldnames or ())]
            if missing:
                raise InputError(f"is missing; the columns are {', '.join(COLUMNS)}", f"column {missing[0]}", str(path))
            rows = [[_number(row[name], name, remarks + reader.line_num, path) for name in COLUMNS] for row in reader]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"cannot be read ({getattr(error, 'strerror', None) or error})", file=str(path)) from error
    if len(rows) < 20:
        raise InputError(f"has {len(rows)} rows; a test needs at least 20", file=str(path))
    values = np.array(rows)
    return Test(path.stem, values[:, :2], values[:, 2:])


def _number(text: str | None, name: str, line: int, path: Path) -> float:
    try:
        value = float(text or "")
    except (TypeError, ValueError):
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"'{shortened(str(text))}' is no number", f"line {line}, column {name}", str(path))
    return value
