"""The elements of a rod: where their sections are, and the strains that they add to those of their nodes.

The thesis's element has two Gauss sections, one twist φ′ and linear curvatures. Where the wire flows, twist and
curvature concentrate in the section that carries most. The mixed element adds modes a of each section strain e,

    e = B u + Σ a P(ξ),    ∫ s · δa P(ξ) dx = 0,

P Legendre polynomials: those of first and second degree in ε, γ12, γ13 and φ′, of second degree in the curvatures,
which are linear by themselves. With three sections these conditions leave N, Q and Mt constant and M2, M3 linear: the
section forces are in equilibrium with those at the nodes, exactly, whatever the material does. This is the force-based
element of E. Spacone, V. Ciampi and F. C. Filippou (Mixed formulation of nonlinear beam finite element, Comput. Struct.
58, 1996) with strains as unknowns, so that it needs no iteration of its own. Its sections are those of Lobatto's rule:
bending moments are greatest at nodes, where contact acts.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

STRAINS = 6  # ε, γ12, γ13, φ′, −w″, v″
PER_LENGTH = 3  # from this one on they are angles by the element's length


class AtSections(NamedTuple):
    """An element at its sections, for compiled loops.

    Attributes:
        xi: abscissae ξ = x/l, shape (sections,).
        mode_strains: the section strain of each mode, shape (modes,).
        mode_values: P(ξ) of each mode, shape (sections, modes).
    """

    xi: np.ndarray
    mode_strains: np.ndarray
    mode_values: np.ndarray


@dataclass(frozen=True)
class Element:
    """Sections and own unknowns of an element.

    Attributes:
        name: in a case.
        abscissae, weights: ξ = x/l of its sections, and their weights, whose sum is 1.
        modes: the section strain, 0 to 5, and the degree of each mode.
        small_rotations: whether its virtual strains are those of small rotations, and its twist, curvatures and work
            refer to the current length, as in the thesis. Else these are the variation of its strains, and refer to
            the stress-free length.
    """

    name: str
    abscissae: tuple[float, ...]
    weights: tuple[float, ...]
    modes: tuple[tuple[int, int], ...] = ()
    small_rotations: bool = False

    @property
    def own(self) -> int:
        """Number of its own unknowns: two excess shear angles, and the modes."""
        return 2 + len(self.modes)

    @property
    def unknowns(self) -> int:
        """Number of all its unknowns, with those of its two nodes."""
        return 12 + self.own

    @cached_property
    def xi(self) -> np.ndarray:
        """The abscissae, shape (sections,)."""
        return np.array(self.abscissae)

    @cached_property
    def at_sections(self) -> AtSections:
        """Abscissae and modes at the sections."""
        strains = np.array([strain for strain, _ in self.modes], np.int64)
        values = [[legendre(degree, xi) for _, degree in self.modes] for xi in self.abscissae]
        return AtSections(self.xi, strains, np.array(values, float).reshape(len(self.abscissae), len(self.modes)))


def legendre(degree: int, xi: Any) -> Any:
    """Legendre's polynomial of first or second degree on 0 … 1, of a number or of a UFL expression."""
    return {1: 2 * xi - 1, 2: 6 * xi * (xi - 1) + 1}[degree]


_HALF = 0.5 / 3.0**0.5
THESIS = Element("thesis", (0.5 - _HALF, 0.5 + _HALF), (0.5, 0.5), small_rotations=True)  # (5.2.42)
MIXED = Element(
    "mixed",
    (0.0, 0.5, 1.0),
    (1 / 6, 2 / 3, 1 / 6),
    (*((strain, 1) for strain in range(4)), *((strain, 2) for strain in range(STRAINS))),
)
ELEMENTS = {element.name: element for element in (MIXED, THESIS)}
