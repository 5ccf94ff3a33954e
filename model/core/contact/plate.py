"""A seat is a rigid plate: wire points in its frame, and derivatives of functions of them by the unknowns.

A plate has six degrees of freedom: its centre c = (x, y, z) and the rotation vector θ. In its frame the point p is at

    q = Rᵀ (p − c),   R = exp([θ]),   [θ] a = θ × a.

Every kind of seat is a function of q alone, so that the force on the wire and the force and moment on the plate come
from one potential. The force conjugate to θ is Tᵀ M, with the moment M about c and the tangent T of the chart; both
vanish together.
"""

import numpy as np

from coilset.model.core.contact.base import ENDS, SEAT_DOFS
from coilset.model.core.contact.curve import STENCIL, WirePoints
from coilset.model.core.rotations.vectors import rotation_derivatives, rotation_matrix


class Plate:
    """The plate of the bottom or the top seat.

    Args:
        end: `bottom` or `top`.
        stations: number of stations n, after whose displacements the seats' degrees of freedom come.
    """

    def __init__(self, end: str, stations: int):
        first = SEAT_DOFS * ENDS.index(end)
        self.own = slice(first, first + SEAT_DOFS)
        self.dofs = 3 * stations + np.arange(first, first + SEAT_DOFS)

    def dofs_with(self, points: WirePoints) -> np.ndarray:
        """Degrees of freedom of wire points' stations and of the plate, shape (m, 18)."""
        return np.hstack([points.dofs(), np.tile(self.dofs, (len(points), 1))])

    def to_seat_frame(self, p: np.ndarray, seats: np.ndarray) -> np.ndarray:
        """The points `p` in the plate's frame, q, shape (m, 3), mm."""
        c, θ = np.split(seats[self.own], 2)
        return (p - c) @ rotation_matrix(θ)

    def derivatives(
        self, p: np.ndarray, seats: np.ndarray, weights: np.ndarray, g: np.ndarray, H: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
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
        R, dR, ddR = rotation_derivatives(θ)
        d, m = p - c, len(p)
        dq = np.empty((m, 3, 9))  # by p, c, θ
        dq[:, :, :3], dq[:, :, 3:6] = R.T, -R.T
        dq[:, :, 6:] = np.einsum("kji,mj->mik", dR, d)
        gradient = np.einsum("mi,miv->mv", g, dq)
        second = np.swapaxes(dq, 1, 2) @ H @ dq
        mixed = np.einsum("mi,kji->mjk", g, dR)  # by p and θ
        for rows, part in ((slice(0, 3), mixed), (slice(3, 6), -mixed)):
            second[:, rows, 6:] += part
            second[:, 6:, rows] += np.swapaxes(part, 1, 2)
        second[:, 6:, 6:] += np.einsum("mi,klji,mj->mkl", g, ddR, d)
        spread = np.zeros((m, 3 * STENCIL + SEAT_DOFS, 9))  # from the points to their stations
        for k in range(3):
            spread[:, k : 3 * STENCIL : 3, k] = weights
        spread[:, 3 * STENCIL :, 3:] = np.eye(SEAT_DOFS)
        return (spread @ gradient[:, :, None])[..., 0], spread @ second @ np.swapaxes(spread, 1, 2)


def radial(q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Distance ρ from the plate's axis, with gradient and second derivative by q; shapes (m,), (m, 3), (m, 3, 3)."""
    ρ = np.hypot(q[:, 0], q[:, 1])
    e = np.column_stack([q[:, :2] / ρ[:, None], np.zeros(len(q))])
    return ρ, e, (np.diag([1.0, 1.0, 0.0]) - e[:, :, None] * e[:, None, :]) / ρ[:, None, None]
