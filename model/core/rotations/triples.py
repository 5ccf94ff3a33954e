"""Vectors of three numbers as tuples, for compiled loops: they lie in registers, and nothing is allocated."""

import numpy as np

from coilset.model.core.runtime.kernels import COMPILED, njit

Triple = tuple[float, float, float]


@njit(**COMPILED)
def triple(a: np.ndarray) -> Triple:
    """Of an array, shape (3,)."""
    return a[0], a[1], a[2]


@njit(**COMPILED)
def axis(k: int) -> Triple:
    """The unit vector along axis k."""
    return 1.0 if k == 0 else 0.0, 1.0 if k == 1 else 0.0, 1.0 if k == 2 else 0.0


@njit(**COMPILED)
def cross(a: Triple, b: Triple) -> Triple:
    """a × b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@njit(**COMPILED)
def dot(a: Triple, b: Triple) -> float:
    """a · b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(**COMPILED)
def plus(a: Triple, s: float, b: Triple) -> Triple:
    """a + s b."""
    return a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]


@njit(**COMPILED)
def scaled(s: float, a: Triple) -> Triple:
    """s a."""
    return s * a[0], s * a[1], s * a[2]


@njit(**COMPILED)
def times(M: np.ndarray, a: Triple) -> Triple:
    """M a, with M of shape (3, 3)."""
    return dot(triple(M[0]), a), dot(triple(M[1]), a), dot(triple(M[2]), a)


@njit(**COMPILED)
def back(M: np.ndarray, a: Triple) -> Triple:
    """Mᵀ a, with M of shape (3, 3)."""
    return dot(triple(M[:, 0]), a), dot(triple(M[:, 1]), a), dot(triple(M[:, 2]), a)
