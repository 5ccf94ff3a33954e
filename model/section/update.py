"""One pass over the section points: strains, material law, section resultants and section tangent (5.2.42)."""

import math

import numpy as np
from numba import njit

from coilset.model.material.functions import INLINE
from coilset.model.material.rod import return_map


@njit(cache=True)
def update_sections(p, y, z, w, radius, de, placement, stretch, old, new, s, D):
    """Bring all sections to the end of the increment.

    The strains of the chord axis are carried to the true section by `placement` (identity for a straight rod), the
    resultants back by its transpose; with ds/dx = `stretch` the virtual work is that of the true centre line.

    Args:
        p: parameters of the material law.
        y, z, w: points of the unit disk and weights, shape (points,).
        radius: wire radius of each element, shape (cells,), mm.
        de: increments of the section strains ε, γ12, γ13, φ′, κ2 = −w″, κ3 = v″, shape (cells, 2, 6).
        placement: shape (cells or 1, 2, 6, 6), stretch: ds/dx, shape (cells or 1, 2).
        old: state at the last equilibrium, shape (cells, 2, points, n_state); not changed.
        new: written, the state at the end of the increment.
        s: written, N, Q2, Q3 in N and Mt, M2, M3 in N mm, shape (cells, 2, 6), about the chord axis.
        D: written, section tangent ds/de, shape (cells, 2, 6, 6).

    Returns:
        0, or -1 if the law found no solution at some point or the strains are no numbers: then the step must be cut.
    """
    d = np.empty(6)
    C = np.empty((3, 3))
    resultant = np.empty(6)
    tangent = np.empty((6, 6))
    straight = len(placement) == 1
    for c in range(len(radius)):
        R = radius[c]
        area = math.pi * R * R
        for g in range(2):
            P = placement[0 if straight else c, g]
            for i in range(6):
                d[i] = de[c, g, i]
            if not straight:
                for i in range(6):
                    d[i] = 0.0
                    for j in range(6):
                        d[i] += P[i, j] * de[c, g, j]
            resultant[:] = 0.0
            tangent[:] = 0.0
            for k in range(len(w)):
                if not integrate_point(p, R * y[k], R * z[k], area * w[k], d, old[c, g, k], new[c, g, k],
                                       C, resultant, tangent):  # fmt: skip
                    return -1
            if not math.isfinite(resultant.sum()):
                return -1
            if straight:
                s[c, g] = resultant
                D[c, g] = tangent
            else:
                carry_to_chord(P, stretch[c, g], resultant, tangent, s[c, g], D[c, g])
    return 0


@njit(**INLINE)
def integrate_point(p, y, z, dA, d, old, new, C, resultant, tangent):
    """Add one point's share to the section: ε11 = ε + κ2 z − κ3 y, γ12 = γ2 − φ′ z, γ13 = γ3 + φ′ y (5.2.4)."""
    if return_map(p, old, d[0] + d[4] * z - d[5] * y, d[1] - d[3] * z, d[2] + d[3] * y, new, C) < 0:
        return False
    sigma, t2, t3 = new[0] * dA, new[1] * dA, new[2] * dA
    resultant[0] += sigma
    resultant[1] += t2
    resultant[2] += t3
    resultant[3] += t3 * y - t2 * z
    resultant[4] += sigma * z
    resultant[5] -= sigma * y
    # tangent = Zᵀ C Z dA with Z = ∂(ε11, γ12, γ13)/∂e; only the entries of Z that are not zero
    for i in range(3):
        c0, c1, c2 = C[i, 0] * dA, C[i, 1] * dA, C[i, 2] * dA
        row3 = c2 * y - c1 * z
        row4 = c0 * z
        row5 = -c0 * y
        if i == 0:
            a, b, fa, fb = 4, 5, z, -y
        elif i == 1:
            a, b, fa, fb = 3, 3, -z, 0.0
        else:
            a, b, fa, fb = 3, 3, y, 0.0
        for row, f in ((i, 1.0), (a, fa), (b, fb)):
            tangent[row, 0] += f * c0
            tangent[row, 1] += f * c1
            tangent[row, 2] += f * c2
            tangent[row, 3] += f * row3
            tangent[row, 4] += f * row4
            tangent[row, 5] += f * row5
    return True


@njit(cache=True)
def carry_to_chord(P, stretch, resultant, tangent, s, D):
    """s = Pᵀ s_true ds/dx, D = Pᵀ D_true P ds/dx."""
    for i in range(6):
        s[i] = 0.0
        for k in range(6):
            s[i] += P[k, i] * resultant[k] * stretch
    work = np.empty((6, 6))
    for i in range(6):
        for j in range(6):
            work[i, j] = 0.0
            for k in range(6):
                work[i, j] += tangent[i, k] * P[k, j] * stretch
    for i in range(6):
        for j in range(6):
            D[i, j] = 0.0
            for k in range(6):
                D[i, j] += P[k, i] * work[k, j]
