"""Polynomials on the unit disk that are orthogonal to each other, degree by degree."""

from math import gamma, pi

import numpy as np


def moment(a: int, b: int) -> float:
    """Mean of y^a z^b over the unit disk (Folland, Amer. Math. Monthly 108 (2001) 446)."""
    if a % 2 or b % 2:
        return 0.0
    return 2 * gamma((a + 1) / 2) * gamma((b + 1) / 2) / gamma((a + b) / 2 + 1) / (a + b + 2) / pi


def orthonormal(degree: int) -> tuple[np.ndarray, np.ndarray]:
    """Polynomials p_k with mean(p_k p_l) = δ_kl, by Cholesky's factors of the monomials' moments.

    Args:
        degree: the highest.

    Returns:
        Exponents of the monomials y^a z^b in ascending degree, shape (n, 2), and coefficients, shape (n, n), one row a
        polynomial; the first is 1, the next two are proportional to y and z, and n = (degree + 1)(degree + 2)/2.
    """
    powers = np.array([(total - b, b) for total in range(degree + 1) for b in range(total + 1)])
    moments = np.array([[moment(*(p + q)) for q in powers] for p in powers])
    return powers, np.linalg.inv(np.linalg.cholesky(moments))


def values_and_slopes(degree: int, y: np.ndarray, z: np.ndarray) -> np.ndarray:
    """The polynomials of degree 2 and more at points of the unit disk.

    They have no mean and no moment, ∫ p dA = ∫ y p dA = ∫ z p dA = 0.

    Args:
        degree: the highest.
        y, z: shape (points,).

    Returns:
        p, ∂p/∂y, ∂p/∂z, shape (3, points, polynomials).
    """
    powers, coefficients = orthonormal(degree)
    a, b = powers.T
    monomials = np.array([
        y[:, None] ** a * z[:, None] ** b,
        a * y[:, None] ** np.maximum(a - 1, 0) * z[:, None] ** b,
        b * y[:, None] ** a * z[:, None] ** np.maximum(b - 1, 0),
    ])  # fmt: skip
    return np.ascontiguousarray(monomials @ coefficients[3:].T)
