"""From nodes to section strains: the moving triad of each element, and the rotations relative to it (5.2.5–5.2.14)."""

import math
from typing import NamedTuple

import numpy as np

from coilset.model.core.rod.elements import PER_LENGTH, AtSections
from coilset.model.core.rod.numbering import Numbering
from coilset.model.core.rotations.kernels import (
    exponential,
    inverse_chart_tangent,
    logarithm,
    multiply,
    multiply_transposed,
    rotate,
)
from coilset.model.core.runtime.kernels import njit


class Configuration(NamedTuple):
    """Nodes and cells of a rod.

    Attributes:
        x: positions of the nodes, shape (nodes, 3), mm.
        R: rotations of the nodes since the stress-free state, shape (nodes, 3, 3).
        chord: from node 1 to node 2, shape (cells, 3), mm.
        own: excess shear angles and modes, shape (cells, own).
    """

    x: np.ndarray
    R: np.ndarray
    chord: np.ndarray
    own: np.ndarray


class StressFree(NamedTuple):
    """Elements in the stress-free state.

    Attributes:
        E: triads (columns), shape (cells, 3, 3).
        l: chord lengths, shape (cells,), mm.
        timoshenko_factor: c, part of the rotations in the shear angles, shape (cells,), see `forms.py`.
    """

    E: np.ndarray
    l: np.ndarray
    timoshenko_factor: np.ndarray


class Triads(NamedTuple):
    """The moving triads of the elements.

    Attributes:
        E: triads (columns), shape (cells, 3, 3).
        P: rate of the nodes' rotations θ against the triad for a relative spin, shape (cells, 2, 3, 3).
        W: what makes the triad's spin about its chord, see mean_triad, shape (cells, 3, 3).
        mean: t and tan(φ/4) n of mean_triad, in the triad, shape (cells, 2, 3).
        theta: the nodes' rotations θ against the triad, shape (cells, 2, 3).
        factors: of P, see coilset.model.core.rotations.kernels.inverse_chart_tangent, shape (cells, 2, 2).
        l: chord lengths, shape (cells,), mm.
    """

    E: np.ndarray
    P: np.ndarray
    W: np.ndarray
    mean: np.ndarray
    theta: np.ndarray
    factors: np.ndarray
    l: np.ndarray

    @classmethod
    def of(cls, coefficients: object) -> "Triads":
        """Those among the arrays of Coefficients."""
        return cls(*(getattr(coefficients, name) for name in cls._fields))


@njit(cache=True)
def displace_nodes(
    increment: np.ndarray,
    numbering: Numbering,
    cells: np.ndarray,
    start: Configuration,
    trial: Configuration,
    T: np.ndarray,
    T_cells: np.ndarray,
) -> None:
    """Bring nodes and the elements' own unknowns from the last equilibrium to the increments of the unknowns.

    Chords are updated by differences of the increments: differences of the positions would lose digits as l/L.

    Args:
        increment: of the local unknowns.
        numbering: of these.
        cells: node numbers, shape (cells, 2).
        start: at the last equilibrium.
        trial: written.
        T: written, tangents of the nodes' charts, shape (nodes, 3, 3); T_cells: the same of the cells' nodes.
    """
    u_dofs, rotation_dofs, own_dofs, _ = numbering
    x0, R0, chord0, own0 = start
    x, R, chord, own = trial
    v, turn = np.empty(3), np.empty((3, 3))
    for node in range(len(x)):
        for k in range(3):
            x[node, k] = x0[node, k] + increment[u_dofs[node, k]]
            v[k] = increment[rotation_dofs[node, k]]
        rotate(v, R0[node], R[node], T[node], turn)
    for c in range(len(cells)):
        i, j = cells[c, 0], cells[c, 1]
        for k in range(3):
            chord[c, k] = chord0[c, k] + (increment[u_dofs[j, k]] - increment[u_dofs[i, k]])
        for k in range(own.shape[1]):
            own[c, k] = own0[c, k] + increment[own_dofs[c, k]]
        for k in range(3):
            for l in range(3):
                T_cells[c, 0, k, l], T_cells[c, 1, k, l] = T[i, k, l], T[j, k, l]


@njit(cache=True)
def mean_triad(
    R1: np.ndarray,
    R2: np.ndarray,
    E0: np.ndarray,
    chord: np.ndarray,
    l: float,
    E: np.ndarray,
    W: np.ndarray,
    mean: np.ndarray,
    A: np.ndarray,
    B: np.ndarray,
) -> None:
    """Write into `E` the element's triad: the mean of the two rotated node triads, rotated onto the chord (5.2.11).

    With the relative rotation φ = φ n of the nodes, the first axis t of their mean triad and the chord's direction c,
    the triad spins about its chord by

        W1 · d + W2 · ω1 + W3 · ω2,  W1 = c × t/(l (1 + t·c)),  W2, W3 = ½ (w ± tan(φ/4) w × n),  w = (t + c)/(1 + t·c),

    where d is the rate of the chord and ω1, ω2 are the nodes' spins: the mean rotation spins by ½ (ω1 + ω2) −
    ½ tan(φ/4) n × (ω2 − ω1), and the smallest rotation from t to c is the rotation by π about t followed by that about
    t + c.

    t and tan(φ/4) n, in the triad, are written into `mean`; A and B are 3×3 matrices of work space.
    """
    v, p = mean[0], mean[1]
    multiply_transposed(R1, R2, A)
    logarithm(A, v)
    angle2 = v[0] ** 2 + v[1] ** 2 + v[2] ** 2
    angle = math.sqrt(angle2)
    quarter = 0.25 + angle2 / 192.0 if angle < 1e-3 else math.tan(0.25 * angle) / angle  # tan(φ/4)/φ
    for k in range(3):
        p[k] = quarter * (R1[k, 0] * v[0] + R1[k, 1] * v[1] + R1[k, 2] * v[2])  # tan(φ/4) n
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
        v[i] = (A[i, 0] + chord[i]) / (1.0 + cosine)  # w
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        W[0, i] = (chord[j] * A[k, 0] - chord[k] * A[j, 0]) / (l * (1.0 + cosine))
        W[1, i] = 0.5 * (v[i] + v[j] * p[k] - v[k] * p[j])
    for i in range(3):
        W[2, i] = v[i] - W[1, i]
    x, y, z = p[0], p[1], p[2]
    for i in range(3):
        v[i] = E[0, i] * A[0, 0] + E[1, i] * A[1, 0] + E[2, i] * A[2, 0]
        p[i] = E[0, i] * x + E[1, i] * y + E[2, i] * z


@njit(cache=True)
def section_strains(
    cells: np.ndarray,
    trial: Configuration,
    unloaded: StressFree,
    sections: AtSections,
    triads: Triads,
    reference: np.ndarray,
    e: np.ndarray,
) -> None:
    """Strains of all elements at their sections, from (5.2.4) in the element's moving triad.

    The nodes' rotations θ are measured relative to the triad of the current configuration, so rotations within an
    increment need not be small, and the strains do not depend on the path.

    Args:
        cells: node numbers, shape (cells, 2).
        trial: the current configuration.
        unloaded: the stress-free state.
        sections: of the Element.
        triads: written.
        reference: lengths that twist and curvatures refer to, shape (cells,), mm: the triads' or the stress-free ones.
        e: written, ε, γ12, γ13, φ′, −w″, v″ of the chord axis, shape (cells, sections, 6); ε is logarithmic.
    """
    _, R, chords, own = trial
    E0, l0, timoshenko_factor = unloaded
    xi, mode_strains, mode_values = sections
    E, P, W, mean, theta, factors, lengths = triads
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
        lengths[c] = l
        mean_triad(R[i], R[j], E0[c], chord, l, E[c], W[c], mean[c], A, B)
        for a, node, t in ((0, i, t1), (1, j, t2)):  # θ = log(Eᵀ R E0)
            multiply_transposed(E[c], R[node], A)
            multiply(A, E0[c], B)
            logarithm(B, t)
            inverse_chart_tangent(t, P[c, a], factors[c, a])
            theta[c, a] = t
        stretch, l = math.log(l / l0[c]), reference[c]
        m13, m14 = 0.5 * (t1[1] + t2[1]), 0.5 * (t1[2] + t2[2])
        u13, u14 = own[c, 0] - timoshenko_factor[c] * m13, own[c, 1] - timoshenko_factor[c] * m14
        for g in range(len(xi)):
            H = 12.0 * xi[g] - 6.0  # H2″ + H4″, times l
            e[c, g, 0] = stretch
            e[c, g, 1] = u14
            e[c, g, 2] = -u13
            e[c, g, 3] = (t2[0] - t1[0]) / l
            e[c, g, 4] = (t2[1] - t1[1] + H * (u13 + m13)) / l
            e[c, g, 5] = (t2[2] - t1[2] + H * (u14 + m14)) / l
            for k in range(len(mode_strains)):
                mode = mode_values[g, k] * own[c, 2 + k]
                e[c, g, mode_strains[k]] += mode / l if mode_strains[k] >= PER_LENGTH else mode
