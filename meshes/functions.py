"""Functions of the turn: piecewise polynomials, so that slopes and integrals are exact."""

from math import factorial

import numpy as np
from scipy.interpolate import CubicSpline, PchipInterpolator, PPoly, splrep

DEGREE = 3

INTERPOLATIONS = ("linear", "monotone", "spline")


def polynomial(coefficients, start, end):
    """One polynomial on an interval.

    Args:
        coefficients: of (turn − start)⁰, (turn − start)¹, …, at most to the third power.
        start: where the interval begins, turns.
        end: where it ends, turns.

    Returns:
        The function as a `scipy.interpolate.PPoly`.
    """
    padded = np.zeros((DEGREE + 1, 1))
    padded[DEGREE - np.arange(len(coefficients)), 0] = coefficients
    return PPoly(padded, [start, end])


def constant(value, turns):
    """The same value at every turn from 0 to `turns`."""
    return polynomial([value], 0.0, turns)


def tabulated(turn, value, interpolation):
    """A function through the points of a table.

    Args:
        turn: increasing turns, shape (n,).
        value: values there, shape (n,).
        interpolation: ``linear``; ``monotone``, cubic pieces that do not overshoot (PCHIP, continuous slope);
            ``spline``, the cubic spline (continuous curvature).

    Returns:
        The function as a `scipy.interpolate.PPoly`.
    """
    if interpolation == "linear" or len(turn) == 2:
        slope = np.diff(value) / np.diff(turn)
        return PPoly(np.vstack([np.zeros((DEGREE - 1, len(slope))), slope, value[:-1]]), turn)
    if interpolation == "monotone":
        pieces = PchipInterpolator(turn, value)
    elif interpolation == "spline":
        pieces = CubicSpline(turn, value)
    else:
        raise ValueError(f"interpolation must be one of {', '.join(INTERPOLATIONS)}, not {interpolation!r}")
    return PPoly(pieces.c, pieces.x)


def smoothed(turn, value, noise):
    """A cubic spline with as few pieces as the noise of the values allows (FITPACK's smoothing spline).

    Args:
        turn: increasing turns, shape (n,).
        value: measured values, shape (n,).
        noise: their standard deviation; the mean square of the residuals becomes its square.

    Returns:
        The function as a `scipy.interpolate.PPoly`.
    """
    pieces = PPoly.from_spline(splrep(turn, value, w=np.full(len(turn), 1 / noise), s=len(turn)))
    real = np.diff(pieces.x) > 0  # the end knots are repeated
    return PPoly(pieces.c[:, real], np.append(pieces.x[:-1][real], pieces.x[-1]))


def added(left, right, factor=1.0):
    """The function `left` + `factor` · `right`; both begin and end at the same turns."""
    breaks = np.union1d(left.x, right.x)
    return PPoly(_coefficients(left, breaks) + factor * _coefficients(right, breaks), breaks)


def restricted(function, start, end):
    """The part of a function between two turns."""
    breaks = np.array([start, *function.x[(function.x > start) & (function.x < end)], end])
    return PPoly(_coefficients(function, breaks), breaks)


def _coefficients(function, breaks):
    """Of a function between breaks, its own among them, by Taylor's expansion at the left of every piece."""
    terms = [function.derivative(k)(breaks[:-1]) / factorial(k) for k in range(DEGREE, 0, -1)]
    return np.array([*terms, function(breaks[:-1])])


def blended(left, right, start, end):
    """A cubic from one function to another, with the values and slopes of both at the two ends."""
    length = end - start
    y0, s0 = left(start), left.derivative()(start) * length
    y1, s1 = right(end), right.derivative()(end) * length
    in_unit = np.array([y0, s0, 3 * (y1 - y0) - 2 * s0 - s1, 2 * (y0 - y1) + s0 + s1])
    return polynomial(in_unit / length ** np.arange(DEGREE + 1), start, end)


def joined(parts):
    """Functions that follow each other, as one; parts of no length are left out."""
    parts = [part for part in parts if part.x[-1] > part.x[0]]
    breaks = np.concatenate([parts[0].x[:1], *(part.x[1:] for part in parts)])
    return PPoly(np.hstack([part.c for part in parts]), breaks)


def integral(integrand, breaks, points=6):
    """Integrals over every interval between breaks, by Gauss's rule.

    Args:
        integrand: function of arrays of turns.
        breaks: increasing turns, shape (n + 1,); the integrand is smooth between them.
        points: of Gauss's rule in every interval.

    Returns:
        The integrals, shape (n,).
    """
    ξ, w = np.polynomial.legendre.leggauss(points)
    half = 0.5 * np.diff(breaks)[:, None]
    middle = 0.5 * (breaks[1:] + breaks[:-1])[:, None]
    return (half * w * integrand(middle + half * ξ)).sum(axis=1)
