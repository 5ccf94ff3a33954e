"""Polynomials on a wire's section that are orthogonal to each other, degree by degree."""

from dataclasses import dataclass
from math import gamma, pi

import numpy as np


def moment(a: int, b: int) -> float:
    """Mean of y^a z^b over the unit disk (Folland, Amer. Math. Monthly 108 (2001) 446)."""
    if a % 2 or b % 2:
        return 0.0
    return 2 * gamma((a + 1) / 2) * gamma((b + 1) / 2) / gamma((a + b) / 2 + 1) / (a + b + 2) / pi


def exponents(degree: int) -> np.ndarray:
    """Exponents of the monomials y^a z^b up to a degree, ascending, shape ((degree + 1)(degree + 2)/2, 2)."""
    return np.array([(total - b, b) for total in range(degree + 1) for b in range(total + 1)])


@dataclass(frozen=True, eq=False)
class Basis:
    """Polynomials p_k of degree 2 and more with mean(p_k p_l) = δ_kl, by Cholesky's factors of the monomials' moments.

    They have no mean and no moment, ∫ p dA = ∫ y p dA = ∫ z p dA = 0.

    Attributes:
        powers: exponents of the monomials, shape (n, 2).
        coefficients: shape (n, n), one row a polynomial; the first three are 1 and linear, and left out by a call.
        origin, axes: the monomials are those of axes (p − origin); shapes (2,) and (2, 2).
    """

    powers: np.ndarray
    coefficients: np.ndarray
    origin: np.ndarray
    axes: np.ndarray

    @classmethod
    def of_disk(cls, degree: int) -> "Basis":
        """Over the unit disk."""
        powers = exponents(degree)
        moments = np.array([[moment(*(p + q)) for q in powers] for p in powers])
        return cls(powers, np.linalg.inv(np.linalg.cholesky(moments)), np.zeros(2), np.eye(2))

    @classmethod
    def over(
        cls, degree: int, places: np.ndarray, weights: np.ndarray, origin: np.ndarray, axes: np.ndarray
    ) -> "Basis":
        """Over a region of any shape.

        Args:
            degree: the highest.
            places, weights: a rule that integrates polynomials of twice the degree over it, shapes (m, 2) and (m,).
            origin, axes: that make its coordinates lie between −1 and 1.
        """
        powers = exponents(degree)
        plain = cls(powers, np.eye(len(powers)), origin, axes)
        values = plain.monomials(places)[0]
        # R is Cholesky's factor of the moments, which would square how near the monomials are to each other in a wall
        R = np.linalg.qr(np.sqrt(weights / weights.sum())[:, None] * values)[1]
        return cls(powers, np.linalg.inv(np.sign(np.diag(R))[:, None] * R).T, origin, axes)

    def monomials(self, places: np.ndarray) -> np.ndarray:
        """Monomials and their slopes in y and z at points, shape (m, 2) → (3, m, n)."""
        y, z = ((places - self.origin) @ self.axes.T).T
        a, b = self.powers.T
        of_y, of_z = (np.vander(x, self.powers.max() + 1, increasing=True) for x in (y, z))  # their powers
        lower_y, lower_z = a * of_y[:, np.maximum(a - 1, 0)], b * of_z[:, np.maximum(b - 1, 0)]
        of_y, of_z = of_y[:, a], of_z[:, b]
        slope_y, slope_z = lower_y * of_z, of_y * lower_z
        (yy, yz), (zy, zz) = self.axes
        return np.array([of_y * of_z, slope_y * yy + slope_z * zy, slope_y * yz + slope_z * zz])

    def __call__(self, places: np.ndarray) -> np.ndarray:
        """p, ∂p/∂y, ∂p/∂z of the polynomials of degree 2 and more, shape (m, 2) → (3, m, polynomials)."""
        return np.ascontiguousarray(self.monomials(places) @ self.coefficients[3:].T)
