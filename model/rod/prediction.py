"""Section forces as a Newton correction foresees them: the stiffness of the turning frame is built with these.

A correction δ turns the elements by finite angles, and the axial and shear strains of where it ends are wrong by terms
of second order, ½ w′². In a slender rod the forces E A ½ w′² that come of it are far greater than the true ones, and a
frame stiffness built with them leads astray. So it is built with s + D B δ, the forces that the linear solve has found,
as with mixed integration points: D. Magisano, L. Leonetti, G. Garcea, How to improve efficiency and robustness of the
Newton method in geometrically non-linear structural problem discretized via displacement-based finite elements, Comput.
Methods Appl. Mech. Engrg. 313 (2017). At equilibrium both are the same.
"""

from dataclasses import dataclass

import numpy as np

from coilset.model.rod.kinematics import GAUSS


@dataclass(frozen=True)
class Frames:
    """What the linear strains of the elements depend on, see coilset.model.rod.forms.

    Attributes:
        cells: node numbers, shape (cells, 2).
        length: of the chords, shape (cells,), mm.
        E: triads (columns), shape (cells, 3, 3).
        T: charts' tangents of both nodes, P: rates of their turns, shape (cells, 2, 3, 3).
        W: what makes the triad's spin about its chord, shape (cells, 3, 3).
        shear_fraction: of the rotations that is in the shear angles, shape (cells,).
        strain: section strains, shape (cells, 2, 6).
    """

    cells: np.ndarray
    length: np.ndarray
    E: np.ndarray
    T: np.ndarray
    P: np.ndarray
    W: np.ndarray
    shear_fraction: np.ndarray
    strain: np.ndarray


def linear_strains(frames: Frames, u: np.ndarray, turns: np.ndarray, shear: np.ndarray) -> np.ndarray:
    """B δ, the change of the section strains by increments of first order.

    Args:
        frames: Frames.
        u, turns: increments of the nodes' displacements and of their rotation charts, shape (nodes, 3).
        shear: of the excess shear angles, shape (cells, 2).

    Returns:
        ε, γ12, γ13, φ′, −w″, v″ at the two Gauss sections, shape (cells, 2, 6).
    """
    first, second = frames.cells.T
    chord, l = u[second] - u[first], frames.length
    spins = np.einsum("naij,naj->nai", frames.T, turns[frames.cells])
    about = np.einsum("nki,nki->n", frames.W, np.stack([chord, spins[:, 0], spins[:, 1]], axis=1))
    d = np.einsum("nji,nj->ni", frames.E, chord)
    frame = np.stack([about, -d[:, 2] / l, d[:, 1] / l], axis=1)
    t = np.einsum("naij,naj->nai", frames.P, np.einsum("nji,naj->nai", frames.E, spins) - frame[:, None])
    mean, difference = 0.5 * (t[:, 0] + t[:, 1]), t[:, 1] - t[:, 0]
    excess = shear - frames.shear_fraction[:, None] * mean[:, 1:]
    e = np.empty((len(l), 2, 6))
    e[..., 0] = (d[:, 0] / l)[:, None]
    e[..., 1], e[..., 2] = excess[:, 1, None], -excess[:, 0, None]
    e[..., 3] = (difference[:, 0] / l)[:, None]
    bow = np.einsum("g,ni->ngi", 12.0 * GAUSS - 6.0, excess + mean[:, 1:])  # H2″ + H4″, times l²
    e[..., 4:] = (difference[:, None, 1:] + bow) / l[:, None, None]
    e[..., 3:] -= (d[:, 0] / l)[:, None, None] * frames.strain[..., 3:]  # a longer chord is bent less
    return e


@dataclass(frozen=True)
class Prediction:
    """What a correction foresees, from the state before it.

    Attributes:
        forces, strain: section forces and strains there, shape (cells, 2, 6).
        tangent: section tangent there, shape (cells, 2, 6, 6).
        change: B δ of the whole correction, shape (cells, 2, 6).
    """

    forces: np.ndarray
    strain: np.ndarray
    tangent: np.ndarray
    change: np.ndarray

    def forces_after(self, length: float) -> np.ndarray:
        """s + D B δ after `length` of the correction."""
        return self.forces + length * np.einsum("ngij,ngj->ngi", self.tangent, self.change)

    def without_turning(self, length: float, forces: np.ndarray, strain: np.ndarray) -> np.ndarray:
        """Section forces after `length` of the correction, without what strains of second order add: s − D (e − e_lin).

        In an elastic rod they are the foreseen ones; where wire yields, what yielding takes off is still off.
        """
        return forces - np.einsum("ngij,ngj->ngi", self.tangent, strain - self.strain - length * self.change)
