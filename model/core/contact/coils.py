"""Wire on wire: points of the wire against the closest points of the other coils, wherever these are.

The gap is the distance from the point to the other coil's centre line less both radii there; of wire that is not round,
its gauge (gauge.py) in place of the distance. Each coil is projected onto the other with half of the bedding, so that
neither is the master.
"""

import numpy as np

from coilset.model.core.base.extremes import greatest, relative_motion
from coilset.model.core.contact.base import Contact, Contribution, Memory, TrialPositions
from coilset.model.core.contact.curve import Curve, WirePoints, curve_weights
from coilset.model.core.contact.elements import PAIR, Bedding, Pressed, coil_elements
from coilset.model.core.contact.gauge import ROUND, extremes
from coilset.model.core.contact.search import (
    PLACES,
    Locations,
    Points,
    Searched,
    longest_element,
    near_locations,
    place,
    post_stride,
)
from coilset.model.core.runtime.kernels import njit

FEW = 1024  # locations on other coils for which there is room at first
SKIN = 0.5  # in wire radii: how far beyond what touches pairs are sought
# Along the wire, a pair depends on three more stations of the cubic, and the search oversteps by two and by two posts.
STATIONS_ASIDE, POSTS_ASIDE = 5, 2
NO_PAIR = Pressed(np.empty((0, 3), np.int64), np.empty((0, 2)), np.empty(0), np.empty((0, 3)))


class Coils(Contact):
    """One-sided bedding between the coils.

    Coils that overlap in the stress-free state, as closed ends do because of rounding and the curve's small error,
    count as just touching there.

    Args:
        points: WirePoints.
        stations: stress-free positions, shape (n, 3), mm.
        bedding: force per length of wire and penetration, N/mm per mm.
        onset: distance over which contact sets in, mm.
        table: of the gauge of a wire that is not round.

    Attributes:
        multiplier_offset: by which each point is pressed beyond its penetration at each place, shape (m, PLACES), mm.
    """

    name, limits_step = "coils", True
    points: WirePoints
    memory: Memory
    multiplier_offset: np.ndarray

    def __init__(
        self,
        points: WirePoints,
        stations: np.ndarray,
        bedding: float,
        onset: float,
        table: np.ndarray = ROUND,
    ):
        self.points, self.onset, self._room = points, onset, max(FEW, len(points))
        self.stiffness, self.lengths = 0.5 * bedding * points.length, points.length
        self.overlap = np.zeros((len(points), PLACES))
        self._y = np.column_stack([stations, points.line.radius])  # stations of the last search, with their radii
        line = points.line
        self._curve = Curve(self._y, line.turns, line.first, line.cubic)
        across = outwards(points, stations) if len(table) else np.zeros((len(points), 2))
        shape = across, table
        self._points = Points(points.weights, points.stations, points.radius, points.turns, self.overlap, *shape)
        self._bedding = Bedding(points.weights, points.element, line.dofs, self.stiffness, onset, *shape)
        farthest, steepest = extremes(table)  # of a gap that changes faster than the distance
        self._widest, self._all_elements = float(points.line.radius.max()), np.array([[0, len(points.line.lengths)]])
        self._skin = SKIN * self._widest
        if len(table):
            self._widest *= farthest * (1.0 + 0.5 * SKIN)
        self.aside = STATIONS_ASIDE + POSTS_ASIDE * post_stride(self._widest, longest_element(self._y))
        pair, where, _ = self.near(TrialPositions(stations, np.empty(0)))
        np.minimum.at(self.overlap, self.places(pair, where), where[:, 1])
        first = points.stations[:, 0]
        self.memory = Memory({"multiplier_offset": first}, multiplier_offset=np.zeros_like(self.overlap))
        self.multiplier_offset = self.memory["multiplier_offset"]
        self._amplification = steepest * points.line.amplification()
        none = np.empty(0)
        self._nothing = Contribution(
            np.empty((0, PAIR), np.int64),
            np.empty((0, PAIR)),
            np.empty((0, PAIR, PAIR)),
            none,
            none,
            np.empty(0, np.int64),
            none,
        )
        self._clear: tuple[np.ndarray, float] | None = None  # where all gaps were greater than a distance
        self._last: tuple[TrialPositions, Pressed] | None = None  # of the last evaluation, for friction

    def places(self, pair: np.ndarray, where: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Indices of pairs into arrays of points and places, see `place`."""
        i = pair[:, 0]
        return i, places(self.points.turns, self.points.line.turns, pair, where)

    def near(self, trial: TrialPositions, margin: float = 0.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Pairs of points and locations nearer than `margin`, see `near_locations`, and the points' positions."""
        points, part = self.points, trial.part
        p, active = np.empty((len(points), 3)), trial.points(points)
        self._y[:, :3] = trial.x
        elements = self._all_elements if part is None else part.elements
        searched = Searched(elements, self._widest, longest_element(self._y))
        while True:
            pair, where = np.empty((self._room, 3), np.int64), np.empty((self._room, 2))
            out = Locations(p, pair, where)
            found = near_locations(active, self._points, self._curve, margin, searched, out)
            if found <= self._room:
                return pair[:found], where[:found], p
            self._room = 2 * found

    def pressed(self, trial: TrialPositions) -> Pressed:
        """`search`, or what the evaluation of this very trial state has found."""
        return self._last[1] if self._last is not None and self._last[0] is trial else self.search(trial)

    def search(self, trial: TrialPositions, lift: float = 0.0) -> Pressed:
        """Pairs in contact, with ξ and gaps, their offsets, and the points' positions; these only if there are pairs.

        Those whose gaps are smaller than `lift`, mm, up to the skin, count as in contact.

        Nothing is sought while no two points can have come closer by the gap that was found clear. The weights of a
        point's stations add up to 1: it moves against another by no more than `amplification` times the diagonal of the
        box around the stations' motions. Pairs that have no station of this rank are left to the others.
        """
        offsets = self.multiplier_offset
        margin = greatest(offsets) + lift
        if self._clear is not None:
            there, clearance = self._clear
            if self._amplification * relative_motion(there, trial.x) < clearance - margin:
                return NO_PAIR
        pair, where, p = self.near(trial, margin + self._skin)
        offset = np.empty(len(pair))
        raised = offsets + lift if lift else offsets
        count, least = keep_pressing(self.points.turns, self.points.line.turns, raised, pair, where, offset)
        clearance, self._clear = min(margin + self._skin, least), None
        if clearance > margin:
            self._clear = trial.x.copy(), clearance
            return NO_PAIR
        pair, where, offset = pair[:count], where[:count], offset[:count] - lift
        if trial.part is not None:
            own, points = trial.part.own, self.points
            ours = (own[points.stations[pair[:, 0]]] | own[points.line.stations[pair[:, 1]]]).any(axis=1)
            pair, where, offset = pair[ours], where[ours], offset[ours]
        return Pressed(pair, where, offset, p)

    def max_penetration(self, trial: TrialPositions) -> float:
        """Maximum penetration, mm."""
        return -self.near(trial)[1][:, 1].min(initial=0.0)

    def evaluate(self, trial: TrialPositions) -> Contribution:
        """Forces along the connection of closest points, where these touch."""
        pressed = self.search(trial)
        self._last = trial, pressed
        if not len(pressed.pair):
            return self._nothing
        room = Contribution.room(len(pressed.pair), PAIR)
        coil_elements(self._curve, self._bedding, pressed, room)
        return Contribution(*room)

    @property
    def reach(self) -> float:
        """Distance of the centre lines up to which pairs are sought; see Contact."""
        return 2.0 * self._widest + float(self.multiplier_offset.max()) + self._skin

    def augment(self, trial: TrialPositions) -> None:
        """Increase each point's offset at each place by its penetration."""
        self._last = None
        before, after = self.multiplier_offset, np.zeros_like(self.overlap)
        pair, where, _ = self.near(trial, before.max())
        at = self.places(pair, where)
        np.maximum.at(after, at, before[at] - where[:, 1])
        self.memory["multiplier_offset"] = after


def outwards(points: WirePoints, stations: np.ndarray) -> np.ndarray:
    """Horizontal unit vectors across the wire, away from the z axis, shape (m, 2)."""
    slope = curve_weights(points.line.cubic[points.element], points.xi, 1)
    along = np.einsum("mk,mki->mi", slope, stations[points.stations])
    across = np.stack([along[:, 1], -along[:, 0]], axis=1) / np.hypot(along[:, 0], along[:, 1])[:, None]
    return across * np.sign(np.sum(across * points.at(stations)[:, :2], axis=1))[:, None]


@njit(cache=True)
def turns_between(turns: np.ndarray, station_turns: np.ndarray, pair: np.ndarray, where: np.ndarray) -> float:
    """Turns from a point to its location; arguments as in `keep_pressing`, of one pair."""
    e = pair[1]
    return station_turns[e] + where[0] * (station_turns[e + 1] - station_turns[e]) - turns[pair[0]]


@njit(cache=True)
def places(turns: np.ndarray, station_turns: np.ndarray, pair: np.ndarray, where: np.ndarray) -> np.ndarray:
    """The `place` of each pair; arguments as in `keep_pressing`."""
    found = np.empty(len(pair), np.int64)
    for k in range(len(pair)):
        found[k] = place(turns_between(turns, station_turns, pair[k], where[k]))
    return found


@njit(cache=True)
def keep_pressing(
    turns: np.ndarray,
    station_turns: np.ndarray,
    offsets: np.ndarray,
    pair: np.ndarray,
    where: np.ndarray,
    offset: np.ndarray,
) -> tuple[int, float]:
    """Move those of the pairs to the front whose gaps are smaller than their offsets, and write these.

    Args:
        turns, station_turns: of points and stations.
        offsets: of the points at each place, shape (m, PLACES), mm.
        pair, where: of `near_locations`; the others are overwritten.
        offset: written, of the pairs.

    Returns:
        Their number, and the least gap of all pairs, mm, infinite if there are none.
    """
    count, least = 0, np.inf
    for k in range(len(pair)):
        least = min(least, where[k, 1])
        own = offsets[pair[k, 0], place(turns_between(turns, station_turns, pair[k], where[k]))]
        if where[k, 1] < own:
            for j in range(pair.shape[1]):  # slices in the place of these loops take numba three seconds to compile
                pair[count, j] = pair[k, j]
            for j in range(where.shape[1]):
                where[count, j] = where[k, j]
            offset[count] = own
            count += 1
    return count, least
