"""A section inside any outline, as a rod's section: quadrature of what it encloses, its warping, and its surface.

All lengths are in wire radii, from the wire's centre line: y towards the coil's axis, z upwards along the spring.
"""

from abc import ABC, abstractmethod
from functools import cached_property, lru_cache

import numpy as np

from coilset.meshes.section import boundary
from coilset.meshes.section_shapes import Outline
from coilset.model.base.errors import InputError
from coilset.model.section.polynomials import Basis
from coilset.model.section.rules import SURFACE_POINTS, DiskRule

DEGREE = 6  # of the polynomials of the warping: the torsional stiffness is 2e-4 too high at half of a disk
RINGS, ALONG = 12, 24  # Gauss points from the centre line to the surface, and along each piece of it
FINE_RIM = 400  # points on each piece, between which the surface is interpolated


class Section(ABC):
    """A cross-section of a wire."""

    @property
    @abstractmethod
    def fine(self) -> tuple[np.ndarray, np.ndarray]:
        """Points, shape (n, 2), and weights, for integrals of polynomials.

        The weights' sum is the section's area over that of the disk of radius 1.
        """

    @abstractmethod
    def rule(self, points: int) -> DiskRule:
        """So many points that carry the state, and their weights as in `fine`."""

    @abstractmethod
    def rim(self) -> np.ndarray:
        """The points on the wire's surface, shape (SURFACE_POINTS, 2)."""

    @abstractmethod
    def basis(self, degree: int) -> Basis:
        """Polynomials that are orthonormal over the section."""

    def warping(self, bend: float = 0.0) -> "Warping":
        """How it warps in a wire of curvature `bend`, κ r."""
        return _warping(self, bend)


class Outlined(Section):
    """What a closed curve encloses that every ray from the wire's centre line crosses once.

    With its points b(t) the section is p = ρ b(t), 0 < ρ < 1, and dA = ρ |b × b′| dρ dt: rings of its own shape.

    Args:
        outline: Outline, mm, as a slice takes it.
        radius: of the wire, mm, by which lengths are divided.

    """

    def __init__(self, outline: Outline, radius: float) -> None:
        self._outline, self._size = outline, np.array([-1.0, 1.0]) / radius  # ξ points away from the coil's axis

    def product(self, rings: int, along: int) -> tuple[np.ndarray, np.ndarray]:
        """Gauss's points on rings, with so many on each piece of the outline, and their weights, as in `fine`.

        Raises:
            InputError: if some ray crosses the outline twice.
        """
        b, slope, dt = boundary(self._outline, along)
        b, slope = b * self._size, slope * self._size
        area = (b[:, 0] * slope[:, 1] - b[:, 1] * slope[:, 0]) * dt
        if area.min() * area.max() < 0.0:
            problem = (
                "a ray from the wire's centre line crosses the outline twice; give η and ξ from a point further inside"
            )
            raise InputError(problem, "section.points")
        s, w = np.polynomial.legendre.leggauss(rings)
        ρ = 0.5 * (s + 1.0)
        return (ρ[:, None, None] * b).reshape(-1, 2), np.outer(0.5 * w * ρ, np.abs(area)).ravel() / np.pi

    @cached_property
    def fine(self) -> tuple[np.ndarray, np.ndarray]:
        """See Section."""
        return self.product(RINGS, ALONG)

    def rule(self, points: int) -> DiskRule:
        """See Section; points that no product takes weigh nothing."""
        pieces = len(self.product(1, 1)[1])
        along = max(1, round(np.sqrt(3.0 * points) / pieces))  # about as far from each other along a ring as across it
        rings = max(1, points // (pieces * along))
        places, weights = self.product(rings, along)
        rest = points - len(weights)
        if rest < 0:
            raise ValueError(f"an outline of {pieces} pieces needs at least as many points, not {points}")
        places = np.concatenate([places, np.tile(weights @ places / weights.sum(), (rest, 1))])
        return DiskRule(places, np.concatenate([weights, np.zeros(rest)]), f"outline {rings} × {pieces} × {along}")

    def rim(self) -> np.ndarray:
        """See Section: at equal angles from the y axis."""
        b = boundary(self._outline, FINE_RIM)[0] * self._size
        angle = np.arctan2(b[:, 1], b[:, 0])
        at = 2.0 * np.pi * np.arange(SURFACE_POINTS) / SURFACE_POINTS
        order = np.argsort(angle)
        distance = np.interp(at, angle[order], np.linalg.norm(b, axis=1)[order], period=2.0 * np.pi)
        return distance[:, None] * np.stack([np.cos(at), np.sin(at)], axis=1)

    def basis(self, degree: int) -> Basis:
        """See Section."""
        places, weights = self.fine
        centre = weights @ places / weights.sum()
        return Basis.over(degree, places, weights, centre, np.diag(1.0 / np.abs(places - centre).max(axis=0)))


class Warping:
    """Warping w(y, z) along the wire for unit transverse shear strains γ2, γ3 and for unit twist φ′ of a section.

    Of an elastic wire of constant curvature κ, by Ritz's method. With g = 1 − κ y and e = (1, 0), (0, 1), (−z, y) its
    shear strains are (γ12, γ13) = (e + κ w (1, 0))/g + ∇w, see `coilset.model.section.shape`, and w minimises
    ∫ ½ |(γ12, γ13)|² g dA among the polynomials with ∫ w dA = ∫ y w dA = ∫ z w dA = 0. These conditions only rename γ2,
    γ3 and φ′. A straight wire, κ = 0, has Saint-Venant's warping; with it a thin section would be some (κ r)² too stiff
    in a coil. The twist is about the disk's own centre, not about the centre of shear: with it goes a transverse shear,
    which the rod finds by itself.

    Args:
        section: Section.
        bend: κ r.

    Attributes:
        stiffness: shear stiffness of (γ2, γ3, φ′) over G π r², with φ′ in 1/r, shape (3, 3).
    """

    def __init__(self, section: Section, bend: float) -> None:
        self._basis, self._bend = section.basis(DEGREE), bend
        places, weights = section.fine
        weights = weights / (1.0 - bend * places[:, 0])
        e, slopes = self._unwarped(places), self._slopes(places)
        stiffness = np.einsum("ipk,p,ipl->kl", slopes, weights, slopes)
        self._coefficients = -np.linalg.solve(stiffness, np.einsum("ipk,p,ijp->kj", slopes, weights, e))
        strains = e + np.einsum("ipk,kj->ijp", slopes, self._coefficients)
        self.stiffness = np.einsum("ikp,p,ilp->kl", strains, weights, strains)

    @staticmethod
    def _unwarped(places: np.ndarray) -> np.ndarray:
        """(γ12, γ13) of plane sections for γ2, γ3 and φ′, shape (2, 3, points)."""
        y, z = places.T
        zero, one = np.zeros_like(y), np.ones_like(y)
        return np.array([[one, zero, -z], [zero, one, y]])

    def _slopes(self, places: np.ndarray) -> np.ndarray:
        """g (γ12, γ13) of each polynomial as w, κ w (1, 0) + g ∇w, shape (2, points, polynomials)."""
        value, of_y, of_z = self._basis(places)
        g = 1.0 - self._bend * places[:, :1]
        return np.array([self._bend * value + g * of_y, g * of_z])

    @property
    def torsion(self) -> float:
        """Torsional stiffness over G r⁴ if no transverse force goes with it: of a straight wire, Saint-Venant's J."""
        K = self.stiffness
        return float(np.pi * (K[2, 2] - K[2, :2] @ np.linalg.solve(K[:2, :2], K[:2, 2])))

    def shear(self, places: np.ndarray) -> np.ndarray:
        """g (γ12, γ13) for unit γ2, γ3 and φ′ at points (y, z), shape (points, 2) → (2, 3, points), in wire radii."""
        return self._unwarped(places) + np.einsum("ipk,kj->ijp", self._slopes(places), self._coefficients)


@lru_cache(maxsize=512)
def _warping(section: Section, bend: float) -> Warping:
    """Points of the section and those on its surface need the same, and so do runs of springs with the same ends."""
    return Warping(section, bend)
