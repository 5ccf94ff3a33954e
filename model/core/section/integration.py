"""Resultants and tangent of one section from the law at all of its points.

With S = g ∂(ε11, γ12, γ13)/∂(ε, γ2, γ3, φ′, κ2, κ3) at a point y, z,

        1  0    0    0  z −y
    S = 0  a22  a23 −v  0  0
        0  a32  a33  u  0  0

the strains are S d/g, the resultants ∫ Sᵀ σ dA and their tangent ∫ Sᵀ C S dA/g. The kinds of sections differ in g and
in the a. The levers of twist u, v are y, z in a round section; others warp by their twist. Sums over points consist of
several partial sums, so that neighbouring points can be added at once.
"""

import math

import numpy as np

from coilset.model.core.material.law.loop import PointLaw, flow_points
from coilset.model.core.runtime.kernels import INLINE, KERNEL, njit

FIBRES = 5  # rows of `fibres`: y, z, u, v and area
SUMS = KERNEL | {"fastmath": {"contract", "reassoc", "nsz"}, "forceinline": True}
Three = tuple[float, float, float]
NOTHING = (0.0, 0.0, 0.0)


@njit(**INLINE)
def update_points(
    law: PointLaw,
    fibres: np.ndarray,
    shape: np.ndarray,
    d: np.ndarray,
    old: np.ndarray,
    new: np.ndarray,
    strain: np.ndarray,
    C: np.ndarray,
    with_tangent: bool,
    count: np.ndarray,
) -> bool:
    """Advance the points of a section to the end of an increment.

    Args:
        law: of the points.
        fibres: y, z, u, v of the points, mm, and their areas, mm², shape (5, points).
        shape: g, a22, a23, a32, a33 of the points, shape (5, points).
        d: increments of the section strains, shape (6,).
        old, new: states of the points at the start, and at the end, which is written, shape (points, n_state).
        strain: work space, shape (3, points).
        C, with_tangent, count: as in `law.loop.flow_points`.

    Returns:
        Whether the law found a solution at all points.
    """
    y, z, u, v = fibres[0], fibres[1], fibres[2], fibres[3]
    for k in range(len(y)):
        inverse = 1.0 / shape[0, k]
        strain[0, k] = (d[0] + d[4] * z[k] - d[5] * y[k]) * inverse
        strain[1, k] = (shape[1, k] * d[1] + shape[2, k] * d[2] - d[3] * v[k]) * inverse
        strain[2, k] = (shape[3, k] * d[1] + shape[4, k] * d[2] + d[3] * u[k]) * inverse
    return flow_points(law, 3, old, strain, new, C, with_tangent, count)


@njit(**SUMS)
def resultants(fibres: np.ndarray, shape: np.ndarray, new: np.ndarray, s: np.ndarray) -> None:
    """Write N, Q2, Q3, Mt, M2, M3 of the stresses in `new`."""
    y, z, u, v, dA = fibres[0], fibres[1], fibres[2], fibres[3], fibres[4]
    n = q2 = q3 = mt = m2 = m3 = 0.0
    for k in range(len(y)):
        sigma, t2, t3 = new[k, 0] * dA[k], new[k, 1] * dA[k], new[k, 2] * dA[k]
        n += sigma
        q2 += t2 * shape[1, k] + t3 * shape[3, k]
        q3 += t2 * shape[2, k] + t3 * shape[4, k]
        mt += t3 * u[k] - t2 * v[k]
        m2 += sigma * z[k]
        m3 -= sigma * y[k]
    s[0], s[1], s[2], s[3], s[4], s[5] = n, q2, q3, mt, m2, m3


@njit(**SUMS)
def _along_shear(shape: np.ndarray, u: float, v: float, k: int, c2: float, c3: float) -> Three:
    """c2 and c3 times the second and third row of S at the point k, in γ2, γ3, φ′."""
    return (c2 * shape[1, k] + c3 * shape[3, k], c2 * shape[2, k] + c3 * shape[4, k], c3 * u - c2 * v)


@njit(**SUMS)
def _added(total: Three, f: float, row: Three) -> Three:
    """total + f row."""
    return (total[0] + f * row[0], total[1] + f * row[1], total[2] + f * row[2])


@njit(**SUMS)
def tangents(fibres: np.ndarray, shape: np.ndarray, C: np.ndarray, D: np.ndarray) -> None:
    """Write ∂s/∂d of the points' tangents C, shape (9, points), into D, shape (6, 6).

    The rows of S hold either ε, κ2, κ3 or γ2, γ3, φ′: D has four parts, and the sums of each fit into the registers.
    """
    y, z, u, v, dA, g = fibres[0], fibres[1], fibres[2], fibres[3], fibres[4], shape[0]
    c = cy = cz = cyy = cyz = czz = 0.0
    for k in range(len(y)):
        at = C[0, k] * dA[k] / g[k]
        aty, atz = at * y[k], at * z[k]
        c, cy, cz = c + at, cy + aty, cz + atz
        cyy, cyz, czz = cyy + aty * y[k], cyz + aty * z[k], czz + atz * z[k]
    D[0, 0], D[0, 4], D[0, 5], D[4, 4], D[4, 5], D[5, 5] = c, cz, -cy, czz, -cyz, cyy
    D[4, 0], D[5, 0], D[5, 4] = cz, -cy, -cyz
    for side in range(2):  # σ by γ, and τ by ε and its bends
        t = ty = tz = NOTHING
        for k in range(len(y)):
            w = dA[k] / g[k]
            row = _along_shear(shape, u[k], v[k], k, C[3 if side else 1, k] * w, C[6 if side else 2, k] * w)
            t, ty, tz = _added(t, 1.0, row), _added(ty, -y[k], row), _added(tz, z[k], row)
        for j in range(3):
            if side:
                D[1 + j, 0], D[1 + j, 4], D[1 + j, 5] = t[j], tz[j], ty[j]
            else:
                D[0, 1 + j], D[4, 1 + j], D[5, 1 + j] = t[j], tz[j], ty[j]
    t1 = t2 = t3 = NOTHING
    for k in range(len(y)):
        w = dA[k] / g[k]
        second = _along_shear(shape, u[k], v[k], k, C[4, k] * w, C[5, k] * w)
        third = _along_shear(shape, u[k], v[k], k, C[7, k] * w, C[8, k] * w)
        t1 = _added(_added(t1, shape[1, k], second), shape[3, k], third)
        t2 = _added(_added(t2, shape[2, k], second), shape[4, k], third)
        t3 = _added(_added(t3, -v[k], second), u[k], third)
    for j in range(3):
        D[1, 1 + j], D[2, 1 + j], D[3, 1 + j] = t1[j], t2[j], t3[j]


@njit(**KERNEL)
def section(
    law: PointLaw,
    fibres: np.ndarray,
    shape: np.ndarray,
    d: np.ndarray,
    old: np.ndarray,
    new: np.ndarray,
    strain: np.ndarray,
    C: np.ndarray,
    with_tangent: bool,
    count: np.ndarray,
    s: np.ndarray,
    D: np.ndarray,
) -> bool:
    """Resultants s and, if `with_tangent`, their tangent D; arguments as in `update_points` and below.

    Returns:
        False if the law found no solution at some point or the strains are no numbers.
    """
    if not update_points(law, fibres, shape, d, old, new, strain, C, with_tangent, count):
        return False
    resultants(fibres, shape, new, s)
    if with_tangent:
        tangents(fibres, shape, C, D)
    return math.isfinite(s.sum())
