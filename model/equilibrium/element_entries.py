"""The elements' entries in a matrix of one rank: their places are found once for each pattern, not each time."""

import numpy as np
from numba import njit


@njit(cache=True)
def find_places(indptr: np.ndarray, indices: np.ndarray, dofs: np.ndarray) -> np.ndarray:
    """Where the entries of all elements lie.

    Args:
        indptr, indices: pattern of the matrix, which has them all.
        dofs: unknowns of the elements, shape (cells, k).

    Returns:
        Shape (cells, k, k).
    """
    at, places = np.empty(len(indptr) - 1, indptr.dtype), np.empty((*dofs.shape, dofs.shape[1]), indptr.dtype)
    for c in range(dofs.shape[0]):
        for i in range(dofs.shape[1]):
            for place in range(indptr[dofs[c, i]], indptr[dofs[c, i] + 1]):
                at[indices[place]] = place
            for j in range(dofs.shape[1]):
                places[c, i, j] = at[dofs[c, j]]
    return places


@njit(cache=True)
def add_elements(places: np.ndarray, matrices: np.ndarray, values: np.ndarray) -> None:
    """Add the elements' matrices, shape (cells, k, k), to the entries of the matrix."""
    for c in range(places.shape[0]):
        for i in range(places.shape[1]):
            for j in range(places.shape[2]):
                values[places[c, i, j]] += matrices[c, i, j]


@njit(cache=True)
def set_rows(indptr: np.ndarray, indices: np.ndarray, rows: np.ndarray, weight: float, values: np.ndarray) -> None:
    """Make rows those of `weight` times the identity."""
    for row in rows:
        for place in range(indptr[row], indptr[row + 1]):
            values[place] = weight if indices[place] == row else 0.0
