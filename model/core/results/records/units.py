"""Units of the numbers of results, which their names end with."""

import re

UNITS = {
    "_N_per_mm2": "N/mm²",
    "_N_per_mm": "N/mm",
    "_Nmm": "N mm",
    "_mm": "mm",
    "_MPa": "MPa",
    "_N": "N",
    "_rad": "rad",
    "_turns": "1",
    "hours": "h",
    "_K": "K",
    "_Nmm_per_deg": "N mm/°",
    "_deg": "degrees",
    "_turn": "1",
    "_percent": "%",
    "least_eigenvalue": "N/mm",
}
WORKING = re.compile(r"_at_[\d.]+$")
"""End of a name without its unit: a working length in mm, or a force in N of `length_at_…`."""


def unit_of(name: str) -> str:
    """Unit of a number by its name, as in `set_mm`; 1 where it has none."""
    return next((unit for end, unit in UNITS.items() if name.endswith(end)), "1")


def without_unit(name: str) -> tuple[str, str]:
    """A name without the unit that it ends with, and that unit; `plastic_work_max_turn` is whole, and has none."""
    found = ((name.removesuffix(end), unit) for end, unit in UNITS.items() if name.endswith(end) and end[0] == "_")
    stem, unit = next(found, (name, "1"))
    return (name, "") if unit == "1" else (stem, unit)


def words_and_unit(name: str) -> tuple[str, str]:
    """Words and unit of a number of results from its name, as in `set_mm`; that of a working state has its place."""
    stem, unit = without_unit(name)
    words = stem.replace("_", " ")
    if WORKING.search(stem):
        words += " N" if stem.startswith("length") else " mm"
    return f"maximum {words.removesuffix(' max')}" if words.endswith(" max") else words, unit
