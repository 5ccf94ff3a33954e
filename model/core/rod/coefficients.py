"""Values of the forms' coefficients: what an evaluation writes, and the compiled loops over the elements read."""

import numpy as np

from coilset.model.core.rod.elements import Element


class Coefficients:
    """Arrays by the names in coilset.model.core.rod.forms.FIELDS, documented in RodForms.

    Args:
        element: Element.
        timoshenko_factor: of the owned cells, shape (cells,), see coilset.model.core.rod.forms.section_strains.
        l0: chord lengths in the stress-free state, shape (cells,), mm.

    Attributes:
        xi: abscissae of the sections, shape (cells, sections).
        timoshenko_factor: shape (cells,).
        l0, l: chord lengths in the stress-free state and now, shape (cells,), mm.
        reference: that of the two which twist, curvatures and work refer to, see Element.
        E: triads of the elements (columns), shape (cells, 3, 3).
        T, P: of the nodes' rotations, shape (cells, 2, 3, 3).
        theta: rotation vectors of the nodes against the triads, shape (cells, 2, 3).
        factors: of P, mean: of the elements; see Triads.
        W: for the triads' spin about their chords, shape (cells, 3, 3).
        e: section strains, shape (cells, sections, 6).
        s: section forces, shape (cells, sections, 6), N and N mm.
        predicted: those that the frame stiffness is built with, shape as s; see Prediction.
        D: section tangents ∂s/∂e, shape (cells, sections, 6, 6).
    """

    def __init__(self, element: Element, timoshenko_factor: np.ndarray, l0: np.ndarray) -> None:
        cells, sections = len(timoshenko_factor), len(element.abscissae)
        self.xi, self.timoshenko_factor = np.tile(element.xi, (cells, 1)), timoshenko_factor
        self.l0, self.l = l0, l0.copy()
        self.reference = self.l if element.small_rotations else self.l0
        self.theta, self.mean = (np.zeros((cells, 2, 3)) for _ in range(2))
        self.factors = np.zeros((cells, 2, 2))
        self.E, self.W = (np.zeros((cells, 3, 3)) for _ in range(2))
        self.T, self.P = (np.zeros((cells, 2, 3, 3)) for _ in range(2))
        self.e, self.s, self.predicted = (np.zeros((cells, sections, 6)) for _ in range(3))
        self.D = np.zeros((cells, sections, 6, 6))


def timoshenko_factor(young: float, shear: float, radius: np.ndarray, length: np.ndarray) -> np.ndarray:
    """c = Φ/(1 + Φ) of circular wire, Φ = 12 E I/(G A l²), see coilset.model.core.rod.forms.section_strains.

    Args:
        young, shear: moduli E and G, MPa.
        radius, length: of the elements, mm.
    """
    Φ = 3.0 * young * radius**2 / (shear * length**2)
    return Φ / (1.0 + Φ)
