"""Functions on a wire's section that are orthogonal to each other, by degree: polynomials, or those of a ring."""

from dataclasses import dataclass
from math import gamma, pi
from typing import Protocol

import numpy as np


def moment(a: int, b: int) -> float:
    """Mean of y^a z^b over the unit disk (Folland, Amer. Math. Monthly 108 (2001) 446)."""
    if a % 2 or b % 2:
        return 0.0
    return 2 * gamma((a + 1) / 2) * gamma((b + 1) / 2) / gamma((a + b) / 2 + 1) / (a + b + 2) / pi


def exponents(degree: int) -> np.ndarray:
    """Exponents of the monomials y^a z^b up to a degree, ascending, shape ((degree + 1)(degree + 2)/2, 2)."""
    return np.array([(total - b, b) for total in range(degree + 1) for b in range(total + 1)])


class Functions(Protocol):
    """Functions of the place on a section; the first is 1, the next two span y and z."""

    def __call__(self, places: np.ndarray) -> np.ndarray:
        """Their values and slopes in y and z at points, shape (m, 2) → (3, m, n)."""
        ...


@dataclass(frozen=True, eq=False)
class Monomials:
    """Powers of two coordinates.

    Attributes:
        powers: exponents, shape (n, 2).
        origin, axes: the coordinates are axes (p − origin); shapes (2,) and (2, 2).
    """

    powers: np.ndarray
    origin: np.ndarray
    axes: np.ndarray

    def __call__(self, places: np.ndarray) -> np.ndarray:
        """See `Functions`."""
        y, z = ((places - self.origin) @ self.axes.T).T
        a, b = self.powers.T
        of_y, of_z = (np.vander(x, self.powers.max() + 1, increasing=True) for x in (y, z))  # their powers
        lower_y, lower_z = a * of_y[:, np.maximum(a - 1, 0)], b * of_z[:, np.maximum(b - 1, 0)]
        of_y, of_z = of_y[:, a], of_z[:, b]
        slope_y, slope_z = lower_y * of_z, of_y * lower_z
        (yy, yz), (zy, zz) = self.axes
        return np.array([of_y * of_z, slope_y * yy + slope_z * zy, slope_y * yz + slope_z * zz])


@dataclass(frozen=True, eq=False)
class Harmonics:
    """Of a ring about the origin: powers of the place x across it, −1 … 1, times cos nφ and sin nφ around it.

    Up to the order, with x^a for a + n < order, and 1 and x with each. A polynomial of y and z has cos nφ only with the
    powers n, n + 2, … of the radius, which hardly change over a thin wall: far beyond yield, the force of tubes with a
    hole of 0.1 to 0.95 was up to 1.3 % too high with those of degree 9, 0.09 % with the order 5.

    Attributes:
        order: of the highest harmonic.
        hole: inner over outer radius.
    """

    order: int
    hole: float

    def __call__(self, places: np.ndarray) -> np.ndarray:
        """See `Functions`."""
        y, z = places.T
        radius, half = np.hypot(y, z), 0.5 * (1.0 - self.hole)
        x, turned = (radius - 0.5 * (1.0 + self.hole)) / half, (y + 1j * z) / radius
        one, zero = np.ones_like(y), np.zeros_like(y)
        found = [(one, zero, zero), (y, one, zero), (z, zero, one)]
        for n in range(self.order + 1):
            around = turned**n
            for a in range(max(1, self.order - 1 - n) + 1):
                if (n, a) in ((0, 0), (1, 1)):
                    continue  # among the first three
                across, outwards = x**a, a * x ** max(a - 1, 0) / half
                for part, along in ((around.real, -n * around.imag), (around.imag, n * around.real))[: 2 if n else 1]:
                    of_radius, of_angle = outwards * part, across * along / radius
                    of_y = turned.real * of_radius - turned.imag * of_angle
                    of_z = turned.imag * of_radius + turned.real * of_angle
                    found.append((across * part, of_y, of_z))
        return np.moveaxis(np.array(found), 0, 2)


@dataclass(frozen=True, eq=False)
class Basis:
    """Functions p_k with mean(p_k p_l) = δ_kl, orthogonalised from those that span them.

    They have no mean and no moment, ∫ p dA = ∫ y p dA = ∫ z p dA = 0.

    Attributes:
        functions: that span them.
        coefficients: shape (n, n), one row a function; the first three are 1 and linear, and left out by a call.
    """

    functions: Functions
    coefficients: np.ndarray

    @classmethod
    def of_disk(cls, degree: int) -> "Basis":
        """Polynomials over the unit disk."""
        powers = exponents(degree)
        moments = np.array([[moment(*(p + q)) for q in powers] for p in powers])
        return cls(Monomials(powers, np.zeros(2), np.eye(2)), np.linalg.inv(np.linalg.cholesky(moments)))

    @classmethod
    def over(cls, functions: Functions, places: np.ndarray, weights: np.ndarray) -> "Basis":
        """Over a region of any shape.

        Args:
            functions: that span them.
            places, weights: a rule that integrates products of two of these over it, shapes (m, 2) and (m,).
        """
        values = functions(places)[0]
        # R is Cholesky's factor of the moments, which would square how near the functions are to each other in a wall
        R = np.linalg.qr(np.sqrt(weights / weights.sum())[:, None] * values)[1]
        return cls(functions, np.linalg.inv(np.sign(np.diag(R))[:, None] * R).T)

    def __call__(self, places: np.ndarray) -> np.ndarray:
        """p, ∂p/∂y, ∂p/∂z of those beyond the linear ones, shape (m, 2) → (3, m, functions)."""
        return np.ascontiguousarray(self.functions(places) @ self.coefficients[3:].T)
