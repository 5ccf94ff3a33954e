"""Force and rate between the steps of a run: each phase is a monotone cubic through its steps.

The cubic of Hermite between two steps has slopes at both, those of F. N. Fritsch and J. Butland (SIAM J. Sci. Stat.
Comput. 5, 1984): weighted harmonic means of the rates of the steps on both sides, 0 where these differ in sign. It
neither rounds off nor overshoots a kink where coils close. A phase of fewer than three steps, or one whose travel turns
back, keeps its straight lines.
"""

from typing import NamedTuple

import numpy as np
import xarray as xr

from coilset.model.base.errors import InputError

ERROR = "estimated_force_error_N"


class Place(NamedTuple):
    """A place of the characteristic.

    Attributes:
        force: N; rate: its slope, N/mm.
        error: estimated size of the error of the force, N: that of the steps around it, and how far the cubic lies from
            the chord; not a number where that of a step is not known.
    """

    force: float
    rate: float
    error: float


def place_at(data: xr.Dataset, travel: float, phase: int | None = None) -> Place:
    """The characteristic at a travel.

    Args:
        data: columns of history.csv over `step`.
        travel: shortening of the unloaded spring as wound, mm.
        phase: number of the phase of the load program, from 0 on; default is the first that reaches the travel.

    Raises:
        InputError: the spring does not reach the travel in that phase.
    """
    of_step = data["phase"].to_numpy()
    known = data[ERROR].to_numpy() if ERROR in data else np.full(len(of_step), np.nan)
    columns = [np.append(0.0, values) for values in (data["travel_mm"].to_numpy(), data["force_N"].to_numpy(), known)]
    for number in np.unique(of_step) if phase is None else [phase]:
        rows = np.flatnonzero(of_step == number) + 1  # the row before is the end of the phase before
        if not len(rows):
            break
        x, y, error = (values[rows[0] - 1 : rows[-1] + 1] for values in columns)
        if x.min() <= travel <= x.max():
            return _on_phase(x, y, error, travel)
    where = "in no phase of the load program" if phase is None else f"not in loading.{phase}"
    raise InputError(f"{travel:g} mm is reached {where}", "travel")


def _on_phase(x: np.ndarray, y: np.ndarray, error: np.ndarray, travel: float) -> Place:
    from scipy.interpolate import PchipInterpolator

    order = np.argsort(x, kind="stable")
    x, y, error = x[order], y[order], error[order]
    k = int(np.clip(np.searchsorted(x, travel), 1, len(x) - 1))
    chord = float(np.interp(travel, x, y))
    own = float(np.interp(travel, x[k - 1 : k + 1], error[k - 1 : k + 1]))
    steps = np.diff(order)
    if len(x) < 4 or not (np.all(steps == 1) or np.all(steps == -1)) or not np.all(np.diff(x) > 0.0):
        way = x[k] - x[k - 1]
        return Place(chord, float((y[k] - y[k - 1]) / way) if way else float("nan"), own)
    cubic = PchipInterpolator(x, y)
    force = float(cubic(travel))
    return Place(force, float(cubic(travel, 1)), own + abs(force - chord))


class Run(xr.Dataset):
    """Labelled results of a run, with the characteristic between its steps; arguments as of `place_at`."""

    __slots__ = ()

    def force_at(self, travel: float, phase: int | None = None) -> float:
        """Axial force at a travel, N."""
        return place_at(self, travel, phase).force

    def rate_at(self, travel: float, phase: int | None = None) -> float:
        """Rate at a travel, N/mm."""
        return place_at(self, travel, phase).rate

    def force_error_at(self, travel: float, phase: int | None = None) -> float:
        """Estimated size of the error of the force at a travel, N; not a number where it is not known."""
        return place_at(self, travel, phase).error
