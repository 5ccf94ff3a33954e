"""Wire on wire: each station against the closest point of the neighbouring coils, wherever that is.

The gap is the distance of a station from the polygon of the other coil less the radii there. Both coils look for the
other with half of the bedding each, so that neither is the master.
"""

import math

import numpy as np
from numba import njit

from coilset.model.contact.base import Contribution, one_sided

FARTHEST = 0.5  # turns between two points of the wire that may touch, at least
BEYOND = 0.25  # turns by which the neighbouring place may lie beyond the wire's end


@njit(cache=True)
def closest_points(x, radius, rod_radius, turns, station, start, a, xi, gap):
    """Closest point of the polygon for each candidate.

    Args:
        x: station positions, shape (n, 3); radius, turns: wire radius and turn of the stations, shape (n,).
        rod_radius: wire radius of the elements, shape (n - 1,).
        station, start: for each candidate its station and where on the other coil to begin, shape (m,).
        a, xi, gap: written: the element's first station, the abscissa on it, the gap, shape (m,).
    """
    n = len(x)
    for m in range(len(station)):
        i, j = station[m], start[m]
        here = _distance2(x, i, j)
        for _ in range(n):  # walk along the coil as long as it comes nearer, but not to the coil of the station
            step = 0
            for direction in (-1, 1):
                k = j + direction
                if 0 <= k < n and abs(turns[k] - turns[i]) >= FARTHEST and _distance2(x, i, k) < here:
                    step, here = direction, _distance2(x, i, k)
            if step == 0:
                break
            j += step
        gap[m] = math.inf
        for first in (j - 1, j):
            if first < 0 or first + 1 >= n:
                continue
            e2 = qe = 0.0
            for k in range(3):
                e = x[first + 1, k] - x[first, k]
                e2 += e * e
                qe += (x[i, k] - x[first, k]) * e
            t = min(max(qe / e2, 0.0), 1.0)
            d2 = 0.0
            for k in range(3):
                q = x[i, k] - x[first, k] - t * (x[first + 1, k] - x[first, k])
                d2 += q * q
            g = math.sqrt(d2) - radius[i] - rod_radius[first]
            if g < gap[m]:
                gap[m], a[m], xi[m] = g, first, t


@njit(cache=True)
def _distance2(x, i, j):
    return (x[i, 0] - x[j, 0]) ** 2 + (x[i, 1] - x[j, 1]) ** 2 + (x[i, 2] - x[j, 2]) ** 2


def distance_derivatives(q, e, xi):
    """Gradient and second derivative of the distance by the station and the two ends of the other coil's element.

    With the closest point's abscissa ξ eliminated where it is inside the element: D = ½ q·q with q = A u,
    A = [1, −(1−ξ), −ξ], has D_uu = AᵀA − D_uξ D_uξᵀ/(e·e), D_uξ = −(Aᵀe + [0, −q, q]); d = √(2D).

    Args:
        q: from the closest point to the station, shape (m, 3), mm.
        e: the element's chord, shape (m, 3), mm.
        xi: abscissae, shape (m,), 0 and 1 where the closest point is a station.

    Returns:
        Shapes (m, 9) and (m, 9, 9).
    """
    A = np.zeros((len(q), 3, 9))
    for k in range(3):
        A[:, k, k], A[:, k, 3 + k], A[:, k, 6 + k] = 1.0, xi - 1.0, -xi
    length = np.linalg.norm(q, axis=1)
    d_u = np.einsum("mki,mk->mi", A, q) / length[:, None]
    D_uu = np.einsum("mki,mkj->mij", A, A)
    D_ux = -np.einsum("mki,mk->mi", A, e)
    D_ux[:, 3:6] += q
    D_ux[:, 6:9] -= q
    inside = np.where((xi > 0.0) & (xi < 1.0), 1.0 / np.einsum("mk,mk->m", e, e), 0.0)
    D_uu -= inside[:, None, None] * D_ux[:, :, None] * D_ux[:, None, :]
    return d_u, (D_uu - d_u[:, :, None] * d_u[:, None, :]) / length[:, None, None]


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
        self.rod_radius = 0.5 * (self.radius[1:] + self.radius[:-1])
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

    def evaluate(self, x, seats):
        """Forces along the connection of closest points, for the candidates that touch."""
        m = len(self.station)
        a, xi, gap = np.zeros(m, np.int64), np.zeros(m), np.empty(m)
        closest_points(x, self.radius, self.rod_radius, self.turns, self.station, self.start, a, xi, gap)
        touching = np.flatnonzero(gap < 0.0)
        i, a, xi, gap = self.station[touching], a[touching], xi[touching], gap[touching]
        e = x[a + 1] - x[a]
        q = x[i] - x[a] - xi[:, None] * e
        grad, second = distance_derivatives(q, e, xi)
        pressure, c = one_sided(gap, self.stiffness[touching], self.onset)
        dofs = (3 * np.stack([i, a, a + 1], axis=1)[:, :, None] + np.arange(3)).reshape(-1, 9)
        k = c[:, None, None] * grad[:, :, None] * grad[:, None, :] - pressure[:, None, None] * second
        return Contribution(dofs, -pressure[:, None] * grad, k, pressure, -gap)
