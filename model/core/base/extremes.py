"""Extremes of a few numbers, in compiled loops, as NumPy's have a larger overhead."""

import math

import numpy as np

from coilset.model.core.runtime.kernels import njit


@njit(cache=True)
def greatest(values: np.ndarray) -> float:
    """The maximum of some values, 0 if all are negative or there are none."""
    found = 0.0
    for value in values.flat:
        found = max(found, value)
    return found


@njit(cache=True)
def largest(values: np.ndarray) -> float:
    """The largest magnitude of some values; NaN if one of them is NaN."""
    found = 0.0
    for value in values:
        if not abs(value) <= found:
            found = abs(value)
    return found


@njit(cache=True)
def relative_motion(x: np.ndarray, y: np.ndarray) -> float:
    """Diagonal of the box around the motions of points from x to y, shape (n, 3), with n > 0."""
    square = 0.0
    for k in range(3):
        low, high = math.inf, -math.inf
        for i in range(len(x)):
            motion = y[i, k] - x[i, k]
            low, high = min(low, motion), max(high, motion)
        square += (high - low) ** 2
    return math.sqrt(square)
