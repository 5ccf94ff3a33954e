"""Laboratory tests of a material: strain paths and measured stresses, read from CSV files."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from coilset.model.core.base.columns import read_columns
from coilset.model.core.base.errors import InputError

COLUMNS = ("eps11", "gamma12", "sigma11", "tau12")
SHEAR = ("gamma12", "tau12")  # a tension test may leave these columns out
PLAIN = {"eps11": "strain", "sigma11": "stress"}  # and may have these names, which a table of hardening has
COMPONENTS = {"tension": [0], "torsion": [1], "combined": [0, 1]}  # of strain and stress that a kind of test loads
PULLED = 0.1  # of its least stress, which a test that is pulled has as its greatest at least
LARGEST_STRAIN = 2.0  # of a test; above it the numbers are per cent


@dataclass(frozen=True)
class Test:
    """A strain-controlled test: strain ε11, γ12, shape (rows, 2), and the measured stress σ11, τ12, N/mm².

    Attributes:
        file: that it was read from, for messages; by default its name.
        tester: offset and compliance that were taken off its strain, or given; see `elastic_part.TESTER`.
    """

    __test__ = False  # not a test of pytest
    name: str
    strain: np.ndarray
    stress: np.ndarray
    file: str = ""
    tester: Mapping[str, float] = field(default_factory=dict)

    def error(self, problem: str) -> InputError:
        """That something is wrong with it."""
        return InputError(problem, file=self.file or self.name)

    @property
    def kind(self) -> str:
        """tension, torsion or combined, by the stresses; a free end's strain in torsion does not count."""
        tension, torsion = np.abs(self.stress).max(axis=0) * (1, math.sqrt(3))
        if torsion < 0.1 * tension:
            return "tension"
        return "torsion" if tension < 0.1 * torsion else "combined"


def read_test(path: str | Path, engineering: bool = False) -> Test:
    """Read a test from a CSV file.

    Lines that begin with # are comments. Of the columns, eps11, gamma12 (1) and sigma11, tau12 (N/mm²) are
    read; a tension test needs only two, strain and stress, or eps11 and sigma11. The first row is the unloaded start or
    the first reading after it.

    Args:
        path: the file.
        engineering: whether a tension test has engineering strain and stress, e and s, relative to the initial length
            and area; it is then converted, ε = ln(1 + e), σ = s (1 + e), up to the maximum force, beyond which it
            necks.

    Raises:
        InputError: if the file cannot be read, or a column or a number is missing or wrong.
    """
    table = read_columns(path).named(dict.fromkeys((*COLUMNS, *PLAIN.values()), ""))
    names = {name: name if name in table.names else PLAIN.get(name, name) for name in COLUMNS}
    sheared = any(name in table.names for name in SHEAR)
    missing = [name for name in COLUMNS if names[name] not in table.names and (sheared or name not in SHEAR)]
    if missing:
        raise table.lacks(names[missing[0]], f"{', '.join(COLUMNS)}, or for a tension test strain, stress")
    rows = len(table.rows)
    if rows < 20:
        raise InputError(f"has {rows} rows; a test needs at least 20", file=str(table.path))
    values = np.column_stack(
        [table.numbers(name) if name in table.names else np.zeros(rows) for name in names.values()]
    )
    largest = np.abs(values[:, :2]).max()
    if largest > LARGEST_STRAIN:
        raise InputError(f"goes up to {largest:g}; give strain as a number, 0.02 for 2 %", "strain", str(table.path))
    test = Test(table.path.stem, values[:, :2], values[:, 2:], str(table.path))
    return true_test(test) if engineering else test


def true_test(test: Test) -> Test:
    """A tension test from engineering strain and stress, up to its maximum force.

    Raises:
        InputError: another test, or one whose stresses are negative.
    """
    file, most, least = test.file or test.name, test.stress[:, 0].max(), test.stress[:, 0].min()
    if test.kind != "tension":
        problem = "is not a tension test; only tension tests have engineering strain and stress"
        raise InputError(problem, "--engineering", file)
    if most < PULLED * -least:
        problem = f"its stresses are negative, down to {least:.4g} N/mm², as in compression"
        hint = "give a tension test with positive signs, or true strain and stress without --engineering"
        raise InputError(f"{problem}; {hint}", "--engineering", file)
    end = int(test.stress[:, 0].argmax()) + 1
    strain, stress = test.strain[:end].copy(), test.stress[:end].copy()
    stress[:, 0] *= 1 + strain[:, 0]
    strain[:, 0] = np.log1p(strain[:, 0])
    return replace(test, strain=strain, stress=stress)
