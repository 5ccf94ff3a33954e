"""Goodman diagram of a wire: the permissible upper corrected stress for a given lower one."""

from dataclasses import dataclass
from math import log10

from coilset.model.tools.wires.wire_file import TESTED, Endurance, Springs

SUPERSCRIPT = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True)
class Line:
    """Endurance at one diameter, corrected stresses τk in MPa: a straight line from `at_zero` to `limit` at `knee`."""

    at_zero: float
    knee: float
    limit: float
    cycles: float
    surface: str
    springs: Springs = "not stated"

    @property
    def tested(self) -> str:
        """Whether the springs of the tests had been preset, in words."""
        return TESTED[self.springs]

    @property
    def times(self) -> str:
        """The number of cycles as text, such as 10⁷."""
        power = round(log10(self.cycles))
        return f"10{str(power).translate(SUPERSCRIPT)}" if 10.0**power == self.cycles else f"{self.cycles:g}"

    def upper(self, lower: float) -> float:
        """Permissible upper stress for a lower one; the line extends below zero."""
        return min(self.at_zero + (self.limit - self.at_zero) * lower / self.knee, self.limit)

    def stress_range(self, lower: float) -> float:
        """Permissible stress range above a lower stress; 0 if the lower stress is above the limit."""
        return max(self.upper(lower) - lower, 0.0)


@dataclass(frozen=True)
class Cycle:
    """Lower and upper corrected stress between two working lengths, MPa."""

    lower: float
    upper: float

    def shifted(self, residual: float) -> "Cycle":
        """The cycle with a residual stress added to both, signed as the load's stress; presetting leaves a negative."""
        return Cycle(self.lower + residual, self.upper + residual)


def line(endurance: Endurance, diameter: float) -> Line:
    """The line of a wire at a diameter, mm: each value is a − b lg d."""

    def at(pair: tuple[float, float]) -> float:
        return pair[0] - pair[1] * log10(diameter)

    points = at(endurance.at_zero), at(endurance.knee), at(endurance.limit)
    return Line(*points, endurance.cycles, endurance.surface, endurance.springs)
