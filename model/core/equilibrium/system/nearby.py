"""The part of the wire on which the contacts that act on a rank's own unknowns depend.

All ranks have all positions. Each evaluates the contacts of its own stations with those within the contacts' reach of
the box around them; the last rank, which owns the seats' unknowns, also those that may act on a seat. Every contact
that joins two parts is evaluated on both ranks, from the same numbers in the same order, so that forces and stiffness
need not be exchanged.
"""

from collections.abc import Sequence

import numpy as np

from coilset.model.core.contact.base import Contact, Part
from coilset.model.core.contact.curve import STENCIL
from coilset.model.core.equilibrium.system.layout import LineLayout


class Nearby:
    """This rank's part of the wire and what is near it.

    If some kind of contact cannot be evaluated from nearby stations alone, every rank evaluates all contacts.

    Args:
        layout: LineLayout.
        contacts: of the system.
    """

    def __init__(self, layout: LineLayout, contacts: Sequence[Contact]) -> None:
        self._nearby = [contact for contact in contacts if contact.aside is not None]
        n, comm = len(layout.station_dofs), layout.comm
        self._all = comm.size == 1 or len(self._nearby) < len(contacts) or n < STENCIL
        self._own, self._has_seats = np.zeros(n, dtype=bool), comm.rank == comm.size - 1
        self._own[layout.own_stations] = True
        self._aside = max((contact.aside or 0 for contact in self._nearby), default=0)

    def part(self, x: np.ndarray, seats: np.ndarray) -> Part | None:
        """What this rank evaluates contacts on, None: all.

        Args:
            x: positions of all stations, shape (n, 3), mm.
            seats: of both seats, shape (12,).
        """
        if self._all:
            return None
        span, own = span_along(x, self._aside), x[self._own]
        reach = max(contact.reach for contact in self._nearby) + 2.0 * span
        near = ((own.min(axis=0) - reach <= x) & (x <= own.max(axis=0) + reach)).all(axis=1)
        if self._has_seats:
            for contact in self._nearby:
                near |= contact.acts_on_seats(np.arange(len(x)), x, seats, span)
        return Part(whole_elements(np.flatnonzero(near), len(x)), self._own)


def span_along(x: np.ndarray, stations: int) -> np.ndarray:
    """Bound of how far any two of so many neighbouring stations are apart along each axis, shape (3,), mm.

    It is the extent of two neighbouring ones of the pieces into which the wire is cut.

    Args:
        x: positions along the wire, shape (n, 3), mm.
        stations: their number.
    """
    if not len(x):
        return np.zeros(3)
    starts = np.arange(0, len(x), max(stations, 1))
    low, high = np.minimum.reduceat(x, starts), np.maximum.reduceat(x, starts)
    if len(starts) > 1:
        low, high = np.minimum(low[1:], low[:-1]), np.maximum(high[1:], high[:-1])
    return (high - low).max(axis=0)


def whole_elements(stations: np.ndarray, n: int) -> np.ndarray:
    """Ranges of elements whose four stations of the centre line are among some stations.

    An element's stations are its own two and their neighbours; at an end of the wire, the four that are nearest.

    Args:
        stations: numbers, ascending.
        n: number of all stations, at least 4.

    Returns:
        First element and the one after the last, shape (k, 2).
    """
    if not len(stations):
        return np.empty((0, 2), np.int64)
    cuts = np.flatnonzero(np.diff(stations) > 1)
    first, last = stations[np.append(0, cuts + 1)], stations[np.append(cuts, len(stations) - 1)]
    begin, stop = np.where(first == 0, 0, first + 1), np.where(last == n - 1, n - 1, last - 1)
    ranges = np.stack([begin, stop], axis=1)
    return ranges[(last - first >= 3) & (stop > begin)]
