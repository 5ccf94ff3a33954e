"""Creep by a power of the stress (Norton, Bailey)."""

import numpy as np

TEXT = "a power of the stress"
HOMOGENEOUS = True


def factor(x: float) -> tuple[float, float]:
    """f = x, and its logarithmic slope."""
    return x, 1.0


def logarithm(x: np.ndarray) -> np.ndarray:
    """log f."""
    return np.log(x)
