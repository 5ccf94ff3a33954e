"""Mixed integration point (MIP) iteration: section forces predicted by a Newton correction.

A correction δ rotates the elements by finite angles, and the axial and shear strains at its end are wrong by terms of
second order, ½ w′². In a slender rod the resulting forces E A ½ w′² are much larger than the true ones, and a frame
stiffness of the rotating frame built with them is misleading. It is therefore built with s + D B δ, the forces found
by the linear solve: D. Magisano, L. Leonetti, G. Garcea, How to improve efficiency and robustness of the
Newton method in geometrically non-linear structural problem discretized via displacement-based finite elements, Comput.
Methods Appl. Mech. Engrg. 313 (2017). At equilibrium both are the same.
"""

import numpy as np

from coilset.model.core.rod.assembly import blocks
from coilset.model.core.rod.coefficients import Coefficients
from coilset.model.core.rod.elements import PER_LENGTH, STRAINS, AtSections, Element
from coilset.model.core.rod.kinematics import Triads
from coilset.model.core.rod.numbering import Numbering
from coilset.model.core.runtime.kernels import njit

BLOCK = 4096  # cells that are taken together, so that no large arrays are made on the way


@njit(cache=True)
def linear_strains(
    cells: np.ndarray,
    triads: Triads,
    T: np.ndarray,
    timoshenko_factor: np.ndarray,
    strain: np.ndarray,
    numbering: Numbering,
    increments: np.ndarray,
    sections: AtSections,
    reference: np.ndarray,
    e: np.ndarray,
) -> None:
    """Write B δ, the change of the section strains by increments of first order.

    Args:
        cells: of the Prediction.
        triads: of the elements.
        T, timoshenko_factor, strain: Coefficients, the last one of these is `e`, or empty where it does not fall as a
            chord grows.
        numbering: of the unknowns.
        increments: of the local unknowns, mm and rad.
        sections: of the Element.
        reference: lengths that twist and curvatures refer to, shape (cells,), mm.
        e: written, ε, γ12, γ13, φ′, −w″, v″ at the sections, shape (cells, sections, 6).
    """
    E, P, W = triads.E, triads.P, triads.W
    u, rotations, own, _ = numbering
    xi, mode_strains, mode_values = sections
    spins, t, frame, d = np.empty((2, 3)), np.empty((2, 3)), np.empty(3), np.empty(3)
    for c in range(len(cells)):
        first, second = cells[c, 0], cells[c, 1]
        l = triads.l[c]
        frame[0] = 0.0
        for i in range(3):
            d[i] = 0.0
            for a in range(2):
                spins[a, i] = 0.0
                for j in range(3):
                    spins[a, i] += T[c, a, i, j] * increments[rotations[cells[c, a], j]]
        for i in range(3):
            chord = increments[u[second, i]] - increments[u[first, i]]
            frame[0] += W[c, 0, i] * chord + W[c, 1, i] * spins[0, i] + W[c, 2, i] * spins[1, i]
            for j in range(3):
                d[j] += E[c, i, j] * chord
        frame[1], frame[2] = -d[2] / l, d[1] / l
        for a in range(2):
            for i in range(3):
                t[a, i] = 0.0
            for j in range(3):
                relative = -frame[j]
                for i in range(3):
                    relative += E[c, i, j] * spins[a, i]
                for i in range(3):
                    t[a, i] += P[c, a, i, j] * relative
        stretch, l = d[0] / l, reference[c]
        for g in range(len(xi)):
            H = 12.0 * xi[g] - 6.0  # H2″ + H4″, times l²
            e[c, g, 0] = stretch
            e[c, g, 3] = (t[1, 0] - t[0, 0]) / l
            for k in range(2):  # about the second axis and the third
                mean = 0.5 * (t[0, 1 + k] + t[1, 1 + k])
                excess = increments[own[c, k]] - timoshenko_factor[c] * mean
                e[c, g, 2 - k] = -excess if k == 0 else excess
                e[c, g, 4 + k] = (t[1, 1 + k] - t[0, 1 + k] + H * (excess + mean)) / l
            for k in range(len(mode_strains)):
                mode = mode_values[g, k] * increments[own[c, 2 + k]]
                e[c, g, mode_strains[k]] += mode / l if mode_strains[k] >= PER_LENGTH else mode
            if len(strain):
                for i in range(PER_LENGTH, STRAINS):
                    e[c, g, i] -= stretch * strain[c, g, i]  # a longer chord is bent less


class Prediction:
    """Prediction of a correction, from the state before it.

    Args:
        cells: node numbers, shape (cells, 2).
        coefficients: Coefficients of the trial state.
        numbering: Numbering of the unknowns.
        element: Element.

    Attributes:
        forces, strain, tangent: section forces, strains and tangent before the correction.
        change: B δ of the whole correction, shape (cells, sections, 6).
    """

    def __init__(
        self,
        cells: np.ndarray,
        coefficients: Coefficients,
        numbering: Numbering,
        element: Element,
    ) -> None:
        self._coefficients = c = coefficients
        self._on_trial = c.s, c.e, c.D
        self.forces, self.strain, self.tangent = (np.zeros_like(each) for each in self._on_trial)
        self.change = np.zeros_like(c.s)
        falling = c.e if element.small_rotations else c.e[:0]
        self._before = cells, Triads.of(c), c.T, c.timoshenko_factor, falling, numbering
        self._sections = element.at_sections, c.reference

    def begin(self, correction: np.ndarray) -> None:
        """Take the trial state, from which a correction of the local unknowns begins, mm and rad."""
        for kept, on_trial in zip((self.forces, self.strain, self.tangent), self._on_trial, strict=True):
            np.copyto(kept, on_trial)
        linear_strains(*self._before, correction, *self._sections, self.change)

    def forces_after(self, share: float) -> None:
        """Write s + D B δ after a share of the correction into the predicted forces."""
        out = self._coefficients.predicted
        np.einsum("ngij,ngj->ngi", self.tangent, self.change, out=out)
        out *= share
        out += self.forces

    def without_second_order(self, share: float) -> None:
        """Write s − D (e − e₁) into the predicted forces, e₁ = e₀ + B δ after a share of the correction.

        In an elastic rod they are those of `forces_after`; where the wire yields, the reduction by yielding remains.
        """
        forces, strain, out = self._coefficients.s, self._coefficients.e, self._coefficients.predicted
        for part in blocks(slice(0, len(forces)), BLOCK):
            second = strain[part] - self.strain[part] - share * self.change[part]
            np.subtract(forces[part], np.einsum("ngij,ngj->ngi", self.tangent[part], second), out=out[part])
