"""From the elements to the rod: compiled sums over the elements."""

import numpy as np
from numba import njit


@njit(cache=True)
def add_element_vectors(vectors: np.ndarray, dofs: np.ndarray, out: np.ndarray) -> None:
    """Add the elements' vectors, shape (cells, unknowns), to `out` at their `dofs`, of the same shape."""
    for c in range(len(dofs)):
        for i in range(dofs.shape[1]):
            out[dofs[c, i]] += vectors[c, i]
