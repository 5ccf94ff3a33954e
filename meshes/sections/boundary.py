"""The boundary of a wire's cross-section in numbers: smooth pieces, cut by a plane, and how two of them touch.

A boundary runs anticlockwise. That of a spring's wire has lengths in half its height along the spring, y towards the
coil's axis and z upwards, with the centre line as origin.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from coilset.meshes.springs import functions

if TYPE_CHECKING:
    from scipy.interpolate import CubicHermiteSpline

    from coilset.meshes.sections.shapes import Outline

KNOTS = 257  # of a curved piece: an ellipse of one piece is met within 1e-9 of its size
MANY = 24  # Gauss points on a piece, for its length and area
STRAIGHT = 1e-9  # deviation from the chord, over its length, of a piece that is a straight line
SMOOTH = 4096  # corners of the polygon by which a boundary is drawn and touches another
NOTHING = 1e-9  # depth of a cut, and length of a piece, that count as none


@dataclass(frozen=True, eq=False)
class Boundary:
    """A closed curve.

    Attributes:
        pieces: functions b(t), 0 ≤ t ≤ 1, shape (..., 2), in order around it.
        hole: size of a similar hole about the same origin over that of the boundary; 0 of a solid section.
    """

    pieces: "tuple[CubicHermiteSpline, ...]"
    hole: float = 0.0

    @classmethod
    def of(cls, outline: "Outline", about: float = 0.0) -> "Boundary":
        """That of an outline, in mm, turned by the angle `about` from y to z, rad; y = −ξ and z = η.

        Raises:
            InputError: if gmsh cannot draw it.
        """
        from coilset.meshes.sections.mesh import drawn_pieces  # gmsh: not where wire is round

        cos, sin = np.cos(about), np.sin(about)
        to_section = np.diag([-1.0, 1.0]) @ np.array([[cos, sin], [-sin, cos]])
        knots = [(points @ to_section, slopes @ to_section) for points, slopes in drawn_pieces(outline, KNOTS)]
        size = max(float(np.ptp(points, axis=0).max()) for points, _ in knots)
        forward = [_piece(*knots[0])]
        for points, slopes in knots[1:]:
            end = forward[-1](1.0)
            if np.linalg.norm(points[0] - end) > np.linalg.norm(points[-1] - end):
                points, slopes = points[::-1], -slopes[::-1]
            if np.linalg.norm(points[-1] - points[0]) > NOTHING * size:
                forward.append(_piece(points, slopes))
        if len(forward) > 1 and np.linalg.norm(forward[0](1.0) - forward[1](0.0)) > NOTHING * size:
            forward[0] = _reversed(forward[0])
        return cls(tuple(forward), getattr(outline, "hole", 0.0))._anticlockwise()

    def _anticlockwise(self) -> "Boundary":
        if self.signed_area > 0.0:
            return self
        return Boundary(tuple(_reversed(piece) for piece in self.pieces[::-1]), self.hole)

    def scaled(self, of_y: float, of_z: float) -> "Boundary":
        """The curve with its coordinates multiplied by factors; a negative one mirrors it."""
        by = np.array([of_y, of_z])
        return Boundary(tuple(_piece(by * p(p.x), by * p(p.x, 1)) for p in self.pieces), self.hole)._anticlockwise()

    def moved(self, by: np.ndarray) -> "Boundary":
        """The same curve about another origin."""
        return Boundary(tuple(_piece(p(p.x) + by, p(p.x, 1)) for p in self.pieces), self.hole)

    def gauss(self, along: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Gauss's points on each piece: b and b′, shape (n, 2), and weights dt, shape (n,)."""
        return self.at([along] * len(self.pieces))

    def at(self, along: list[int]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """As `gauss`, with a number of points for each piece."""
        parts = []
        for piece, number in zip(self.pieces, along, strict=True):
            x, w = functions.gauss(number)
            parts.append((piece(0.5 * (x + 1.0)), piece(0.5 * (x + 1.0), 1), 0.5 * w))
        b, slope, dt = zip(*parts, strict=True)
        return np.concatenate(b), np.concatenate(slope), np.concatenate(dt)

    @cached_property
    def lengths(self) -> np.ndarray:
        """Of the pieces, shape (pieces,)."""
        x, w = functions.gauss(MANY)
        return np.array([0.5 * w @ np.linalg.norm(p(0.5 * (x + 1.0), 1), axis=1) for p in self.pieces])

    @cached_property
    def sectors(self) -> np.ndarray:
        """Twice the areas between the pieces and the origin, shape (pieces,)."""
        b, slope, dt = self.gauss(MANY)
        return (dt * (b[:, 0] * slope[:, 1] - b[:, 1] * slope[:, 0])).reshape(-1, MANY).sum(axis=1)

    @property
    def signed_area(self) -> float:
        """What the curve encloses, its hole included; positive if it runs anticlockwise."""
        return 0.5 * float(self.sectors.sum())

    @property
    def area(self) -> float:
        """Of the section, without its hole."""
        return self.signed_area * (1.0 - self.hole**2)

    def points(self, number: int, on_straight: bool = True) -> np.ndarray:
        """About so many points on the curve in order around it, with all ends of pieces, shape (n, 2).

        Args:
            number: of points.
            on_straight: whether some are on straight pieces; else only their ends are.
        """
        total, points = self.lengths.sum(), []
        for piece, length in zip(self.pieces, self.lengths, strict=True):
            ends = len(piece.x) == 2 and not on_straight
            some = 1 if ends else max(2, round(number * length / total))
            points.append(piece(np.arange(some) / some))
        return np.concatenate(points)

    @cached_property
    def polygon(self) -> np.ndarray:
        """The curve as a polygon, anticlockwise, shape (n, 2)."""
        return self.points(SMOOTH, False)

    @cached_property
    def _extent(self) -> tuple[np.ndarray, np.ndarray]:
        marks = []
        for piece in self.pieces:
            for k in range(2):
                one = _spline(piece.x, piece(piece.x)[:, k], piece(piece.x, 1)[:, k])
                turning = one.derivative().roots(extrapolate=False)
                marks.append(piece(np.append(turning[np.isfinite(turning)], [0.0, 1.0])))
        points = np.concatenate(marks)
        return points.min(axis=0), points.max(axis=0)

    @property
    def low(self) -> np.ndarray:
        """Minimum y and z."""
        return self._extent[0]

    @property
    def high(self) -> np.ndarray:
        """Maximum y and z."""
        return self._extent[1]

    def support(self, directions: np.ndarray) -> np.ndarray:
        """h(n) = max b · n: distance of the tangent across unit vectors n from the origin, shape (m, 2) → (m,)."""
        return (self.polygon @ directions.T).max(axis=0)

    def difference(self, number: int) -> np.ndarray:
        """Polygon of the boundary of {b − b′} of two points of the section, anticlockwise, shape (n, 2).

        Two wires of this section, neither turned against the other, touch where the one's centre line is on it as seen
        from the other's. Its sides are those of the section's convex hull, and these backwards, by their directions.

        Args:
            number: of points on the section's boundary.
        """
        from scipy.spatial import ConvexHull  # as in `_spline`

        points = self.points(number, False)
        hull = points[ConvexHull(points).vertices]
        sides = np.roll(hull, -1, axis=0) - hull
        sides = np.concatenate([sides, -sides])
        sides = sides[np.argsort(np.arctan2(sides[:, 1], sides[:, 0]), kind="stable")]
        corners = np.cumsum(sides, axis=0)
        return corners - corners.mean(axis=0)

    @cached_property
    def _top(self) -> np.ndarray:
        """Upper half of `difference` by ascending y, shape (n, 2)."""
        corners = self.difference(SMOOTH)
        corners = np.roll(corners, -int(np.lexsort((corners[:, 1], corners[:, 0]))[-1]), axis=0)
        return corners[: int(np.argmin(corners[:, 0])) + 1][::-1]

    def touching(self, aside: np.ndarray) -> np.ndarray:
        """How far one wire stands above another which it touches, `aside` outwards; 0 where they pass each other."""
        y, z = self._top.T
        return np.interp(-np.asarray(aside), y, np.maximum(z, 0.0), left=0.0, right=0.0)

    def cut(self, level: float, normal: np.ndarray) -> "Boundary":
        """What a plane leaves, b · n > −level, with the same origin; itself if nothing is cut away."""
        if self.support(-normal[None])[0] <= level + NOTHING:
            return self
        kept: list[CubicHermiteSpline] = [part for piece in self.pieces for part in _above(piece, level, normal)]
        closed = []
        for part, after in zip(kept, [*kept[1:], *kept[:1]], strict=True):
            start, end = part(1.0), after(0.0)
            closed.append(part)
            if np.linalg.norm(end - start) > 1e3 * NOTHING:
                closed.append(_piece(np.array([start, end]), np.array([end - start, end - start])))
        return Boundary(tuple(closed))


def _spline(t: np.ndarray, values: np.ndarray, slopes: np.ndarray) -> "CubicHermiteSpline":
    """A function by its values and slopes at places t."""
    from scipy.interpolate import CubicHermiteSpline  # takes a third of a second, and round wire needs none

    return CubicHermiteSpline(t, values, slopes)


def _above(piece: "CubicHermiteSpline", level: float, normal: np.ndarray) -> "Iterator[CubicHermiteSpline]":
    """The parts of a piece with b · n > −level."""
    roots = _spline(piece.x, piece(piece.x) @ normal + level, piece(piece.x, 1) @ normal).roots()
    marks = np.unique(np.concatenate([[0.0], roots[(roots > 0.0) & (roots < 1.0)], [1.0]]))
    for start, end in pairwise(marks):
        if end - start > NOTHING and piece(0.5 * (start + end)) @ normal > -level:
            t = np.linspace(start, end, len(piece.x))
            yield _piece(piece(t), (end - start) * piece(t, 1))


def _piece(points: np.ndarray, slopes: np.ndarray) -> "CubicHermiteSpline":
    """b(t) through points at equal steps of t from 0 to 1, with its slopes; a straight line by its ends."""
    chord = points[-1] - points[0]
    length = np.linalg.norm(chord)
    off = points - points[0]
    if length > 0.0 and np.abs(off[:, 0] * chord[1] - off[:, 1] * chord[0]).max() <= STRAIGHT * length**2:
        points, slopes = points[[0, -1]], np.array([chord, chord])
    return _spline(np.linspace(0.0, 1.0, len(points)), points, slopes)


def _reversed(piece: "CubicHermiteSpline") -> "CubicHermiteSpline":
    return _piece(piece(piece.x)[::-1], -piece(piece.x, 1)[::-1])
