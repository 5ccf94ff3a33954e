"""Extremes of a few numbers, in compiled loops: NumPy's take longer to begin than to end."""

import math

import numpy as np
from numba import njit


@njit(cache=True)
def greatest(values: np.ndarray) -> float:
    """The greatest of some values, 0 if all are below or there are none."""
    found = 0.0
    for value in values.flat:
        found = max(found, value)
    return found


@njit(cache=True)
def least(values: np.ndarray) -> float:
    """The least of some values, infinite if there are none."""
    found = math.inf
    for value in values:
        found = min(found, value)
    return found


@njit(cache=True)
def largest(values: np.ndarray) -> float:
    """The largest magnitude of some values; not a number if one of them is none."""
    found = 0.0
    for value in values:
        if not abs(value) <= found:
            found = abs(value)
    return found


@njit(cache=True)
def farthest(x: np.ndarray, y: np.ndarray) -> float:
    """The largest difference of two arrays of shape (n, 3)."""
    found = 0.0
    for i in range(len(x)):
        for k in range(3):
            found = max(found, abs(x[i, k] - y[i, k]))
    return found
