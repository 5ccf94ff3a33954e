"""Wire on wire: points of the wire against the closest places of the other coils, wherever these are.

The gap is the distance from the point to the other coil's centre line less both radii there. Both coils look for the
other with half of the bedding each, so that neither is the master.
"""

import numpy as np
from numba import njit

from coilset.model.contact.base import Contribution, one_sided
from coilset.model.contact.centreline import STENCIL
from coilset.model.contact.memory import Memory
from coilset.model.contact.search import near_places, place

PLACES = 4  # places of other coils that a point touches, in the mean, before the arrays are enlarged


@njit(cache=True, error_model="numpy")
def gap_derivatives(p, weights, y, first, cubic, pair, xi, grad, hessian):
    """Gradient and second derivative of the gaps by the eight stations of each pair.

    With q = Σ a_m x_m from the place to the point, d = |q|, n = q/d, P = (1 − n nᵀ)/d and a′ = ∂a/∂ξ the gap
    g(u, ξ) = d − r_p − r(ξ) has

        g_u = a n,   g_uξ = a′ n − a P c′,   g_ξξ = c′ P c′ − n c″ − r″,   g_uu = a aᵀ P − g_uξ g_uξᵀ / g_ξξ,

    the last with ξ eliminated by g_ξ = 0; at the wire's end ξ stays and the last term falls away.

    Args:
        p, weights: points and the weights of their four stations, shapes (m, 3) and (m, 4).
        y, first, cubic, pair, xi: as in `near_places`.
        grad, hessian: written, shapes (pairs, 24) and (pairs, 24, 24).
    """
    c, dc, ddc = np.empty(4), np.empty(4), np.empty(4)
    n, a, da, P, Pc, mixed = np.empty(3), np.zeros(8), np.zeros(8), np.empty((3, 3)), np.empty(3), np.empty(24)
    for m in range(len(pair)):
        i, e, t = pair[m, 0], pair[m, 1], xi[m]
        place(y, first, cubic, e, t, c, 0)
        place(y, first, cubic, e, t, dc, 1)
        place(y, first, cubic, e, t, ddc, 2)
        d = np.sqrt((p[i, 0] - c[0]) ** 2 + (p[i, 1] - c[1]) ** 2 + (p[i, 2] - c[2]) ** 2)
        for k in range(3):
            n[k] = (p[i, k] - c[k]) / d
        for k in range(4):
            w = cubic[e, k]
            a[k] = weights[i, k]
            a[4 + k] = -(w[0] + t * (w[1] + t * (w[2] + t * w[3])))
            da[4 + k] = -(w[1] + t * (2.0 * w[2] + t * 3.0 * w[3]))
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
        onset: way over which contact sets in, mm.
    """

    name, end = "coils", None
    guarded, rolls = True, False

    def __init__(self, points, stations, bedding, onset):
        self.points, self.onset = points, onset
        self.stiffness, self.lengths = 0.5 * bedding * points.length, points.length
        self.overlap = np.zeros((len(points), 2))
        pair, where, _ = self.near(stations)
        np.minimum.at(self.overlap, self.sides(pair), where[:, 1])
        self.memory = Memory(lift=np.zeros_like(self.overlap))

    def sides(self, pair):
        """Indices of pairs into arrays of points and sides: the coil before a point, and the one after it."""
        i = pair[:, 0]
        return i, (self.points.line.turns[pair[:, 1]] > self.points.turns[i]).astype(int)

    def near(self, x, margin=0.0):
        """Pairs of points and places nearer than `margin`, see `near_places`, and the points' positions."""
        points, line = self.points, self.points.line
        y, p, capacity = np.column_stack([x, line.radius]), points.at(x), PLACES * len(points)
        while True:
            pair, where = np.empty((capacity, 3), np.int64), np.empty((capacity, 2))
            found = near_places(p, points.radius, points.turns, y, line.turns, line.first, line.cubic,
                                self.overlap, margin, pair, where)  # fmt: skip
            if found <= capacity:
                return pair[:found], where[:found], p
            capacity = found

    def pressed(self, x):
        """Pairs that bear, with places and gaps, their lifts, and the points' positions."""
        pair, where, p = self.near(x, self.memory["lift"].max())
        lift = self.memory["lift"][self.sides(pair)]
        bears = where[:, 1] < lift
        return pair[bears], where[bears], lift[bears], p

    def depth(self, x, seats):
        """Greatest penetration, mm."""
        return -self.near(x)[1][:, 1].min(initial=0.0)

    def evaluate(self, x, seats):
        """Forces along the connection of closest places, for the points that touch."""
        points, line = self.points, self.points.line
        pair, where, lift, p = self.pressed(x)
        i, m = pair[:, 0], len(pair)
        size = 6 * STENCIL
        grad, hessian = np.empty((m, size)), np.empty((m, size, size))
        y = np.column_stack([x, line.radius])
        gap_derivatives(p, points.weights, y, line.first, line.cubic, pair, where[:, 0], grad, hessian)
        pressure, c = one_sided(where[:, 1] - lift, self.stiffness[i], self.onset)
        k = c[:, None, None] * grad[:, :, None] * grad[:, None, :] - pressure[:, None, None] * hessian
        dofs = np.hstack([points.dofs[i], line.dofs[pair[:, 1]]])
        return Contribution(dofs, -pressure[:, None] * grad, k, pressure, -where[:, 1], i)

    def augment(self, x, seats):
        """Press each point by as much more as it has sunk in."""
        lift = self.memory["lift"].copy()
        pair, where, _ = self.near(x, lift.max())
        sides, self.memory["lift"] = self.sides(pair), np.zeros_like(lift)
        np.maximum.at(self.memory["lift"], sides, lift[sides] - where[:, 1])
