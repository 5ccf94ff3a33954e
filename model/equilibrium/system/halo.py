"""Halo of a rank: the stations of other ranks on which the contacts that act on its own unknowns depend.

Each rank sends the box around its stations to all others, and each the stations of its own that lie within the
contacts' reach of that one's box; to the last rank, which owns the seats' unknowns, also those that may act on a seat.
Every contact that joins two parts is then evaluated on both ranks, from the same numbers in the same order, so that
forces and stiffness need not be exchanged.
"""

from collections.abc import Sequence

import numpy as np

from coilset.model.contact.base import Contact, Known, TrialPositions
from coilset.model.contact.curve import STENCIL
from coilset.model.equilibrium.system.layout import LineLayout

NUMBER, PLACE, ROTATION = 0, slice(1, 4), slice(4, 7)  # columns of what is sent for a station
BOX, MOTION, SPAN, LONGEST = slice(6), slice(6, 12), slice(12, 15), 15  # in what a rank sends of its part


class Halo:
    """Trial positions of this rank's part of the wire and of what is near it.

    If some kind of contact cannot be evaluated from nearby stations alone, every rank has all stations.

    Args:
        layout: LineLayout.
        contacts: of the system.
    """

    def __init__(self, layout: LineLayout, contacts: Sequence[Contact]) -> None:
        self.layout, self.comm = layout, layout.comm
        self._nearby = [contact for contact in contacts if contact.aside is not None]
        self._own, n = layout.own_stations, len(layout.station_dofs)
        self._all = layout.comm.size == 1 or len(self._nearby) < len(contacts) or n < STENCIL
        if self._all:
            return
        self._is_own = np.zeros(n, dtype=bool)
        self._is_own[self._own] = True
        self._along = np.argsort(self._own)
        self._aside = max((contact.aside or 0 for contact in self._nearby), default=0)
        self._x, self._rotations = np.zeros((n, 3)), np.zeros((n, 3))
        self._last, self._way = np.zeros((len(self._own), 3)), 0.0  # own stations of the last call; see Known

    def trial(self, x: np.ndarray, seats: np.ndarray, rotations: np.ndarray | None = None) -> TrialPositions:
        """TrialPositions from those of the local nodes; the next call overwrites them; collective.

        Args:
            x: positions, shape (local nodes, 3), mm.
            seats: of both seats, shape (12,).
            rotations: since the last equilibrium, shape (local nodes, 3), rad, or None.
        """
        layout = self.layout
        if self._all:
            turned = None if rotations is None else layout.gather(rotations)
            return TrialPositions(layout.gather(x), seats, turned)
        own = x[: len(self._own)]
        columns = [self._own, own] if rotations is None else [self._own, own, rotations[: len(own)]]
        boxes, span, longest = self._boxes(x)
        near = [self._near(rank, boxes, own, seats, span) for rank in range(self.comm.size)]
        found = self._exchange([np.column_stack([values[each] for values in columns]) for each in near])
        stations, is_known = found[:, NUMBER].astype(np.int64), self._is_own.copy()
        self._x[self._own], self._x[stations], is_known[stations] = own, found[:, PLACE], True
        if rotations is not None:
            self._rotations[self._own], self._rotations[stations] = columns[2], found[:, ROTATION]
        known = Known(whole_elements(np.flatnonzero(is_known), len(self._x)), longest, self._way, self._is_own)
        return TrialPositions(self._x, seats, None if rotations is None else self._rotations, known)

    def _boxes(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
        """Around all ranks' stations, and along the wire.

        Returns:
            Corners of the boxes, shape (ranks, 2, 3); how far stations up to `aside` of each other are apart along each
            axis at most, shape (3,); the longest distance of neighbouring stations; mm.
        """
        own = x[self._along]
        mine, boxes = np.empty(16), np.empty((self.comm.size, 16))
        mine[BOX], mine[MOTION] = box_around(own).ravel(), box_around(own - self._last).ravel()
        mine[SPAN], mine[LONGEST] = span_along(own, self._aside), longest_cell(x, self.layout.rod.cells)
        self._last = own
        self.comm.Allgather(mine, boxes)
        motions = boxes[:, MOTION].reshape(-1, 2, 3)
        self._way += float(np.linalg.norm(motions[:, 1].max(axis=0) - motions[:, 0].min(axis=0)))
        return boxes[:, BOX].reshape(-1, 2, 3), boxes[:, SPAN].max(axis=0), float(boxes[:, LONGEST].max())

    def _near(self, rank: int, boxes: np.ndarray, x: np.ndarray, seats: np.ndarray, span: np.ndarray) -> np.ndarray:
        """Which of the own stations, at `x`, another rank needs, bool; none for this rank itself."""
        if rank == self.comm.rank:
            return np.zeros(len(x), dtype=bool)
        near = in_box(x, boxes[rank], max(contact.reach for contact in self._nearby) + 2.0 * span)
        if rank == self.comm.size - 1:
            for contact in self._nearby:
                near |= contact.acts_on_seats(self._own, x, seats, span)
        return near

    def _exchange(self, sent: Sequence[np.ndarray]) -> np.ndarray:
        """Rows that all ranks have for this one; `sent`: this one's for each rank."""
        width = sent[0].shape[1]
        give, take = np.array([len(each) for each in sent]), np.empty(self.comm.size, np.int64)
        self.comm.Alltoall(give, take)
        out = np.empty((take.sum(), width))
        self.comm.Alltoallv((np.concatenate(sent), give * width), (out, take * width))
        return out


def box_around(x: np.ndarray) -> np.ndarray:
    """Corners of the box around positions, shape (n, 3) → (2, 3), mm; infinitely far apart around none."""
    return np.stack([x.min(axis=0, initial=np.inf), x.max(axis=0, initial=-np.inf)])


def in_box(x: np.ndarray, box: np.ndarray, reach: np.ndarray) -> np.ndarray:
    """Which of some positions, shape (n, 3), are within `reach`, shape (3,), of a box; shape (n,), bool."""
    return ((box[0] - reach <= x) & (x <= box[1] + reach)).all(axis=1)


def longest_cell(x: np.ndarray, cells: np.ndarray) -> float:
    """Longest distance of two nodes that a cell joins, mm; 0 without cells."""
    return float(np.linalg.norm(x[cells[:, 1]] - x[cells[:, 0]], axis=1).max(initial=0.0))


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
