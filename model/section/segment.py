"""What grinding leaves of a round wire's section: a segment of the disk, its points, and how it warps.

All lengths are in wire radii. The plane that the wheel left crosses the section in a straight line, at the `level` from
the wire's axis on the side away from the `normal`: the points p of the unit disk with p · normal > −level are left.
With the height ζ = cos φ above the axis along the normal and the place η = v sin φ across it, the segment is
0 < φ < arccos(−level), −1 < v < 1, and dA = sin² φ dφ dv: Gauss-Legendre in both converges like a power series.
"""

from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np

from coilset.model.section.outline import Section
from coilset.model.section.polynomials import Basis
from coilset.model.section.rules import DiskRule, rim

WHOLE = 1.0  # a level from which on nothing is cut away
DEEPEST = -0.999  # the wire that is left there is half a thousandth of its diameter thick
FINE = 24  # points in each direction, for integrals of polynomials
SLENDERNESS = 1.6  # points over the height for each of those across it


@dataclass(frozen=True)
class Segment(Section):
    """The disk without what lies beyond a straight line.

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
        (x, a), (v, b) = (_gauss(n) for n in (over, across))
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
        return Basis.over(degree, *self.fine, (1.0 - half) * n, axes)


@cache
def _gauss(number: int) -> tuple[np.ndarray, np.ndarray]:
    return np.polynomial.legendre.leggauss(number)
