"""The elements' entries in a matrix: their places are found once for each pattern, not each time."""

import numpy as np
from petsc4py import PETSc

from coilset.model.body.body import Body
from coilset.model.equilibrium.system.aij import AijEntries
from coilset.model.equilibrium.system.layout import Layout
from coilset.model.runtime.kernels import njit


class ElementEntries:
    """Adds the tangents of a body's elements to a matrix, each where it lies; those of elements at a cut of the body,
    which have rows of other ranks, through PETSc.

    Args:
        body: of elements.
        layout: Layout of its unknowns.

    Attributes:
        tables: global numbers of the unknowns of the elements that have rows on this rank, and perhaps of others at
            cuts, for `join_patterns`.
    """

    def __init__(self, body: Body, layout: Layout) -> None:
        assert body.element_dofs is not None
        self._body, self._comm, self._places, self._dofs = body, layout.comm, np.empty(0), body.element_dofs
        self._at_cut, self.tables = np.zeros(len(self._dofs), dtype=bool), [self._dofs]
        if self._comm.size > 1:
            self._at_cut = (self._dofs >= layout.owned).any(axis=1)
            numbers = layout.index_map.local_to_global(self._dofs.ravel()).astype(PETSc.IntType)
            self._numbers = numbers.reshape(self._dofs.shape)
            self.tables = [self._numbers, *self._comm.allgather(self._numbers[self._at_cut])]

    def find(self, entries: AijEntries) -> None:
        """Find the places in a matrix that has room for them."""
        self._indptr, self._places = entries.own[0], find_places(*entries.own, self._dofs, self._at_cut)

    def add(self, mat: PETSc.Mat, values: np.ndarray, share: float | None) -> None:
        """Add all tangents to the matrix whose places were found; collective.

        Args:
            mat: the matrix.
            values: its entries in this rank's own columns, the first of `AijEntries.arrays`.
            share: as in `Body.element_tangents`.
        """
        dofs, places, at_cut = self._dofs, self._places, self._at_cut
        for cells, tangents in self._body.element_tangents(share):
            add_elements(self._indptr, dofs[cells], places[cells], tangents, at_cut[cells], values)
            if self._comm.size > 1 and at_cut[cells].any():
                numbers = self._numbers[cells][at_cut[cells]]
                mat.setValuesRCV(numbers, numbers, tangents[at_cut[cells]], addv=PETSc.InsertMode.ADD_VALUES)
        if self._comm.size > 1:
            mat.assemble()


def find_places(indptr: np.ndarray, indices: np.ndarray, dofs: np.ndarray, left_out: np.ndarray) -> np.ndarray:
    """Where the entries of all elements lie.

    Args:
        indptr, indices: pattern of the matrix, which has them all.
        dofs: unknowns of the elements, shape (cells, k).
        left_out: elements that are not requested, shape (cells,), bool.

    Returns:
        Places in the rows, in 8 bits where they suffice, shape (cells, k, k).
    """
    longest = int(np.diff(indptr).max(initial=0))
    places = np.empty((*dofs.shape, dofs.shape[1]), np.uint8 if longest <= 2**8 else np.uint32)
    _find_places(indptr, indices, dofs, left_out, places)
    return places


@njit(cache=True)
def _find_places(
    indptr: np.ndarray, indices: np.ndarray, dofs: np.ndarray, left_out: np.ndarray, places: np.ndarray
) -> None:
    at = np.empty(len(indptr) - 1, indptr.dtype)
    for c in range(dofs.shape[0]):
        if left_out[c]:
            continue
        for i in range(dofs.shape[1]):
            start = indptr[dofs[c, i]]
            for place in range(start, indptr[dofs[c, i] + 1]):
                at[indices[place]] = place - start
            for j in range(dofs.shape[1]):
                places[c, i, j] = at[dofs[c, j]]


@njit(cache=True)
def add_elements(
    indptr: np.ndarray,
    dofs: np.ndarray,
    places: np.ndarray,
    matrices: np.ndarray,
    left_out: np.ndarray,
    values: np.ndarray,
) -> None:
    """Add the elements' matrices, shape (cells, k, k), to the entries of the matrix, see `find_places`."""
    for c in range(places.shape[0]):
        if left_out[c]:
            continue
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
