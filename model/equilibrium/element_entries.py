"""The elements' entries in a matrix of one rank: their places are found once for each pattern, not each time."""

import numpy as np
from numba import njit


def find_places(indptr: np.ndarray, indices: np.ndarray, dofs: np.ndarray) -> np.ndarray:
    """Where the entries of all elements lie.

    Args:
        indptr, indices: pattern of the matrix, which has them all.
        dofs: unknowns of the elements, shape (cells, k).

    Returns:
        Places in the rows, in 8 bits where they suffice, shape (cells, k, k).
    """
    longest = int(np.diff(indptr)[dofs].max(initial=0))
    places = np.empty((*dofs.shape, dofs.shape[1]), np.uint8 if longest <= 2**8 else np.uint32)
    _find_places(indptr, indices, dofs, places)
    return places


@njit(cache=True)
def _find_places(indptr: np.ndarray, indices: np.ndarray, dofs: np.ndarray, places: np.ndarray) -> None:
    at = np.empty(len(indptr) - 1, indptr.dtype)
    for c in range(dofs.shape[0]):
        for i in range(dofs.shape[1]):
            start = indptr[dofs[c, i]]
            for place in range(start, indptr[dofs[c, i] + 1]):
                at[indices[place]] = place - start
            for j in range(dofs.shape[1]):
                places[c, i, j] = at[dofs[c, j]]


@njit(cache=True)
def add_elements(
    indptr: np.ndarray, dofs: np.ndarray, places: np.ndarray, matrices: np.ndarray, values: np.ndarray
) -> None:
    """Add the elements' matrices, shape (cells, k, k), to the entries of the matrix, see `find_places`."""
    for c in range(places.shape[0]):
        for i in range(places.shape[1]):
            start = indptr[dofs[c, i]]
            for j in range(places.shape[2]):
                values[start + places[c, i, j]] += matrices[c, i, j]


@njit(cache=True)
def set_rows(indptr: np.ndarray, indices: np.ndarray, rows: np.ndarray, weight: float, values: np.ndarray) -> None:
    """Make rows those of `weight` times the identity."""
    for row in rows:
        for place in range(indptr[row], indptr[row + 1]):
            values[place] = weight if indices[place] == row else 0.0
