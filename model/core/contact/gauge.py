"""The gauge of a wire that is not round: a distance between centre lines that is 2 r where two such wires touch.

Two convex sections, neither turned against the other, touch where the one's centre is on the boundary of their
difference D = {b − b′} about the other's. N(q) = |q| κ(α) in the direction α from outwards to upwards is the norm of
which r D is the ball of size 2 r, with r half the height of the wire: N = 2 r on its boundary, and ∇N is normal to it.
A part of q along the wire counts as a distance does,

    N(q) = √(N₂² + t²),   N₂ = ρ κ(α),   ∇N₂ = κ e_ρ + κ′ e_α,   ∇²N₂ = (κ + κ″)/ρ e_α e_αᵀ.

Of round wire κ = 1 and N = |q|. N is the distance from a flat face, too: there κ is a cosine. Sections keep their
direction to the coil: outwards is that of the stress-free wire. A table has the coefficients of κ(α), highest power
first, on equal parts of half a turn, shape (parts, 4); faces.py makes it of a section.
"""

import math

import numpy as np

from coilset.model.core.runtime.kernels import njit

ROUND = np.empty((0, 4))  # the table of round wire
Norm = tuple[float, float, float, float, float, float, float, float, float, float]


def extremes(table: np.ndarray) -> tuple[float, float]:
    """Greatest distance at which wires touch over 2 r, and greatest slope of N."""
    if not len(table):
        return 1.0, 1.0
    κ, slope = table[:, 3], table[:, 2]
    return float(1.0 / κ.min()), float(np.hypot(κ, slope).max())


@njit(cache=True, error_model="numpy")
def gauge(qx: float, qy: float, qz: float, ox: float, oy: float, table: np.ndarray) -> Norm:
    """N, ∇N (x, y, z) and ∇²N (xx, xy, xz, yy, yz, zz) of a distance q, with the unit vector (ox, oy) outwards."""
    r, t = qx * ox + qy * oy, qy * ox - qx * oy
    ρ = max(math.hypot(r, qz), 1e-300)
    α = math.atan2(qz, r)
    if α < 0.0:
        α += math.pi
    step = math.pi / len(table)
    k = min(int(α / step), len(table) - 1)
    u = α - k * step
    a, b, c, κ0 = table[k]
    κ, slope, bend = κ0 + u * (c + u * (b + u * a)), c + u * (2.0 * b + 3.0 * a * u), 2.0 * b + 6.0 * a * u
    cos, sin = r / ρ, qz / ρ
    flat = ρ * κ
    fr, fz, second = κ * cos - slope * sin, κ * sin + slope * cos, (κ + bend) / ρ
    N = math.hypot(flat, t)
    i = 1.0 / N
    gr, gz, gt = flat * fr * i, flat * fz * i, t * i
    rr = (fr * fr + flat * second * sin * sin - gr * gr) * i
    rz = (fr * fz - flat * second * sin * cos - gr * gz) * i
    zz = (fz * fz + flat * second * cos * cos - gz * gz) * i
    rt, zt, tt = -gr * gt * i, -gz * gt * i, (1.0 - gt * gt) * i
    return (
        N,
        gr * ox - gt * oy,
        gr * oy + gt * ox,
        gz,
        rr * ox * ox - 2.0 * rt * ox * oy + tt * oy * oy,
        (rr - tt) * ox * oy + rt * (ox * ox - oy * oy),
        rz * ox - zt * oy,
        rr * oy * oy + 2.0 * rt * ox * oy + tt * ox * ox,
        rz * oy + zt * ox,
        zz,
    )
