"""Wire on wire: points of the wire against the closest points of the other coils, wherever these are.

The gap is the distance from the point to the other coil's centre line less both radii there. Both coils look for the
other with half of the bedding each, so that neither is the master.
"""

import numpy as np
from numba import njit

from coilset.model.contact.base import Contribution, TrialPositions, one_sided
from coilset.model.contact.curve import STENCIL, WirePoints, point_on_curve, station_weight
from coilset.model.contact.memory import Memory
from coilset.model.contact.search import near_locations

LOCATIONS_PER_POINT = 4  # on other coils, in the mean over the points, for which there is room at first


@njit(cache=True, error_model="numpy")
def gap_derivatives(
    p: np.ndarray,
    weights: np.ndarray,
    y: np.ndarray,
    first: np.ndarray,
    cubic: np.ndarray,
    pair: np.ndarray,
    xi: np.ndarray,
    grad: np.ndarray,
    hessian: np.ndarray,
) -> None:
    """Gradient and second derivative of the gaps by the eight stations of each pair.

    With q = Σ a_m x_m from the other coil to the point, d = |q|, n = q/d, P = (1 − n nᵀ)/d and a′ = ∂a/∂ξ the gap
    g(u, ξ) = d − r_p − r(ξ) has

        g_u = a n,   g_uξ = a′ n − a P c′,   g_ξξ = c′ P c′ − n c″ − r″,   g_uu = a aᵀ P − g_uξ g_uξᵀ / g_ξξ,

    the last with ξ eliminated by g_ξ = 0; at the wire's end ξ stays and the last term falls away.

    Args:
        p, weights: points and the weights of their four stations, shapes (m, 3) and (m, 4).
        y, first, cubic, pair, xi: as in `near_locations`.
        grad, hessian: written, shapes (pairs, 24) and (pairs, 24, 24).
    """
    c, dc, ddc = np.empty(4), np.empty(4), np.empty(4)
    n, a, da, P, Pc, mixed = np.empty(3), np.zeros(8), np.zeros(8), np.empty((3, 3)), np.empty(3), np.empty(24)
    for m in range(len(pair)):
        i, e, t = pair[m, 0], pair[m, 1], xi[m]
        point_on_curve(y, first, cubic, e, t, c, 0)
        point_on_curve(y, first, cubic, e, t, dc, 1)
        point_on_curve(y, first, cubic, e, t, ddc, 2)
        d = np.sqrt((p[i, 0] - c[0]) ** 2 + (p[i, 1] - c[1]) ** 2 + (p[i, 2] - c[2]) ** 2)
        for k in range(3):
            n[k] = (p[i, k] - c[k]) / d
        for k in range(4):
            a[k] = weights[i, k]
            a[4 + k] = -station_weight(cubic[e, k], t, 0)
            da[4 + k] = -station_weight(cubic[e, k], t, 1)
        second = -ddc[3]
        for k in range(3):
            Pc[k] = 0.0
            for l in range(3):
                P[k, l] = ((1.0 if k == l else 0.0) - n[k] * n[l]) / d
                Pc[k] += P[k, l] * dc[l]
            second += dc[k] * Pc[k] - n[k] * ddc[k]
        eliminated = 1.0 / second if pair[m, 2] and second > 0.0 else 0.0
        for s in range(8):
            for k in range(3):
                grad[m, 3 * s + k] = a[s] * n[k]
                mixed[3 * s + k] = da[s] * n[k] - a[s] * Pc[k]
        for s in range(8):
            for k in range(3):
                for v in range(8):
                    for l in range(3):
                        hessian[m, 3 * s + k, 3 * v + l] = (
                            a[s] * a[v] * P[k, l] - eliminated * mixed[3 * s + k] * mixed[3 * v + l]
                        )


class Coils:
    """One-sided bedding between the coils.

    Coils that overlap in the stress-free state, as closed ends do by the rounding of their pitch and the curve's small
    error, count as touching there.

    Args:
        points: WirePoints.
        stations: stress-free positions, shape (n, 3), mm.
        bedding: force per length of wire and penetration, N/mm per mm.
        onset: distance over which contact sets in, mm.
    """

    name, end, needs_rotations = "coils", None, False

    def __init__(self, points: WirePoints, stations: np.ndarray, bedding: float, onset: float):
        self.points, self.onset = points, onset
        self.stiffness, self.lengths = 0.5 * bedding * points.length, points.length
        self.overlap = np.zeros((len(points), 2))
        pair, where, _ = self.near(stations)
        np.minimum.at(self.overlap, self.sides(pair), where[:, 1])
        self.memory = Memory(multiplier_offset=np.zeros_like(self.overlap))

    @property
    def multiplier_offset(self) -> np.ndarray:
        """Distance by which each point is pressed beyond its penetration, for the coil before and after, mm."""
        return self.memory["multiplier_offset"]

    def sides(self, pair: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Indices of pairs into arrays of points and sides: the coil before a point, and the one after it."""
        i = pair[:, 0]
        return i, (self.points.line.turns[pair[:, 1]] > self.points.turns[i]).astype(int)

    def near(self, x: np.ndarray, margin: float = 0.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Pairs of points and locations nearer than `margin`, see `near_locations`, and the points' positions."""
        points, line = self.points, self.points.line
        y, p, capacity = np.column_stack([x, line.radius]), points.at(x), LOCATIONS_PER_POINT * len(points)
        while True:
            pair, where = np.empty((capacity, 3), np.int64), np.empty((capacity, 2))
            found = near_locations(p, points.radius, points.turns, y, line.turns, line.first, line.cubic,
                                   self.overlap, margin, pair, where)  # fmt: skip
            if found <= capacity:
                return pair[:found], where[:found], p
            capacity = found

    def pressed(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Pairs that bear, with ξ and gaps, their offsets, and the points' positions."""
        pair, where, p = self.near(x, self.multiplier_offset.max())
        offset = self.multiplier_offset[self.sides(pair)]
        bears = where[:, 1] < offset
        return pair[bears], where[bears], offset[bears], p

    def max_penetration(self, trial: TrialPositions) -> float:
        """Greatest penetration, mm."""
        return -self.near(trial.x)[1][:, 1].min(initial=0.0)

    def evaluate(self, trial: TrialPositions) -> Contribution:
        """Forces along the connection of closest points, where these touch."""
        points, line = self.points, self.points.line
        pair, where, offset, p = self.pressed(trial.x)
        i, m = pair[:, 0], len(pair)
        size = 6 * STENCIL
        grad, hessian = np.empty((m, size)), np.empty((m, size, size))
        y = np.column_stack([trial.x, line.radius])
        gap_derivatives(p, points.weights, y, line.first, line.cubic, pair, where[:, 0], grad, hessian)
        pressure, c = one_sided(where[:, 1] - offset, self.stiffness[i], self.onset)
        k = c[:, None, None] * grad[:, :, None] * grad[:, None, :] - pressure[:, None, None] * hessian
        dofs = np.hstack([points.dofs[i], line.dofs[pair[:, 1]]])
        onset_force = self.stiffness[i] * self.onset
        return Contribution(dofs, -pressure[:, None] * grad, k, pressure, -where[:, 1], i, onset_force)

    def augment(self, trial: TrialPositions) -> None:
        """Press each point by as much more as it has sunk in."""
        before, after = self.multiplier_offset, np.zeros_like(self.overlap)
        pair, where, _ = self.near(trial.x, before.max())
        sides = self.sides(pair)
        np.maximum.at(after, sides, before[sides] - where[:, 1])
        self.memory["multiplier_offset"] = after
