"""Relaxation tests: loss of load over time at constant strain or twist, at several stresses and temperatures."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from coilset.model.core.base.columns import read_columns
from coilset.model.core.base.errors import InputError

STRESSES = {"stress": "tension", "shear_stress": "torsion"}  # the column that says what is strained
NEEDED = ("hours", "temperature", "loss")
FEWEST = 8  # readings
FEWEST_POINTS = 3  # of a catalogue's diagram
CATALOGUE_HOURS = 48.0  # after which catalogues print losses
FORCE = "force"


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


def read_relaxation(path: str | Path, points: bool = False, per_force: float | None = None) -> Readings:
    """Read relaxation tests from a CSV file, one reading a row.

    Columns: hours, temperature (K), loss (%), and stress, of wire in tension, or shear_stress, at the surface of a bar
    in torsion or of the wire of a spring at constant height (N/mm²), or the force of a spring (N).

    Args:
        path: of the file.
        points: of a catalogue's diagram: three are enough, and without a column of hours they are after 48 h.
        per_force: shear stress at the surface of the spring's wire over its force, 1/mm²; needed for a column of force.

    Raises:
        InputError: if the file cannot be read, or a column or a number is missing or wrong.
    """
    table = read_columns(path).named(dict.fromkeys((*NEEDED, *STRESSES, FORCE), ""))
    kinds = STRESSES if per_force is None else {FORCE: "torsion"}
    given = [name for name in kinds if name in table.names]
    needed = [name for name in NEEDED if not (points and name == "hours")]
    missing = [name for name in needed if name not in table.names]
    wanted = f"{', '.join(needed)}, and {' or '.join(kinds)}"
    if missing:
        raise table.lacks(missing[0], wanted)
    if FORCE in table.names and per_force is None:
        raise InputError("gives forces of a spring; its case file must follow: losses.csv spring.yaml", "", table.path)
    if len(given) != 1:
        raise InputError(f"give one of the columns {' and '.join(kinds)}; the columns are {wanted}", "", table.path)
    fewest = FEWEST_POINTS if points else FEWEST
    if len(table.rows) < fewest:
        fewer = "" if points else f", or {FEWEST_POINTS} points by --points"
        raise InputError(f"has {len(table.rows)} readings; {fewest} are needed at least{fewer}", "", table.path)
    temperature, loss, stress = (table.numbers(name) for name in ("temperature", "loss", given[0]))
    printed = points and "hours" not in table.names
    hours = np.full(len(loss), CATALOGUE_HOURS) if printed else table.numbers("hours")
    for name, values, low, high in (
        ("hours", hours, 0.0, 1e7),
        ("temperature", temperature, 0.0, 2000.0),
        ("loss", loss, 0.0, 100.0),
        (given[0], stress, 0.0, 1e4),
    ):
        may_be_least = name == "loss"  # of a load that has not fallen yet
        wrong = (values < low) | ((values == low) & (not may_be_least)) | (values >= high)
        if wrong.any():
            k = int(np.argmax(wrong))
            least = f"{low:g} or more, and below" if may_be_least else f"between {low:g} and"
            raise InputError(
                f"{values[k]:g} must be {least} {high:g}",
                f"line {table.rows[k][0]}, column {name}",
                table.path,
            )
    return Readings(kinds[given[0]], stress * (per_force or 1.0), temperature, hours, loss)
