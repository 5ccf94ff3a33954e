"""Quadrature of the disk of radius 1; weights sum to 1, so that an integral is πR² Σ w f(Ry, Rz)."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

ON_AXIS = 1e-12  # below which a coordinate is the sine of π with its rounding


@dataclass(frozen=True)
class DiskRule:
    """Points (y, z) of the unit disk, shape (points, 2), and their weights, shape (points,).

    Those of a wire that is not round have its Outlined section as `outline`, and their weights its area over π as sum.
    """

    points: np.ndarray
    weights: np.ndarray
    name: str
    outline: Any = None

    def __len__(self) -> int:
        return len(self.weights)


def abramowitz9() -> DiskRule:
    """The thesis's rule (5.2.43): Abramowitz and Stegun 25.4.61, nine points, exact for I = πR⁴/4."""
    ring = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)]
    square = [(0.5, 0.5), (0.5, -0.5), (-0.5, 0.5), (-0.5, -0.5)]
    weights = [1 / 6] + 4 * [1 / 24] + 4 * [1 / 6]
    return DiskRule(np.array([(0.0, 0.0), *ring, *square]), np.array(weights), "abramowitz9")


@lru_cache(maxsize=16)  # cases of a sweep share rules
def polar(radial: int = 8, angular: int = 20, staggered: bool = True) -> DiskRule:
    """Gauss rule in r² times equal angles: no point on the axis, where the stress of torsion vanishes.

    Args:
        radial: number of rings, from 1.
        angular: number of equal angles, from 3.
        staggered: every second ring is turned by half the angle between points, so that the rings together have twice
            as many angles.

    With s = r², dA = ½ ds dφ, so Gauss-Legendre in s is exact for even polynomials of r up to degree 4·radial − 2;
    n equal angles are exact for harmonics below n.
    """
    s, w = np.polynomial.legendre.leggauss(radial)
    r = np.sqrt(0.5 * (s + 1.0))[:, None]
    shift = np.where((np.arange(radial) % 2 == 1) & staggered, 0.0, 0.5)[:, None]
    angle = 2.0 * np.pi * (np.arange(angular) + shift) / angular
    points = np.stack([r * np.cos(angle), r * np.sin(angle)], axis=-1).reshape(-1, 2)
    name = f"polar {radial} × {angular}{', staggered' if staggered else ''}"
    return DiskRule(points, np.repeat(0.5 * w / angular, angular), name)


def upper_half(rule: DiskRule) -> DiskRule:
    """The points of a symmetric rule with z ≥ 0, with doubled weights for z > 0: for functions that are even or odd
    in z."""
    y, z = rule.points.T
    z = np.where(np.abs(z) > ON_AXIS, z, 0.0)
    kept = z >= 0.0
    weights = np.where(z > 0.0, 2.0, 1.0) * rule.weights
    return DiskRule(np.stack([y, z], axis=1)[kept], weights[kept], f"upper half of {rule.name}")


SURFACE_POINTS = 24


def rim(points: int = SURFACE_POINTS) -> np.ndarray:
    """Points (y, z) of the unit circle at equal angles from the y axis, shape (points, 2)."""
    angle = 2.0 * np.pi * np.arange(points) / points
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def spread(
    points: np.ndarray,
    weights: np.ndarray,
    sections: tuple[int, int],
    cut: Iterable[tuple[int, int, np.ndarray, np.ndarray]],
) -> tuple[np.ndarray, np.ndarray]:
    """Points of all sections in wire radii, (n, g, points, 2), and their shares of the disk, (n, g, points).

    Args:
        points, weights: of all sections but the `cut` ones, each with its element, section, points and weights.
        sections: number of elements and of the sections of each.
    """
    places = np.broadcast_to(points, (*sections, *points.shape)).copy()
    shares = np.broadcast_to(weights, (*sections, len(weights))).copy()
    for cell, section, own_points, own_weights in cut:
        places[cell, section], shares[cell, section] = own_points, own_weights
    return places, shares
