"""Strains from the chord to the true section, and resultants and tangent back."""

import numpy as np

from coilset.model.core.runtime.kernels import KERNEL, njit


@njit(**KERNEL)
def to_section(P: np.ndarray, de: np.ndarray, d: np.ndarray) -> None:
    """Write into `d` the section's strains P de."""
    for i in range(6):
        value = 0.0
        for j in range(6):
            value += P[i, j] * de[j]
        d[i] = value


@njit(**KERNEL)
def to_chord(
    P: np.ndarray,
    stretch: float,
    resultant: np.ndarray,
    tangent: np.ndarray,
    work: np.ndarray,
    s: np.ndarray,
    D: np.ndarray,
    with_tangent: bool = True,
) -> None:
    """s = Pᵀ s_true ds/dx and, if `with_tangent`, D = Pᵀ D_true P ds/dx; `work` is 6 × 6."""
    for i in range(6):
        value = 0.0
        for k in range(6):
            value += P[k, i] * resultant[k]
        s[i] = value * stretch
    if not with_tangent:
        return
    for i in range(6):
        for j in range(6):
            value = 0.0
            for k in range(6):
                value += tangent[i, k] * P[k, j]
            work[i, j] = value * stretch
    for i in range(6):
        for j in range(6):
            value = 0.0
            for k in range(6):
                value += P[k, i] * work[k, j]
            D[i, j] = value
