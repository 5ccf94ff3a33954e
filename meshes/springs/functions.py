"""Functions of the turn: piecewise polynomials, so that slopes and integrals are exact."""

from collections.abc import Callable, Iterable, Sequence
from functools import lru_cache
from math import factorial

import numpy as np

from coilset.meshes.springs.piecewise import PiecewisePolynomial

DEGREE = 3

INTERPOLATIONS = ("linear", "monotone", "spline")


def polynomial(coefficients: Sequence[float] | np.ndarray, start: float, end: float) -> PiecewisePolynomial:
    """One polynomial on an interval.

    Args:
        coefficients: of (turn − start)⁰, (turn − start)¹, …, at most to the third power.
        start: where the interval begins, turns.
        end: where it ends, turns.

    Returns:
        The function.
    """
    padded = np.zeros((DEGREE + 1, 1))
    padded[DEGREE - np.arange(len(coefficients)), 0] = coefficients
    return PiecewisePolynomial(padded, [start, end])


def constant(value: float, turns: float) -> PiecewisePolynomial:
    """A constant from turn 0 to `turns`."""
    return polynomial([value], 0.0, turns)


def tabulated(turn: np.ndarray, value: np.ndarray, interpolation: str) -> PiecewisePolynomial:
    """A function through the points of a table.

    Args:
        turn: increasing turns, shape (n,).
        value: values there, shape (n,).
        interpolation: ``linear``; ``monotone``, cubic pieces that do not overshoot (PCHIP, continuous slope);
            ``spline``, the cubic spline (continuous curvature).

    Returns:
        The function.
    """
    if interpolation == "linear" or len(turn) == 2:
        slope = np.diff(value) / np.diff(turn)
        return PiecewisePolynomial(np.vstack([np.zeros((DEGREE - 1, len(slope))), slope, value[:-1]]), turn)
    from scipy.interpolate import CubicSpline, PchipInterpolator  # takes a quarter of a second, so only where needed

    if interpolation == "monotone":
        pieces = PchipInterpolator(turn, value)
    elif interpolation == "spline":
        pieces = CubicSpline(turn, value)
    else:
        raise ValueError(f"interpolation must be one of {', '.join(INTERPOLATIONS)}, not {interpolation!r}")
    return PiecewisePolynomial(pieces.c, pieces.x)


def smoothed(turn: np.ndarray, value: np.ndarray, noise: float) -> PiecewisePolynomial:
    """A cubic spline with as few pieces as the noise of the values allows (FITPACK's smoothing spline).

    Args:
        turn: increasing turns, shape (n,).
        value: measured values, shape (n,).
        noise: their standard deviation; the mean square of the residuals becomes its square.

    Returns:
        The function.
    """
    from scipy.interpolate import PPoly, splrep

    pieces = PPoly.from_spline(splrep(turn, value, w=np.full(len(turn), 1 / noise), s=len(turn)))
    real = np.diff(pieces.x) > 0  # the end knots are repeated
    return PiecewisePolynomial(pieces.c[:, real], np.append(pieces.x[:-1][real], pieces.x[-1]))


def added(left: PiecewisePolynomial, right: PiecewisePolynomial, factor: float = 1.0) -> PiecewisePolynomial:
    """The function `left` + `factor` · `right`; both must begin and end at the same turns."""
    breaks = np.union1d(left.x, right.x)
    return PiecewisePolynomial(_coefficients(left, breaks) + factor * _coefficients(right, breaks), breaks)


def restricted(function: PiecewisePolynomial, start: float, end: float) -> PiecewisePolynomial:
    """The part of a function between two turns."""
    breaks = np.array([start, *function.x[(function.x > start) & (function.x < end)], end])
    return PiecewisePolynomial(_coefficients(function, breaks), breaks)


def _coefficients(function: PiecewisePolynomial, breaks: np.ndarray) -> np.ndarray:
    """Coefficients of a function between breaks that include its own, by Taylor expansion at the left of each piece."""
    terms = [function.derivative(k)(breaks[:-1]) / factorial(k) for k in range(DEGREE, 0, -1)]
    return np.array([*terms, function(breaks[:-1])])


def blended(left: PiecewisePolynomial, right: PiecewisePolynomial, start: float, end: float) -> PiecewisePolynomial:
    """A cubic from one function to another that matches value and slope of each at its end."""
    length = end - start
    y0, s0 = left(start), left.derivative()(start) * length
    y1, s1 = right(end), right.derivative()(end) * length
    in_unit = np.array([y0, s0, 3 * (y1 - y0) - 2 * s0 - s1, 2 * (y0 - y1) + s0 + s1])
    return polynomial(in_unit / length ** np.arange(DEGREE + 1), start, end)


def joined(parts: Iterable[PiecewisePolynomial]) -> PiecewisePolynomial:
    """Consecutive functions as a single one; parts of zero length are left out."""
    parts = [part for part in parts if part.x[-1] > part.x[0]]
    breaks = np.concatenate([parts[0].x[:1], *(part.x[1:] for part in parts)])
    return PiecewisePolynomial(np.hstack([part.c for part in parts]), breaks)


@lru_cache
def gauss(points: int) -> tuple[np.ndarray, np.ndarray]:
    """Abscissae and weights of Gauss's quadrature over −1 … 1, shape (points,) each."""
    return np.polynomial.legendre.leggauss(points)


def integral(integrand: Callable[[np.ndarray], np.ndarray], breaks: np.ndarray, points: int = 6) -> np.ndarray:
    """Integrals over every interval between breaks by Gauss quadrature.

    Args:
        integrand: function of arrays of turns.
        breaks: increasing turns, shape (n + 1,); the integrand is smooth between them.
        points: number of Gauss points in every interval.

    Returns:
        The integrals, shape (n,).
    """
    ξ, w = gauss(points)
    half = 0.5 * np.diff(breaks)[:, None]
    middle = 0.5 * (breaks[1:] + breaks[:-1])[:, None]
    return (half * w * integrand(middle + half * ξ)).sum(axis=1)
