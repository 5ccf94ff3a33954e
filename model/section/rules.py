"""Quadrature of the disk of radius 1; weights sum to 1, so that an integral is πR² Σ w f(Ry, Rz)."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class DiskRule:
    """Points (y, z) of the unit disk, shape (points, 2), and their weights, shape (points,)."""

    points: np.ndarray
    weights: np.ndarray
    name: str

    def __len__(self) -> int:
        return len(self.weights)


def abramowitz9() -> DiskRule:
    """The thesis's rule (5.2.43): Abramowitz and Stegun 25.4.61, nine points, exact for I = πR⁴/4."""
    ring = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)]
    square = [(0.5, 0.5), (0.5, -0.5), (-0.5, 0.5), (-0.5, -0.5)]
    weights = [1 / 6] + 4 * [1 / 24] + 4 * [1 / 6]
    return DiskRule(np.array([(0.0, 0.0), *ring, *square]), np.array(weights), "abramowitz9")


def polar(radial: int = 4, angular: int = 12) -> DiskRule:
    """Gauss rule in r² times equal angles: no point on the axis, where the stress of torsion vanishes.

    Args:
        radial: number of rings, from 1.
        angular: number of equal angles, from 3.

    With s = r², dA = ½ ds dφ, so Gauss-Legendre in s is exact for even polynomials of r up to degree 4·radial − 2;
    n equal angles are exact for harmonics below n.
    """
    s, w = np.polynomial.legendre.leggauss(radial)
    r = np.sqrt(0.5 * (s + 1.0))
    angle = 2.0 * np.pi * (np.arange(angular) + 0.5) / angular
    points = np.stack([np.outer(r, np.cos(angle)), np.outer(r, np.sin(angle))], axis=-1).reshape(-1, 2)
    return DiskRule(points, np.repeat(0.5 * w / angular, angular), f"polar {radial} × {angular}")


def upper_half(rule: DiskRule) -> DiskRule:
    """The points of a symmetric rule with z > 0, weights doubled: for what is the same, or opposite, at z and −z."""
    above = rule.points[:, 1] > 0.0
    return DiskRule(rule.points[above], 2.0 * rule.weights[above], f"upper half of {rule.name}")


SURFACE_POINTS = 24


def rim(points: int = SURFACE_POINTS) -> np.ndarray:
    """Points (y, z) of the unit circle at equal angles from the y axis, shape (points, 2)."""
    angle = 2.0 * np.pi * np.arange(points) / points
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)
