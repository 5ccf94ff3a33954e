"""From nodes to section strains: the moving triad of each element, and the turns measured against it (5.2.5–5.2.14)."""

import math

import numpy as np
from numba import njit

from coilset.model.frames.rotations import (
    exponential,
    inverse_chart_tangent,
    logarithm,
    multiply,
    multiply_transposed,
)

GAUSS = np.array([0.5 - 0.5 / math.sqrt(3.0), 0.5 + 0.5 / math.sqrt(3.0)])  # abscissae ξ = x/l (5.2.43)


@njit(cache=True)
def mean_triad(R1, R2, E0, chord, E, A, B, v):
    """Write into `E` the element's triad: the mean of the two turned node triads, swung onto the chord (5.2.11).

    A, B are 3×3 and v is a 3-vector of work space.
    """
    multiply_transposed(R1, R2, A)
    logarithm(A, v)
    for i in range(3):
        v[i] *= 0.5
    exponential(v, A)
    multiply(R1, A, B)
    multiply(B, E0, A)  # mean triad, its first axis t the mean tangent
    cosine = chord[0] * A[0, 0] + chord[1] * A[1, 0] + chord[2] * A[2, 0]
    for j in range(1, 3):
        projection = chord[0] * A[0, j] + chord[1] * A[1, j] + chord[2] * A[2, j]
        for i in range(3):
            E[i, j] = A[i, j] - projection * (A[i, 0] + chord[i]) / (1.0 + cosine)
    for i in range(3):
        E[i, 0] = chord[i]


@njit(cache=True)
def section_strains(cells, chords, R, E0, l0, bow, xi, E, P, e):
    """Section strains of all elements at their two Gauss sections, from (5.2.4) in the element's moving triad.

    The nodes' turns θ are measured against the triad of the current configuration, so no restriction to small turns
    within an increment is needed and the strains do not depend on the path.

    Args:
        cells: node numbers, shape (cells, 2).
        chords: current chords from node 1 to node 2, shape (cells, 3), mm.
        R: turns of the nodes since the stress-free state, shape (nodes, 3, 3).
        E0: triads of the stress-free state, shape (cells, 3, 3), l0: chord lengths there, shape (cells,).
        bow: b13, b14, the shear angles and the means of the turns, see coilset.model.rod.forms, shape (cells, 2).
        xi: Gauss abscissae on the chord, shape (2,).
        E: written, current triads (columns), shape (cells, 3, 3).
        P: written, rate of the turns θ against the triad for a relative spin, shape (cells, 2, 3, 3).
        e: written, ε, γ12, γ13, φ′, −w″, v″ of the chord axis, shape (cells, 2, 6); ε is logarithmic.
    """
    chord = np.empty(3)
    A = np.empty((3, 3))
    B = np.empty((3, 3))
    t1 = np.empty(3)
    t2 = np.empty(3)
    for c in range(len(cells)):
        i, j = cells[c, 0], cells[c, 1]
        for k in range(3):
            chord[k] = chords[c, k]
        l = math.sqrt(chord[0] ** 2 + chord[1] ** 2 + chord[2] ** 2)
        for k in range(3):
            chord[k] /= l
        mean_triad(R[i], R[j], E0[c], chord, E[c], A, B, t1)
        for a, node, t in ((0, i, t1), (1, j, t2)):  # θ = log(Eᵀ R E0)
            multiply_transposed(E[c], R[node], A)
            multiply(A, E0[c], B)
            logarithm(B, t)
            inverse_chart_tangent(t, P[c, a])
        b13, b14 = bow[c, 0], bow[c, 1]
        for g in range(2):
            H = 12.0 * xi[g] - 6.0  # H2″ + H4″, times l
            e[c, g, 0] = math.log(l / l0[c])
            e[c, g, 1] = b14 - 0.5 * (t1[2] + t2[2])
            e[c, g, 2] = 0.5 * (t1[1] + t2[1]) - b13
            e[c, g, 3] = (t2[0] - t1[0]) / l
            e[c, g, 4] = (t2[1] - t1[1] + H * b13) / l
            e[c, g, 5] = (t2[2] - t1[2] + H * b14) / l
