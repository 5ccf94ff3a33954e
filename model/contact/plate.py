"""A seat is a rigid plate: wire points seen from it, and the way back from functions of them to the unknowns.

A plate has six degrees of freedom: its centre c = (x, y, z) and the rotation vector θ. It sees the point p at

    q = A(θ) (p − c),   A = exp(−[θ]),   [θ] a = θ × a.

Every kind of seat is a function of q alone, so that the force on the wire and the force and moment on the plate come
from one potential. To θ belongs Jᵀ M with the moment M about c and J = 1 + ½ [θ] + …: both vanish together.
"""

import numpy as np

from coilset.model.contact.base import ENDS, SEAT_DOFS
from coilset.model.contact.centreline import STENCIL


def cross_matrix(v):
    """[v] with [v] a = v × a, shape (3, 3)."""
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


AXES = np.array([cross_matrix(axis) for axis in np.eye(3)])
TERMS = 18  # of the exponential's series: 1e-16 for a turn by 1 rad, 1e-10 for 2 rad


def turned_back(θ):
    """exp(−[θ]) and its first and second derivatives by θ, from the series.

    Args:
        θ: shape (3,), rad.

    Returns:
        A, ∂A/∂θk and ∂²A/∂θk∂θl, shapes (3, 3), (3, 3, 3) and (3, 3, 3, 3).
    """
    T, E = -cross_matrix(θ), -AXES
    P, D, S = np.eye(3), np.zeros((3, 3, 3)), np.zeros((3, 3, 3, 3))  # Tⁿ/n! and its derivatives
    A, dA, ddA = P.copy(), D.copy(), S.copy()
    for n in range(1, TERMS if θ.any() else 3):
        cross = D[:, None] @ E
        P, D, S = P @ T / n, (D @ T + P @ E) / n, (S @ T + cross + np.swapaxes(cross, 0, 1)) / n
        A, dA, ddA = A + P, dA + D, ddA + S
    return A, dA, ddA


class Plate:
    """The plate of the bottom or the top seat.

    Args:
        end: `bottom` or `top`.
        stations: number of stations n, after whose displacements the seats' degrees of freedom come.
    """

    def __init__(self, end, stations):
        first = SEAT_DOFS * ENDS.index(end)
        self.own = slice(first, first + SEAT_DOFS)
        self.dofs = 3 * stations + np.arange(first, first + SEAT_DOFS)

    def dofs_with(self, points):
        """Degrees of freedom of wire points' stations and of the plate, shape (m, 18)."""
        return np.hstack([points.dofs, np.tile(self.dofs, (len(points.dofs), 1))])

    def sees(self, p, seats):
        """The points `p` from the plate, q, shape (m, 3), mm."""
        c, θ = np.split(seats[self.own], 2)
        return (p - c) @ turned_back(θ)[0].T

    def derivatives(self, p, seats, weights, g, H):
        """Gradient and second derivative of functions φ(q) by stations and plate.

        Args:
            p: points, shape (m, 3), mm.
            seats: of both seats, shape (12,).
            weights: of the points' four stations, shape (m, 4).
            g, H: ∂φ/∂q and ∂²φ/∂q², shapes (m, 3) and (m, 3, 3).

        Returns:
            Arrays of shape (m, 18) and (m, 18, 18): four stations, then the plate.
        """
        c, θ = np.split(seats[self.own], 2)
        A, dA, ddA = turned_back(θ)
        d, m = p - c, len(p)
        dq = np.empty((m, 3, 9))  # by p, c, θ
        dq[:, :, :3], dq[:, :, 3:6] = A, -A
        dq[:, :, 6:] = np.einsum("kij,mj->mik", dA, d)
        gradient = np.einsum("mi,miv->mv", g, dq)
        second = np.swapaxes(dq, 1, 2) @ H @ dq
        mixed = np.einsum("mi,kij->mjk", g, dA)  # by p and θ
        for rows, part in ((slice(0, 3), mixed), (slice(3, 6), -mixed)):
            second[:, rows, 6:] += part
            second[:, 6:, rows] += np.swapaxes(part, 1, 2)
        second[:, 6:, 6:] += np.einsum("mi,klij,mj->mkl", g, ddA, d)
        spread = np.zeros((m, 3 * STENCIL + SEAT_DOFS, 9))  # from the points to their stations
        for k in range(3):
            spread[:, k : 3 * STENCIL : 3, k] = weights
        spread[:, 3 * STENCIL :, 3:] = np.eye(SEAT_DOFS)
        return (spread @ gradient[:, :, None])[..., 0], spread @ second @ np.swapaxes(spread, 1, 2)


def radial(q):
    """Distance ρ from the plate's axis, with gradient and second derivative by q; shapes (m,), (m, 3), (m, 3, 3)."""
    ρ = np.hypot(q[:, 0], q[:, 1])
    e = np.column_stack([q[:, :2] / ρ[:, None], np.zeros(len(q))])
    return ρ, e, (np.diag([1.0, 1.0, 0.0]) - e[:, :, None] * e[:, None, :]) / ρ[:, None, None]
