"""The Goodman diagram of a wire with a spring's working cycle."""

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from coilset.model.base.style import STYLE
from coilset.model.figures.figures import LARGE, broken, save
from coilset.model.standards.goodman import Cycle, Line


def draw(path: Path, wire: str, endured: Line, cycle: Cycle, residual: float | None) -> None:
    """Goodman diagram of a wire with the working cycle, and with the residual stress added to it if there is one."""
    low = min(0.0, cycle.lower + (residual or 0.0))
    lower = np.array(sorted({low, 0.0, endured.knee, endured.limit}))
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.0, 5.4), layout="constrained")
        axes = figure.add_subplot()
        axes.plot(
            lower,
            [endured.upper(x) for x in lower],
            "k-",
            lw=1.4,
            label=f"endured {endured.times} times, {endured.surface}",
        )
        axes.plot([low, endured.limit], [low, endured.limit], "k:", lw=0.9, label="at rest, τk2 = τk1")
        _mark(axes, cycle, "C0", "working cycle, nominal")
        if residual is not None:
            text = f"{residual:.0f}".replace("-", "−")
            _mark(axes, cycle.shifted(residual), "C1", f"with the residual {text} MPa that was found")
        axes.set(
            xlabel="lower corrected stress τk1 in MPa",
            ylabel="upper corrected stress τk2 in MPa",
            title=broken(figure, _found(wire, endured, cycle), LARGE),
        )
        axes.legend(fontsize=8, loc="lower right")
        axes.grid(lw=0.3)
        save(figure, path)


def _found(wire: str, endured: Line, cycle: Cycle) -> str:
    """How much of the endured range the cycle uses."""
    endures = endured.stress_range(cycle.lower)
    span = cycle.upper - cycle.lower
    used = f"{100.0 * span / endures:.0f} % of what is endured" if endures else "above what is endured"
    return f"{wire}: the cycle of {span:.0f} MPa is {used}"


def _mark(axes: Axes, cycle: Cycle, colour: str, label: str) -> None:
    axes.plot([cycle.lower] * 2, [cycle.lower, cycle.upper], "-", color=colour, lw=1.2)
    axes.plot(cycle.lower, cycle.upper, "o", color=colour, ms=5, label=label)
