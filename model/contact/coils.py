"""Wire on wire: each station against the closest point of the neighbouring coils, wherever that is.

Between its stations a coil is the smooth curve through them (Catmull and Rom's cubic: its tangent is continuous). A
polygon would not do: coils of a cone slide over each other, and would roll over its corners. The gap is the distance to
the curve less the wires' radii. Both coils look for the other with half of the bedding each: neither is the master.
"""

import math

import numpy as np
from numba import njit

from coilset.model.contact.base import Contribution, one_sided

FARTHEST = 0.5  # turns between two points of the wire that may touch, at least
BEYOND = 0.25  # turns by which the neighbouring place may lie beyond the wire's end
# x(ξ) = Σ c_k(ξ) x_{a−1+k} with c_k = Σ CUBIC[k, p] ξ^p
CUBIC = 0.5 * np.array([[0.0, -1.0, 2.0, -1.0], [2.0, 0.0, -5.0, 3.0], [0.0, 1.0, 4.0, -3.0], [0.0, 0.0, -1.0, 1.0]])
END = np.array([3.0, -3.0, 1.0])  # the missing neighbour of a tip continues a parabola


@njit(cache=True)
def weights(xi, a, n, c):
    """Weights of the stations a−1 … a+2 on the curve at ξ of element a, and their first two derivatives.

    Written into `c`, shape (3, 4); beside a tip the weight of the missing station is handed to its neighbours.
    """
    for k in range(4):
        p0, p1, p2, p3 = CUBIC[k, 0], CUBIC[k, 1], CUBIC[k, 2], CUBIC[k, 3]
        c[0, k] = p0 + xi * (p1 + xi * (p2 + xi * p3))
        c[1, k] = p1 + xi * (2.0 * p2 + xi * 3.0 * p3)
        c[2, k] = 2.0 * p2 + xi * 6.0 * p3
    for row in range(3):
        if a == 0:
            for k in range(3):
                c[row, 1 + k] += END[k] * c[row, 0]
            c[row, 0] = 0.0
        elif a == n - 2:
            for k in range(3):
                c[row, 2 - k] += END[k] * c[row, 3]
            c[row, 3] = 0.0


@njit(cache=True)
def _distance2(x, i, j):
    return (x[i, 0] - x[j, 0]) ** 2 + (x[i, 1] - x[j, 1]) ** 2 + (x[i, 2] - x[j, 2]) ** 2


@njit(cache=True)
def _nearest_station(x, turns, i, j):
    """Walk along the coil as long as it comes nearer to station i, but not to the coil of the station itself."""
    here = _distance2(x, i, j)
    for _ in range(len(x)):
        step = 0
        for direction in (-1, 1):
            k = j + direction
            if 0 <= k < len(x) and abs(turns[k] - turns[i]) >= FARTHEST and _distance2(x, i, k) < here:
                step, here = direction, _distance2(x, i, k)
        if step == 0:
            break
        j += step
    return j


@njit(cache=True)
def _place(x, i, s, c, q, e):
    """Element of the curve's parameter s, and q, e = x_c′ at it; returns element, ξ, q·e and e·e − q·x_c″."""
    n = len(x)
    a = min(max(int(s), 0), n - 2)
    xi = s - a
    weights(xi, a, n, c)
    slope, curvature = 0.0, 0.0
    for k in range(3):
        point = d1 = d2 = 0.0
        for b in range(4):
            station = min(max(a - 1 + b, 0), n - 1)
            point += c[0, b] * x[station, k]
            d1 += c[1, b] * x[station, k]
            d2 += c[2, b] * x[station, k]
        q[k], e[k] = x[i, k] - point, d1
        slope += q[k] * d1
        curvature += d1 * d1 - q[k] * d2
    return a, xi, slope, curvature


@njit(cache=True)
def closest_points(x, radius, turns, station, start, a, c, q, e, inverse, gap):
    """Closest point of the neighbouring curve for each candidate.

    Args:
        x: station positions, shape (n, 3); radius, turns: wire radius and turn of the stations, shape (n,).
        station, start: for each candidate its station and where on the other coil to begin, shape (m,).
        a, c, q, e: written: element, weights, from the closest point to the station, and the curve's derivative there.
        inverse: written, 1/D_ξξ, 0 at a tip where the closest point is not free, shape (m,).
        gap: written, distance less the radii, shape (m,), mm.
    """
    last = len(x) - 1.0
    for m in range(len(station)):
        i = station[m]
        s = float(_nearest_station(x, turns, i, start[m]))
        for _ in range(30):  # Newton for q·e = 0 along the curve
            a[m], xi, slope, curvature = _place(x, i, s, c[m], q[m], e[m])
            move = slope / curvature if curvature > 0.0 else math.copysign(0.5, slope)
            new = min(max(s + min(max(move, -0.5), 0.5), 0.0), last)
            if abs(new - s) < 1e-13:
                break
            s = new
        inverse[m] = 1.0 / curvature if 0.0 < s < last and curvature > 0.0 else 0.0
        other = radius[a[m]] + xi * (radius[a[m] + 1] - radius[a[m]])
        gap[m] = math.sqrt(q[m, 0] ** 2 + q[m, 1] ** 2 + q[m, 2] ** 2) - radius[i] - other


def gap_derivatives(c, q, e, inverse, growth):
    """Gradient and second derivative of the gap by the station and the four that carry the curve.

    With the closest point's ξ eliminated: D = ½ q·q with q = A u, A = [1, −c_k], has
    D_uu = AᵀA − D_uξ D_uξᵀ/D_ξξ, D_uξ = −(Aᵀe + [0, c_k′ q]); d = √(2D).

    A wire that grows thicker along the curve adds −r_ξ ξ_u to the gradient, ξ_u = −D_uξ/D_ξξ; what that adds to the
    second derivative is left out (below 2e-3 of the stiffness for 0.4 mm on 2.5 turns, tested).

    Args:
        c: weights and derivatives, shape (m, 3, 4); q, e: shape (m, 3); inverse: 1/D_ξξ, growth: r_ξ, shape (m,).

    Returns:
        Shapes (m, 15) and (m, 15, 15).
    """
    m = len(q)
    along = np.concatenate([np.ones((m, 1)), -c[:, 0]], axis=1)
    length = np.maximum(np.linalg.norm(q, axis=1), np.finfo(float).tiny)  # a line search may lay one point on another
    d_u = (along[:, :, None] * q[:, None, :]).reshape(m, 15) / length[:, None]
    D_uu = np.einsum("ma,mb,kl->makbl", along, along, np.eye(3)).reshape(m, 15, 15)
    slope = np.concatenate([np.zeros((m, 1)), c[:, 1]], axis=1)
    D_ux = -(along[:, :, None] * e[:, None, :] + slope[:, :, None] * q[:, None, :]).reshape(m, 15)
    D_uu -= inverse[:, None, None] * D_ux[:, :, None] * D_ux[:, None, :]
    second = (D_uu - d_u[:, :, None] * d_u[:, None, :]) / length[:, None, None]
    return d_u + (growth * inverse)[:, None] * D_ux, second


class Coils:
    """One-sided bedding between the coils.

    Args:
        turns: turn of the stations, shape (n,).
        radius: wire radius at the stations, shape (n,), mm.
        stiffness: bedding times the length of wire of each station, shape (n,), N/mm.
        onset: way over which contact sets in, mm.
    """

    name = "coils"

    def __init__(self, turns, radius, stiffness, onset):
        self.turns, self.radius, self.onset = np.asarray(turns, float), np.asarray(radius, float), onset
        station, start = [], []
        for side in (-1.0, 1.0):
            place = self.turns + side
            mine = np.flatnonzero((place > self.turns[0] - BEYOND) & (place < self.turns[-1] + BEYOND))
            station.append(mine)
            start.append(np.clip(np.searchsorted(self.turns, place[mine] - 1e-9), 0, len(self.turns) - 1))
        self.station, self.start = np.concatenate(station), np.concatenate(start)
        far = np.abs(self.turns[self.start] - self.turns[self.station]) >= FARTHEST
        self.station, self.start = self.station[far], self.start[far]
        self.stiffness = 0.5 * np.asarray(stiffness, float)[self.station]

    def closest(self, x):
        """Element, weights, q, x_c′, 1/D_ξξ and gap of all candidates, see `closest_points`."""
        m = len(self.station)
        found = np.zeros(m, np.int64), np.empty((m, 3, 4)), np.empty((m, 3)), np.empty((m, 3)), np.empty(m), np.empty(m)
        closest_points(x, self.radius, self.turns, self.station, self.start, *found)
        return found

    def evaluate(self, x, seats):
        """Forces along the connection of closest points, for the candidates that touch."""
        a, c, q, e, inverse, gap = self.closest(x)
        touching = np.flatnonzero(gap < 0.0)
        a, c, q, e, inverse, gap = (values[touching] for values in (a, c, q, e, inverse, gap))
        grad, second = gap_derivatives(c, q, e, inverse, self.radius[a + 1] - self.radius[a])
        pressure, stiffness = one_sided(gap, self.stiffness[touching], self.onset)
        carriers = np.clip(a[:, None] + np.arange(-1, 3), 0, len(x) - 1)
        stations = np.concatenate([self.station[touching, None], carriers], axis=1)
        dofs = (3 * stations[:, :, None] + np.arange(3)).reshape(-1, 15)
        k = stiffness[:, None, None] * grad[:, :, None] * grad[:, None, :] - pressure[:, None, None] * second
        return Contribution(dofs, -pressure[:, None] * grad, k, pressure, -gap)
