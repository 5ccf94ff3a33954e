"""Creep by a power of the stress's hyperbolic sine (Garofalo)."""

import math

import numpy as np

TEXT = "a power of its hyperbolic sine"
HOMOGENEOUS = False


def factor(x: float) -> tuple[float, float]:
    """f = sinh x, and its logarithmic slope."""
    return math.sinh(x), x / math.tanh(x)


def logarithm(x: np.ndarray) -> np.ndarray:
    """log f, also where f is beyond all numbers."""
    return x + np.log(-np.expm1(-2.0 * x)) - np.log(2.0)
