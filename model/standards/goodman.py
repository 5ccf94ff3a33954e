"""Goodman diagram of a wire: which upper corrected stress it endures over which lower one."""

from dataclasses import dataclass
from math import log10
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from coilset.model.results.figures import STYLE, save
from coilset.model.standards.wires.file import Endurance

SUPERSCRIPT = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True)
class Line:
    """Endurance at one diameter, corrected stresses τk in MPa: straight from `at_zero` to `limit` at `knee`."""

    at_zero: float
    knee: float
    limit: float
    cycles: float
    surface: str

    @property
    def times(self) -> str:
        """The number of cycles in words, as 10⁷."""
        power = round(log10(self.cycles))
        return f"10{str(power).translate(SUPERSCRIPT)}" if 10.0**power == self.cycles else f"{self.cycles:g}"

    def upper(self, lower: float) -> float:
        """Upper stress that is endured over a lower one; below zero the line goes on."""
        return min(self.at_zero + (self.limit - self.at_zero) * lower / self.knee, self.limit)

    def stress_range(self, lower: float) -> float:
        """Range of stress that is endured over a lower stress; 0 where the lower one is above the limit."""
        return max(self.upper(lower) - lower, 0.0)


@dataclass(frozen=True)
class Cycle:
    """Lower and upper corrected stress between two working lengths, MPa."""

    lower: float
    upper: float

    def shifted(self, residual: float) -> "Cycle":
        """The cycle with a residual stress on both, signed as the load's stress: presetting leaves a negative one."""
        return Cycle(self.lower + residual, self.upper + residual)


def line(endurance: Endurance, diameter: float) -> Line:
    """The line of a wire at a diameter, mm: each value is a − b lg d."""

    def at(pair: tuple[float, float]) -> float:
        return pair[0] - pair[1] * log10(diameter)

    return Line(at(endurance.at_zero), at(endurance.knee), at(endurance.limit), endurance.cycles, endurance.surface)


def draw(path: Path, title: str, endured: Line, cycle: Cycle, residual: float | None) -> None:
    """Goodman diagram with the working cycle, and with the residual stress added to it if there is one."""
    low = min(0.0, cycle.lower + (residual or 0.0))
    lower = np.array(sorted({low, 0.0, endured.knee, endured.limit}))
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.0, 5.4), layout="constrained")
        axes = figure.add_subplot()
        axes.plot(lower, [endured.upper(x) for x in lower], "k-", lw=1.4,
                  label=f"endured {endured.times} times, {endured.surface}")  # fmt: skip
        axes.plot([low, endured.limit], [low, endured.limit], "k:", lw=0.9, label="at rest, τk2 = τk1")
        _mark(axes, cycle, "C0", "working cycle, nominal")
        if residual is not None:
            _mark(axes, cycle.shifted(residual), "C3", f"with the residual {residual:.0f} MPa that was found")
        axes.set(xlabel="lower corrected stress τk1 in MPa", ylabel="upper corrected stress τk2 in MPa", title=title)
        axes.legend(fontsize=8, loc="lower right")
        axes.grid(lw=0.3)
        save(figure, path)


def _mark(axes: Axes, cycle: Any, colour: str, label: str) -> None:
    axes.plot([cycle.lower] * 2, [cycle.lower, cycle.upper], "-", color=colour, lw=1.2)
    axes.plot(cycle.lower, cycle.upper, "o", color=colour, ms=5, label=label)
