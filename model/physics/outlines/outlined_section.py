"""A wire's cross-section by its outline: quadrature of what it encloses, its warping, and its surface.

All lengths are in wire radii, from the wire's centre line: y towards the coil's axis, z upwards along the spring.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING

import numpy as np

from coilset.meshes.sections.boundary import Boundary
from coilset.meshes.springs.functions import gauss
from coilset.model.core.base.errors import InputError
from coilset.model.core.section.rules import SURFACE_POINTS, DiskRule, rim
from coilset.model.physics.warping.polynomials import Basis, Harmonics, Monomials, exponents

if TYPE_CHECKING:
    from coilset.meshes.sections.shapes import Outline

WHOLE = 1.0  # a level from which on nothing is cut away
DEEPEST = -0.999  # the wire that is left there is half a thousandth of its diameter thick
FINE = 24  # points in each direction, for integrals of polynomials
SLENDERNESS = 1.6  # points over the height for each of those across it
DEGREE = 6  # of the polynomials of the warping: the torsional stiffness is 2e-4 too high at half of a disk
RINGS, ALONG, LEAST_ALONG = 12, 24, 6  # Gauss points from the centre line to the surface, and along pieces of it
# Least points on a straight and on a curved piece, and rings that must be left. Two points on the corner of a rectangle
# made its rate 0.16 % too high and the shear at the inside up to 4 %, whatever the polynomials. Those of degree 8 need
# five on a straight piece: with four the residual shear of a sharp rectangle is 30 % off.
ENOUGH = ((5, 3, 6), (3, 3, 4), (1, 2, 3))
ACROSS_RING = 2.5  # square of the points along a ring over all: 20 of 160
ON_RAY = 1e-9  # of a side, by which a ray through its end may miss it
LEAST_VIEW = 1e-3  # of the greatest |b × b′| along a boundary: below it its origin is too near to it or outside


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
        """Polynomials up to a degree that are orthonormal over the section, harmonics up to it over a ring."""

    def warping(self, bend: float = 0.0) -> "Warping":
        """How it warps in a wire of curvature `bend`, κ r."""
        return _warping(self, bend)


@dataclass(frozen=True)
class Segment(Section):
    """What grinding leaves of a round wire: the disk without what is beyond a straight line.

    The plane that the wheel left crosses the section in a straight line, at the `level` from the wire's axis on the
    side away from the `normal`: the points p of the unit disk with p · normal > −level are left. With the height
    ζ = cos φ above the axis along the normal and the place η = v sin φ across it, the segment is
    0 < φ < arccos(−level), −1 < v < 1, and dA = sin² φ dφ dv: Gauss-Legendre in both converges like a power series.

    Args:
        level: distance of the line from the centre, −1 … 1; negative if the centre itself is cut away.
        normal: unit vector (y, z) across the line, into what is left.
    """

    level: float
    normal: tuple[float, float]

    @property
    def _last(self) -> float:
        """φ at the line."""
        return float(np.arccos(-np.clip(self.level, DEEPEST, WHOLE)))

    def _turned(self, across: np.ndarray, height: np.ndarray) -> np.ndarray:
        """Points (y, z) of given η and ζ, shape (n, 2)."""
        n = np.array(self.normal)
        return np.multiply.outer(across, [n[1], -n[0]]) + np.multiply.outer(height, n)

    def product(self, over: int, across: int) -> tuple[np.ndarray, np.ndarray]:
        """Gauss's points, shape (over · across, 2), and weights, whose sum is the segment's area over that of the disk.

        Args:
            over: number of points over the height.
            across: number of points across it.
        """
        (x, a), (v, b) = (gauss(n) for n in (over, across))
        φ = 0.5 * self._last * (x[:, None] + 1.0)
        weights = 0.5 * self._last * a[:, None] * np.sin(φ) ** 2 * b / np.pi
        places = self._turned((np.sin(φ) * v).ravel(), (np.cos(φ) + 0.0 * v).ravel())
        return places, weights.ravel()

    @cached_property
    def fine(self) -> tuple[np.ndarray, np.ndarray]:
        """Points and weights for integrals of polynomials."""
        return self.product(FINE, FINE)

    def rule(self, points: int) -> DiskRule:
        """As many points as the rule of the whole disk has; those that no product takes weigh nothing."""
        across = max(2, round(np.sqrt(points / SLENDERNESS)))
        over = max(1, points // across)
        places, weights = self.product(over, across)
        rest = points - len(weights)
        places = np.concatenate([places, np.tile(weights @ places / weights.sum(), (rest, 1))])
        return DiskRule(places, np.concatenate([weights, np.zeros(rest)]), f"segment {over} × {across}")

    def rim(self) -> np.ndarray:
        """The points `rules.rim` of the wire's surface; those that were cut away are spread over the flat."""
        points, n = rim(), np.array(self.normal)
        ζ, η = points @ n, points @ np.array([n[1], -n[0]])
        φ, end = np.arccos(np.clip(ζ, -1.0, 1.0)), self._last
        flat = φ > end
        η = np.where(flat, np.sign(η) * np.sin(end) * (np.pi - φ) / max(np.pi - end, 1e-12), η)
        return self._turned(η, np.where(flat, np.cos(end), ζ))

    def basis(self, degree: int) -> Basis:
        """Polynomials that are orthonormal over the segment."""
        half = 0.5 * (1.0 + np.clip(self.level, DEEPEST, WHOLE))  # of its height
        across = np.sin(min(self._last, 0.5 * np.pi))
        n = np.array(self.normal)
        axes = np.stack([np.array([n[1], -n[0]]) / across, n / half])
        return Basis.over(Monomials(exponents(degree), (1.0 - half) * n, axes), *self.fine)


class Outlined(Section):
    """What a closed curve encloses that every ray from a point inside it crosses once.

    With the curve's points b(t) from there the section is p = ρ b(t), k < ρ < 1, and dA = ρ |b × b′| dρ dt: rings of
    its own shape. k is 0, or the size of a tube's hole.

    Args:
        boundary: Boundary, in wire radii; of a spring's wire, half of its height.

    """

    def __init__(self, boundary: Boundary) -> None:
        self.boundary = boundary
        b, slope, dt = boundary.gauss(ALONG)
        area = dt * _cross(b, slope)
        centre = ((b * area[:, None]).sum(axis=0) / 3.0) / (0.5 * area.sum())
        # what a plane leaves of a section may have the wire's centre line on its edge or beside it
        self._middle = np.zeros(2) if (area > LEAST_VIEW * np.abs(area).max()).all() else centre
        self._seen = boundary if not self._middle.any() else boundary.moved(-self._middle)
        self._sectors = self._seen.sectors
        self._cuts: dict[tuple[float, float, float], Outlined] = {}

    @classmethod
    def of(cls, outline: "Outline", radius: float) -> "Outlined":
        """Of an outline as a slice takes it, and the wire's radius, mm, by which lengths are divided."""
        return cls(Boundary.of(outline).scaled(1.0 / radius, 1.0 / radius))

    def cut(self, level: float, normal: tuple[float, float]) -> "Outlined":
        """What a plane leaves of it, see `Segment`; itself if nothing is cut away."""
        plane = (level, *normal)
        if plane not in self._cuts:  # points and surface need the same
            left = self.boundary.cut(max(level, DEEPEST), np.array(normal))
            self._cuts[plane] = self if left is self.boundary else Outlined(left)
        return self._cuts[plane]

    def _product(self, rings: int, along: list[int]) -> tuple[np.ndarray, np.ndarray]:
        """Gauss's points on rings, with a number on each piece of the outline, and their weights, as in `fine`.

        Raises:
            InputError: if some ray crosses the outline twice.
        """
        b, slope, dt = self._seen.at(along)
        area = dt * _cross(b, slope)
        if area.min() < 0.0:
            problem = (
                "a ray from the wire's centre line crosses the outline twice; give η and ξ from a point further inside"
            )
            raise InputError(problem, "section.points")
        first = np.cumsum([0, *along[:-1]])
        area *= np.repeat(self._sectors / np.add.reduceat(area, first), along)
        s, w = gauss(rings)
        k = self.boundary.hole
        ρ = k + 0.5 * (1.0 - k) * (s + 1.0)
        places = self._middle + (ρ[:, None, None] * b).reshape(-1, 2)
        return places, np.outer(0.5 * (1.0 - k) * w * ρ, area).ravel() / np.pi

    @cached_property
    def fine(self) -> tuple[np.ndarray, np.ndarray]:
        """See Section."""
        pieces = self._seen.pieces
        straight = max(LEAST_ALONG, ALONG // len(pieces))
        return self._product(RINGS, [straight if len(piece.x) == 2 else ALONG for piece in pieces])

    def rule(self, points: int) -> DiskRule:
        """See Section; points that no product takes weigh nothing.

        Raises:
            InputError: if the outline has more pieces than points can be spared for.
        """
        share = self._seen.lengths / self._seen.lengths.sum()
        around = np.sqrt(ACROSS_RING * points)  # about as far from each other along a ring as across it
        for straight, curved, enough in ENOUGH:
            least = [straight if len(piece.x) == 2 else curved for piece in self._seen.pieces]
            along = [max(some, round(around * part)) for some, part in zip(least, share, strict=True)]
            rings = points // sum(along)
            if rings >= enough:
                break
        else:
            problem = (
                f"an outline of {len(along)} straight or smooth pieces needs {enough * sum(along)} points in its "
                f"section, not {points}; give mesh.section more rings or angles, or the outline fewer points, or smooth"
            )
            raise InputError(problem, "spring.wire.outline")
        places, weights = self._product(rings, along)
        rest = points - len(weights)
        places = np.concatenate([places, np.repeat(places[:1], rest, axis=0)])  # the middle may be a hole
        name = f"outline {rings} × {sum(along)}"
        return DiskRule(places, np.concatenate([weights, np.zeros(rest)]), name, self)

    def rim(self) -> np.ndarray:
        """See Section: where rays at equal angles from the y axis cross the curve's polygon."""
        corner = self._seen.polygon
        side = np.roll(corner, -1, axis=0) - corner
        angle = 2.0 * np.pi * np.arange(SURFACE_POINTS) / SURFACE_POINTS
        ray = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        across = _cross(ray[:, None], side)
        across = np.where(across > 0.0, across, np.nan)
        place = _cross(corner, ray[:, None]) / across  # along the side, 0 … 1 if the ray crosses it
        distance = np.where((place >= -ON_RAY) & (place <= 1.0 + ON_RAY), _cross(corner, side) / across, -np.inf)
        return self._middle + distance.max(axis=1)[:, None] * ray

    def basis(self, degree: int) -> Basis:
        """See Section."""
        places, weights = self.fine
        if self.boundary.hole:
            return Basis.over(Harmonics(degree, self.boundary.hole), places, weights)
        centre = weights @ places / weights.sum()
        axes = np.diag(1.0 / np.abs(places - centre).max(axis=0))
        return Basis.over(Monomials(exponents(degree), centre, axes), places, weights)


class Warping:
    """Warping w(y, z) along the wire for unit transverse shear strains γ2, γ3 and for unit twist φ′ of a section.

    Of an elastic wire of constant curvature κ, by Ritz's method. With g = 1 − κ y and e = (1, 0), (0, 1), (−z, y) its
    shear strains are (γ12, γ13) = (e + κ w (1, 0))/g + ∇w, see `coilset.model.core.section.shape`, and w minimises
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


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
