"""Compiled sums of what contacts add to the unknowns and to the tangent."""

import numpy as np

from coilset.model.core.runtime.kernels import njit


@njit(cache=True)
def add_vectors(unknowns: np.ndarray, numbers: np.ndarray, vectors: np.ndarray, start: int, out: np.ndarray) -> None:
    """Add small vectors to a range of rows.

    Args:
        unknowns: rows, by what the small vectors call them.
        numbers: what the small vectors call their unknowns, shape (m, k).
        vectors: shape (m, k).
        start: number of the first row of the range; rows beyond it are left out.
        out: the range, written.
    """
    for m in range(len(numbers)):
        for a in range(numbers.shape[1]):
            row = unknowns[numbers[m, a]] - start
            if 0 <= row < len(out):
                out[row] += vectors[m, a]


@njit(cache=True)
def add_matrices(matrices: np.ndarray, starts: np.ndarray, out: np.ndarray) -> None:
    """Add matrices, shape (m, k, k), to those of which `out` is a row, each where it begins there, shape (m,)."""
    for m in range(len(starts)):
        at = starts[m]
        for i in range(matrices.shape[1]):
            for j in range(matrices.shape[2]):
                out[at] += matrices[m, i, j]
                at += 1
