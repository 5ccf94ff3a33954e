"""Piecewise polynomials: bit for bit the same as `scipy.interpolate.PPoly`, which takes long to load."""

from collections.abc import Sequence
from functools import cached_property
from math import factorial, prod

import numpy as np


class PiecewisePolynomial:
    """Consecutive polynomials; the first and the last extend beyond the ends.

    Args:
        coefficients: of the powers of (x − left end of the piece), highest first, shape (degree + 1, pieces).
        breaks: increasing ends of the pieces, shape (pieces + 1,).

    Attributes:
        c, x: the coefficients and the breaks.
    """

    def __init__(self, coefficients: np.ndarray, breaks: Sequence[float] | np.ndarray) -> None:
        self.c = np.array(coefficients, dtype=float)
        self.x = np.array(breaks, dtype=float)

    def __call__(self, x: np.ndarray | float) -> np.ndarray:
        """Values, in the shape of `x`."""
        x = np.asarray(x, dtype=float)
        if len(self.x) == 2:
            return np.asarray(_values(self._terms[:, 0], x - self.x[0]))
        piece = np.searchsorted(self.x[1:-1], x, side="right")  # the outer ones go on beyond their ends
        return np.asarray(_values(self._terms[:, piece], x - self.x[piece]))

    def __mul__(self, factor: float) -> "PiecewisePolynomial":
        return PiecewisePolynomial(factor * self.c, self.x)

    def __sub__(self, other: "PiecewisePolynomial") -> "PiecewisePolynomial":
        """The difference, on the pieces of both."""
        breaks = np.unique(np.concatenate([self.x, other.x]))
        ours, theirs = self._on(breaks), other._on(breaks)
        degree = max(len(ours), len(theirs))
        first, second = (np.pad(c, ((degree - len(c), 0), (0, 0))) for c in (ours, theirs))
        return PiecewisePolynomial(first - second, breaks)

    def _on(self, breaks: np.ndarray) -> np.ndarray:
        """Coefficients on finer pieces: cₖ = f⁽ᵏ⁾/k! at the left end of each."""
        inside = 0.5 * (breaks[1:] + breaks[:-1])  # a piece's own, not its neighbour's
        piece = np.clip(np.searchsorted(self.x, inside, side="right") - 1, 0, len(self.x) - 2)
        offset, degree = breaks[:-1] - self.x[piece], len(self.c) - 1
        found = []
        for order in range(degree, -1, -1):
            c = self.derivative(order).c[:, piece]
            found.append(_values(c, offset) / factorial(order))
        return np.array(found)

    @cached_property
    def _terms(self) -> np.ndarray:
        """The coefficients without the highest powers that no piece has: most springs' functions are constant."""
        used = np.flatnonzero(self.c[:-1].any(axis=1))
        return self.c[used[0] if len(used) else -1 :]

    def derivative(self, order: int = 1) -> "PiecewisePolynomial":
        """The derivative of the given order; each is computed once."""
        if order not in self._derivatives:
            kept = self.c[:-order] if order else self.c
            powers = range(len(kept), 0, -1)  # of the derivative, and 1
            factors = np.array([prod(range(power, power + order)) for power in powers], dtype=float)
            c = kept * factors[:, None] if len(kept) else np.zeros((1, self.c.shape[1]))
            self._derivatives[order] = PiecewisePolynomial(c, self.x)
        return self._derivatives[order]

    @cached_property
    def _derivatives(self) -> dict[int, "PiecewisePolynomial"]:
        return {}

    def antiderivative(self) -> "PiecewisePolynomial":
        """The integral from the first break."""
        powers = np.arange(len(self.c), 0, -1)
        c = np.vstack([self.c / powers[:, None], np.zeros(self.c.shape[1])])
        length = np.diff(self.x)
        for piece in range(1, c.shape[1]):
            c[-1, piece] = _values(c[:, piece - 1], length[piece - 1])
        return PiecewisePolynomial(c, self.x)


def _values(c: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Σ c sᵏ, the lowest power first, as PPoly adds them."""
    value, power = np.full(np.shape(s), c[-1]), s
    for term in c[-2::-1]:
        value += term * power
        power = power * s
    return value
