"""Relaxation tests: loss of load over time at constant strain or twist, at several stresses and temperatures."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from coilset.model.base.columns import read_columns
from coilset.model.base.errors import InputError

STRESSES = {"stress": "tension", "shear_stress": "torsion"}  # the column that says what is strained
NEEDED = ("hours", "temperature", "loss")
FEWEST = 8  # readings


@dataclass(frozen=True)
class Readings:
    """Readings of relaxation tests, arrays of shape (readings,).

    Attributes:
        kind: tension, of a wire; or torsion, of a round bar or of the wire of a slender spring.
        stress: at the start, at the test's temperature, in torsion at the surface, N/mm².
        temperature: K.
        hours: since the start at this temperature.
        loss: of the load, per cent of the load at the start.
    """

    kind: str
    stress: np.ndarray
    temperature: np.ndarray
    hours: np.ndarray
    loss: np.ndarray


def read_relaxation(path: str | Path) -> Readings:
    """Read relaxation tests from a CSV file, one reading a row.

    Columns: hours, temperature (K), loss (%), and stress, of wire in tension, or shear_stress, at the surface of a bar
    in torsion or of the wire of a spring at constant height (N/mm²).

    Raises:
        InputError: if the file cannot be read, or a column or a number is missing or wrong.
    """
    table = read_columns(path)
    given = [name for name in STRESSES if name in table.names]
    missing = [name for name in NEEDED if name not in table.names]
    wanted = f"{', '.join(NEEDED)}, and stress or shear_stress"
    if missing:
        raise table.lacks(missing[0], wanted)
    if len(given) != 1:
        raise InputError(f"give one of the columns stress and shear_stress; the columns are {wanted}", "", table.path)
    if len(table.rows) < FEWEST:
        raise InputError(f"has {len(table.rows)} readings; {FEWEST} are needed at least", "", table.path)
    hours, temperature, loss, stress = (table.numbers(name) for name in (*NEEDED, given[0]))
    for name, values, low, high in (
        ("hours", hours, 0.0, 1e7),
        ("temperature", temperature, 0.0, 2000.0),
        ("loss", loss, -100.0, 100.0),
        (given[0], stress, 0.0, 1e4),
    ):
        wrong = (values <= low) | (values >= high)
        if wrong.any():
            k = int(np.argmax(wrong))
            raise InputError(
                f"{values[k]:g} must be between {low:g} and {high:g}",
                f"line {table.rows[k][0]}, column {name}",
                table.path,
            )
    return Readings(STRESSES[given[0]], stress, temperature, hours, loss)
