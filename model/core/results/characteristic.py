"""Force and rate at a travel: on the curve between the steps of a phase, see `between_steps`."""

import json
from typing import NamedTuple

import numpy as np
import xarray as xr

from coilset.model.core.base.between_steps import closed_rate, part
from coilset.model.core.base.errors import InputError

ERROR = "estimated_force_error_N"


class Place(NamedTuple):
    """A place of the characteristic.

    Attributes:
        force: N; rate: its slope, N/mm.
        error: estimated size of the error of the force, N: that of the steps around it, and how far the curve may be
            from there between them; not a number where that of a step is not known.
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
    count = data["contacts"].to_numpy() if "contacts" in data else np.zeros(len(of_step))
    columns = data["travel_mm"].to_numpy(), data["force_N"].to_numpy(), known
    x, y, error = (np.append(0.0, values) for values in columns)
    contacts = np.append(count[:1], count)
    rate = data["summary_rate_N_per_mm"].item() if "summary_rate_N_per_mm" in data else None
    closed = closed_rate(json.loads(data.attrs.get("case", "{}")), rate)
    for number in np.unique(of_step) if phase is None else [phase]:
        rows = np.flatnonzero(of_step == number) + 1
        if not len(rows):
            break
        first, last = rows[0] - 1, rows[-1]  # from the end of the phase before
        way = slice(first, last + 1)
        if x[way].min() <= travel <= x[way].max():
            force, slope, away = part(x, y, contacts, first, last, closed).at(travel)
            order = np.argsort(x[way], kind="stable")
            own = float(np.interp(travel, x[way][order], error[way][order]))
            return Place(force, slope, own + away)
    where = "in no phase of the load program" if phase is None else f"not in loading.{phase}"
    raise InputError(f"{travel:g} mm is reached {where}", "travel")


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
