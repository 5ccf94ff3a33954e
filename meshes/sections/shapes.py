"""Outlines of a wire's cross-section, drawn as curves of a gmsh model.

Coordinates (ξ, η), mm: ξ points away from the coil's axis, η upwards along the spring. The origin lies on the centre
line, whose radius is half the mean diameter; shapes are centred on it by the middle of their width and height.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import gmsh
import numpy as np

from coilset.model.core.base.columns import number, read_rows
from coilset.model.core.base.errors import InputError, naming

THINNEST = 0.01  # wall of a tube, over its outer diameter
CLOSEST = 1e-6  # distance below which two points of an outline are one, over its size


class Outline(Protocol):
    """A closed curve around a section."""

    def draw(self) -> list[int]:
        """Draw the curve in the current gmsh model (OpenCASCADE); returns the tags of its pieces in order around it."""
        ...


def _positive(**lengths: float) -> None:
    for name, value in lengths.items():
        if not (np.isfinite(value) and value > 0):
            raise InputError(f"{value:g} mm is not possible; give a positive length", f"section.{name}")


@dataclass(frozen=True)
class Oval:
    """An ellipse; a round wire is one of equal `width` (radial) and `height` (axial), mm."""

    width: float
    height: float

    def __post_init__(self) -> None:
        _positive(width=self.width, height=self.height)

    def draw(self) -> list[int]:
        """See `Outline`."""
        a, b = 0.5 * self.width, 0.5 * self.height
        along = [1, 0, 0] if a >= b else [0, 1, 0]
        return [gmsh.model.occ.addEllipse(0, 0, 0, max(a, b), min(a, b), zAxis=[0, 0, 1], xAxis=along)]


@dataclass(frozen=True)
class Tube:
    """A round tube of two diameters, mm."""

    outer: float
    inner: float

    def __post_init__(self) -> None:
        _positive(outer=self.outer, inner=self.inner)
        if not self.inner < self.outer:
            raise InputError(f"{self.inner:g} mm is no inner diameter of a tube of {self.outer:g} mm", "section.inner")
        thickest = (1.0 - 2.0 * THINNEST) * self.outer
        if self.inner > thickest:
            raise InputError(
                f"leaves a wall of {0.5 * (self.outer - self.inner):.3g} mm; it must be {100.0 * THINNEST:g} % of the "
                f"outer diameter or more: give {thickest:g} mm or less",
                "section.inner",
            )

    @property
    def hole(self) -> float:
        """Inner over outer diameter."""
        return self.inner / self.outer

    def draw(self) -> list[int]:
        """See `Outline`: its outer circle."""
        return Oval(self.outer, self.outer).draw()


@dataclass(frozen=True)
class Egg:
    """Two circles, one towards the coil's axis and one away from it, and their two outer common tangents (Fuchs).

    Attributes:
        inside, outside: radii of the circles at the inside and at the outside of the coil, mm.
        distance: of their centres, mm.
    """

    inside: float
    outside: float
    distance: float

    def __post_init__(self) -> None:
        _positive(inside=self.inside, outside=self.outside, distance=self.distance)
        if not self.distance > abs(self.inside - self.outside):
            raise InputError(
                f"{self.distance:g} mm is too short: one circle is inside the other, which makes round wire",
                "section.distance",
            )

    def draw(self) -> list[int]:
        """See `Outline`."""
        occ, i, o, e = gmsh.model.occ, self.inside, self.outside, self.distance
        middle = 0.5 * (e + o - i)  # ξ from the inner circle's centre to the middle of the width
        cos = (i - o) / e  # of the angle from ξ at which the tangents touch: r(φ) = ξ cos φ + r has one value there
        sin = math.sqrt(1.0 - cos**2)

        def point(centre: float, radius: float, side: float) -> int:
            return occ.addPoint(centre - middle + radius * cos, side * radius * sin, 0)

        inner, outer = occ.addPoint(-middle, 0, 0), occ.addPoint(e - middle, 0, 0)
        ends = occ.addPoint(e - middle + o, 0, 0), occ.addPoint(-middle - i, 0, 0)
        a, b, c, d = point(e, o, -1.0), point(e, o, 1.0), point(0.0, i, 1.0), point(0.0, i, -1.0)
        arc, line = occ.addCircleArc, occ.addLine
        return [
            arc(a, outer, ends[0]),
            arc(ends[0], outer, b),
            line(b, c),
            arc(c, inner, ends[1]),
            arc(ends[1], inner, d),
            line(d, a),
        ]


def round_wire(diameter: float) -> Oval:
    """The section of a round wire of the given diameter, mm."""
    _positive(diameter=diameter)
    return Oval(diameter, diameter)


@dataclass(frozen=True)
class Trapezoid:
    """A trapezium with two sides parallel to the coil's axis and rounded corners, like keystone wire before coiling.

    Attributes:
        width: radial, mm.
        inside, outside: axial heights at the inside and at the outside of the coil, mm; equal ones make a rectangle.
        corner: radius of the corners, mm; 0 leaves them sharp.
    """

    width: float
    inside: float
    outside: float
    corner: float = 0.0

    def __post_init__(self) -> None:
        _positive(width=self.width, inside=self.inside, outside=self.outside)
        if not self.corner >= 0:
            raise InputError(f"{self.corner:g} mm is not possible; give a radius from 0", "section.corner")

    @property
    def corners(self) -> np.ndarray:
        """Its four corners before rounding, anticlockwise, shape (4, 2), mm."""
        a, i, o = 0.5 * self.width, 0.5 * self.inside, 0.5 * self.outside
        return np.array([(-a, -i), (a, -o), (a, o), (-a, i)])

    def draw(self) -> list[int]:
        """See `Outline`."""
        return _rounded(self.corners, self.corner)


def rectangle(width: float, height: float, corner: float = 0.0) -> Trapezoid:
    """A rectangle of radial `width` and axial `height` with rounded corners, mm."""
    return Trapezoid(width, height, height, corner)


@dataclass(frozen=True, eq=False)
class Curve:
    """A closed curve through given points.

    Attributes:
        points: shape (n, 2), mm, in order around the section; the last one is joined to the first.
        smooth: a cubic spline through them instead of straight sides.
    """

    points: np.ndarray
    smooth: bool = False

    def __post_init__(self) -> None:
        points = np.asarray(self.points, float)
        if points.ndim != 2 or points.shape[1] != 2 or len(points) < 3 or not np.isfinite(points).all():
            raise InputError("give three points (ξ, η) or more, in mm", "section.points")
        before = np.roll(points, 1, axis=0)  # a point that is given twice, as the first one at the end, counts once
        points = points[np.linalg.norm(points - before, axis=1) > CLOSEST * np.ptp(points, axis=0).max()]
        if len(points) < 3 or not abs(signed_area(points)) > 0:
            raise InputError(
                "the curve encloses no area; give its points in their order round the section", "section.points"
            )
        if crosses_itself(points):
            raise InputError(
                "the curve crosses or touches itself; give its points in their order round the section",
                "section.points",
            )
        object.__setattr__(self, "points", points if signed_area(points) > 0 else points[::-1])

    @classmethod
    def read(cls, path: str | Path, smooth: bool = False) -> "Curve":
        """Read a CSV file with two columns ξ, η in mm; its first line may name them, without a number in it.

        Raises:
            InputError: if it cannot be read, with the line.
        """
        rows, points = read_rows(path), []
        for line, row in rows:
            pair = [number(text) for text in row]
            if len(pair) == 2 and all(map(math.isfinite, pair)):
                points.append(pair)
            elif line != rows[0][0] or any(map(math.isfinite, pair)):  # otherwise the columns' names
                raise InputError(f"'{','.join(row)}' is not a pair of numbers ξ, η in mm", f"line {line}", path)
        with naming(path):
            return cls(np.array(points), smooth)

    def draw(self) -> list[int]:
        """See `Outline`."""
        if not self.smooth:
            return _rounded(self.points, 0.0)
        tags = [gmsh.model.occ.addPoint(ξ, η, 0) for ξ, η in self.points]
        return [gmsh.model.occ.addSpline([*tags, tags[0]])]


def signed_area(points: np.ndarray) -> float:
    """Area of a polygon, mm², positive if its points run anticlockwise, shape (n, 2)."""
    x, y = points.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def crosses_itself(points: np.ndarray) -> bool:
    """Whether two non-adjacent sides of a closed polygon cross or touch, shape (n, 2)."""
    a, b = points, np.roll(points, -1, axis=0)
    low, high = np.minimum(a, b), np.maximum(a, b)

    def side(p: np.ndarray, q: np.ndarray, r: np.ndarray) -> np.ndarray:
        return np.sign(
            (q[..., 0] - p[..., 0]) * (r[..., 1] - p[..., 1]) - (q[..., 1] - p[..., 1]) * (r[..., 0] - p[..., 0])
        )

    i, j = np.triu_indices(len(points), 2)
    apart = (j - i) < len(points) - 1
    i, j = i[apart], j[apart]
    near = np.all((low[i] <= high[j]) & (low[j] <= high[i]), axis=1)  # or else two sides of one straight line would do
    return bool(
        np.any(
            near
            & (side(a[i], b[i], a[j]) * side(a[i], b[i], b[j]) <= 0)
            & (side(a[j], b[j], a[i]) * side(a[j], b[j], b[i]) <= 0)
        )
    )


def _rounded(corners: np.ndarray, radius: float) -> list[int]:
    """Straight sides between anticlockwise corners, joined by tangent arcs of the given radius."""
    occ, n = gmsh.model.occ, len(corners)
    ends, arcs = [], []
    for i in range(n):
        here, before, after = corners[i], corners[i - 1], corners[(i + 1) % n]
        a, b = (before - here) / np.linalg.norm(before - here), (after - here) / np.linalg.norm(after - here)
        half = 0.5 * np.arccos(np.clip(a @ b, -1, 1))
        reach = radius / np.tan(half)
        if 2 * reach > min(np.linalg.norm(before - here), np.linalg.norm(after - here)):
            raise InputError(f"{radius:g} mm is more than the sides allow", "section.corner")
        points = [occ.addPoint(*(here + reach * d), 0) for d in ((a, b) if radius else (a,))]
        ends.append((points[0], points[-1]))
        if radius:
            middle = (a + b) / np.linalg.norm(a + b)
            centre = occ.addPoint(*(here + radius / np.sin(half) * middle), 0)
            arcs.append(occ.addCircleArc(points[0], centre, points[1]))
    sides = [occ.addLine(ends[i][1], ends[(i + 1) % n][0]) for i in range(n)]
    if not radius:
        return sides
    return [piece for i in range(n) for piece in (arcs[i], sides[i])]


# constructor, and the minimum and maximum number of lengths
WORDS: dict[str, tuple[Callable[..., Outline], int, int]] = {
    "round": (round_wire, 1, 1),
    "oval": (Oval, 2, 2),
    "rectangle": (rectangle, 2, 3),
    "trapezoid": (Trapezoid, 3, 4),
    "egg": (Egg, 3, 3),
}
FORMS = (
    "round:d, oval:width:height, rectangle:width:height[:corner], trapezoid:width:inside:outside[:corner], "
    "egg:inside:outside:distance in mm"
)


def parse(text: str) -> Outline:
    """A section in words, such as `rectangle:4:5:0.5`, or a CSV file of its outline; `smooth:FILE` for a curved one.

    Raises:
        InputError: if it is none of these.
    """
    word, *rest = text.split(":")
    if word in WORDS:
        make, least, most = WORDS[word]
        try:
            lengths = [float(part) for part in rest]
        except ValueError:
            lengths = []
        if not least <= len(lengths) <= most:
            raise InputError(f"'{text}' is not a section; give {FORMS}", "--section")
        return make(*lengths)
    smooth = word == "smooth" and bool(rest)
    path = ":".join(rest) if smooth else text
    if not path.endswith(".csv"):
        raise InputError(f"'{text}' is not a section; give {FORMS}, or a file.csv of its outline", "--section")
    return Curve.read(path, smooth)
