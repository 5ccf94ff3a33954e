"""The travel of a driven head over time: a smooth valve lift by its numbers, or a curve from a file."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline

from coilset.model.core.base.columns import read_columns
from coilset.model.core.base.errors import InputError

COLUMNS = "time_s and travel_mm"


@dataclass(frozen=True)
class Lift:
    """Travel of the top head from where the spring is, pressing it positive.

    Attributes:
        travel: mm, at a time from 0 on, s.
        seconds: until it has ended.
        greatest: mm.
        words: for titles.
    """

    travel: Callable[[float], float]
    seconds: float
    greatest: float
    words: str


def valve_lift(lift: float, speed: float, opening: float) -> Lift:
    """(1 − ξ²)³ with ξ from −1 to 1, whose acceleration has no jump, in place of a cam.

    Args:
        lift: mm.
        speed: of the engine, 1/min; the camshaft turns half as fast.
        opening: turn of the camshaft while the valve is open, degrees.

    Raises:
        InputError: for numbers that are not positive, or more than a turn.
    """
    for name, value, most in (("lift", lift, np.inf), ("speed", speed, np.inf), ("opening", opening, 360.0)):
        if not 0.0 < value <= most or not np.isfinite(value):
            limit = "" if most == np.inf else f" up to {most:g}"
            raise InputError(f"{value:g} is not possible; give a positive number{limit}", f"--{name}")
    seconds = opening / 360.0 * 2.0 * 60.0 / speed

    def travel(time: float) -> float:
        ξ = 2.0 * time / seconds - 1.0
        return lift * max(1.0 - ξ * ξ, 0.0) ** 3

    return Lift(travel, seconds, lift, f"a lift of {lift:g} mm at {speed:,.0f} 1/min")


def read_lift(path: str | Path) -> Lift:
    """A cubic spline through the rows of a CSV file with the columns time_s and travel_mm, both from 0 on.

    Raises:
        InputError: if it cannot be read, or its numbers have no meaning.
    """
    table = read_columns(path).named({"time_s": "s", "travel_mm": "mm"})
    for name in ("time_s", "travel_mm"):
        if name not in table.names:
            raise table.lacks(name, COLUMNS)
    time, travel = table.numbers("time_s"), table.numbers("travel_mm")
    if len(time) < 2 or time[0] != 0.0 or travel[0] != 0.0 or not (np.diff(time) > 0.0).all():
        raise InputError("needs two rows or more, the first of zeros, with times that grow", COLUMNS, path)
    if not travel.any():
        raise InputError("the head never moves", "travel_mm", path)
    with np.errstate(all="ignore"):
        slopes = np.diff(travel) / np.diff(time)
        if not np.isfinite(slopes @ slopes):  # what the spline computes with
            raise InputError("no head moves as fast as this", f"row {int(np.abs(slopes).argmax()) + 2}", path)
    curve = CubicSpline(time, travel)
    last = float(time[-1])
    return Lift(lambda t: float(curve(min(t, last))), last, float(travel.max()), f"the travel of {Path(path).name}")
