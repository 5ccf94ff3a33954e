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
SHEAR = ("gamma12", "tau12")  # a tension test may leave these columns out
PLAIN = {"eps11": "strain", "sigma11": "stress"}  # and may have these names, which a table of hardening has
LARGEST_STRAIN = 2.0  # of a test; above it the numbers are per cent


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


def read_test(path: str | Path, engineering: bool = False) -> Test:
    """Read a test from a CSV file.

    Lines at the top that begin with # are remarks. Of the columns, eps11, gamma12 (1) and sigma11, tau12 (N/mm²) are
    read; a tension test needs two only, strain and stress, or eps11 and sigma11. The first row is the unloaded start or
    the first reading after it.

    Args:
        path: the file.
        engineering: whether a tension test is given by engineering strain and stress, e and s, of the first length and
            area; it is then converted, ε = ln(1 + e), σ = s (1 + e), up to the maximum force, beyond which it necks.

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
            given = reader.fieldnames or ()
            names = {name: name if name in given else PLAIN.get(name, name) for name in COLUMNS}
            sheared = any(name in given for name in SHEAR)
            missing = [name for name in COLUMNS if names[name] not in given and (sheared or name not in SHEAR)]
            if missing:
                needed = f"{', '.join(COLUMNS)}; of a tension test strain, stress"
                raise InputError(f"is missing; the columns are {needed}", f"column {missing[0]}", str(path))
            rows = [
                [
                    _number(row[column], column, remarks + reader.line_num, path) if column in given else 0.0
                    for column in names.values()
                ]
                for row in reader
            ]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"cannot be read ({getattr(error, 'strerror', None) or error})", file=str(path)) from error
    if len(rows) < 20:
        raise InputError(f"has {len(rows)} rows; a test needs at least 20", file=str(path))
    values = np.array(rows)
    largest = np.abs(values[:, :2]).max()
    if largest > LARGEST_STRAIN:
        raise InputError(f"goes up to {largest:g}; give strain as a number, 0.02 for 2 %", "strain", str(path))
    test = Test(path.stem, values[:, :2], values[:, 2:])
    return _true(test, path) if engineering else test


def _true(test: Test, path: Path) -> Test:
    """A tension test from engineering strain and stress, up to its maximum force."""
    if test.kind != "tension":
        raise InputError(
            "is not a tension test; only tension tests have engineering strain and stress", "--engineering", str(path)
        )
    end = int(test.stress[:, 0].argmax()) + 1
    strain, stress = test.strain[:end].copy(), test.stress[:end].copy()
    stress[:, 0] *= 1 + strain[:, 0]
    strain[:, 0] = np.log1p(strain[:, 0])
    return Test(test.name, strain, stress)


def _number(text: str | None, name: str, line: int, path: Path) -> float:
    try:
        value = float(text or "")
    except (TypeError, ValueError):
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"'{shortened(str(text))}' is not a number", f"line {line}, column {name}", str(path))
    return value
