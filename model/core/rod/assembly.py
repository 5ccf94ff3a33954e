"""From the elements to the rod: elements that are taken together, and compiled sums over them."""

import numpy as np

from coilset.model.core.runtime.kernels import njit


def blocks(cells: slice, size: int) -> list[slice]:
    """A range of cells in blocks of so many; the last has what is left."""
    return [slice(first, min(first + size, cells.stop)) for first in range(cells.start, cells.stop, size)]


@njit(cache=True)
def add_element_vectors(vectors: np.ndarray, dofs: np.ndarray, out: np.ndarray) -> None:
    """Add the elements' vectors, shape (cells, unknowns), to `out` at their `dofs`, of the same shape."""
    for c in range(len(dofs)):
        for i in range(dofs.shape[1]):
            out[dofs[c, i]] += vectors[c, i]
