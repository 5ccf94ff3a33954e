"""The tangent of the slice with its two border rows and columns for h̄ and λ, in one PETSc matrix."""

from typing import Any

import numpy as np
import scipy.sparse
from dolfinx import fem
from petsc4py import PETSc


class BorderedMatrix:
    """[[K_uu, K_uh, K_uλ], [K_hu, ...], [K_λu, ...]] on a fixed pattern whose values PETSc shares.

    Args:
        form: the compiled form of K_uu on a blocked vector space.
        gauge: fixed degrees of freedom, whose rows and columns become those of the identity.
        coupled: blocks of degrees of freedom that are additionally coupled by contact.

    Attributes:
        petsc: the matrix, of order 3 blocks + 2.
    """

    def __init__(self, form: fem.Form, gauge: np.ndarray, coupled: np.ndarray | None = None):
        self._form, self._blocked = form, fem.create_matrix(form)
        indptr, indices = self._blocked.indptr, self._blocked.indices
        blocks = len(indptr) - 1
        self.size = n = 3 * blocks
        row = np.repeat(np.arange(blocks), np.diff(indptr))
        i = (3 * row[:, None, None] + np.arange(3)[None, :, None] + np.zeros((1, 1, 3), int)).ravel()
        j = (3 * indices[:, None, None] + np.arange(3)[None, None, :] + np.zeros((1, 3, 1), int)).ravel()
        border = np.arange(n + 2)
        rows = [i, np.repeat(border, 2), np.repeat([n, n + 1], n + 2)]
        columns = [j, np.tile([n, n + 1], n + 2), np.tile(border, 2)]
        if coupled is not None:
            dofs = (3 * np.asarray(coupled)[:, None] + np.arange(3)).ravel()
            rows.append(np.repeat(dofs, len(dofs)))
            columns.append(np.tile(dofs, len(dofs)))
        places = np.concatenate(rows), np.concatenate(columns)
        pattern = scipy.sparse.coo_matrix((np.ones(len(places[0])), places), shape=(n + 2, n + 2)).tocsr()
        pattern.sort_indices()
        self._indptr, self._indices = pattern.indptr.astype(np.int32), pattern.indices.astype(np.int32)
        self.values = np.zeros(len(self._indices))
        self._inner = self.places(i, j)
        self._columns = [self.places(border[:n], np.full(n, n + k)) for k in range(2)]
        self._rows = [self.places(np.full(n, n + k), border[:n]) for k in range(2)]
        self._corner = self.places(np.array([n, n, n + 1, n + 1]), np.array([n, n + 1, n, n + 1]))
        entry_row = np.repeat(border, np.diff(self._indptr))
        self._gauge = np.flatnonzero(np.isin(entry_row, gauge) | np.isin(self._indices, gauge))
        self._gauge_diagonal = self.places(gauge, gauge)
        self.petsc = PETSc.Mat().createAIJWithArrays(
            (n + 2, n + 2), (self._indptr, self._indices, self.values), comm=PETSc.COMM_SELF
        )

    def places(self, i: np.ndarray, j: np.ndarray) -> np.ndarray:
        """Positions of the entries (i, j) in `values`; they must be in the pattern."""
        order = len(self._indptr) - 1
        keys = np.repeat(np.arange(order), np.diff(self._indptr)) * order + self._indices
        return np.searchsorted(keys, i * order + j)

    def assemble(self, columns: list, rows: list, corner: np.ndarray, more: tuple | None = None) -> None:
        """Write the matrix.

        Args:
            columns, rows: of h̄ and λ, arrays of shape (size,), None for zeros.
            corner: shape (2, 2).
            more: positions and values that are added before the gauge is fixed.
        """
        self._blocked.data[:] = 0.0
        assemble: Any = fem.assemble_matrix  # of its forms, types know the one that makes a matrix
        assemble(self._blocked, self._form)
        self.values[:] = 0.0
        self.values[self._inner] = self._blocked.data
        for places, values in zip(self._columns + self._rows, columns + rows, strict=True):
            if values is not None:
                self.values[places] = values
        self.values[self._corner] = corner.ravel()
        if more is not None:
            np.add.at(self.values, *more)
        self.values[self._gauge] = 0.0
        self.values[self._gauge_diagonal] = 1.0
        self.petsc.assemble()
        PETSc.Object.stateIncrease(self.petsc)
