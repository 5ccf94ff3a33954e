"""The tangent of the slice with its two border rows and columns for h̄ and λ, in one PETSc matrix."""

from typing import Any

import numpy as np
from dolfinx import fem
from petsc4py import PETSc


class BorderedMatrix:
    """[[K_uu, K_uh, K_uλ], [K_hu, ...], [K_λu, ...]] on a fixed pattern whose values PETSc shares.

    Args:
        form: the compiled form of K_uu on a blocked vector space.
        touching: blocks of unknowns that contact couples with each other, and with h̄ and λ.

    Attributes:
        petsc: the matrix, of order 3 blocks + 2.
    """

    def __init__(self, form: fem.Form, touching: np.ndarray | None = None):
        self._form, self._blocked = form, fem.create_matrix(form)
        indptr, blocks = self._blocked.indptr, self._blocked.indices
        rows = np.repeat(np.arange(len(indptr) - 1), np.diff(indptr))
        self._order = order = 3 * (len(indptr) - 1) + 2
        dofs, border, all_dofs = np.arange(order - 2), np.array([order - 2, order - 1]), np.arange(order)
        coupled = (3 * (np.empty(0, int) if touching is None else touching)[:, None] + np.arange(3)).ravel()
        inner = 3 * np.stack([rows, blocks])[:, :, None, None] + np.indices((3, 3))[:, None]
        parts = (inner, *(np.stack(np.meshgrid(*pair, indexing="ij")) for pair in ((border, all_dofs), (dofs, border))))
        keys = [part[0].ravel() * order + part[1].ravel() for part in (*parts, np.stack(np.meshgrid(coupled, coupled)))]
        self._keys, self._places = np.unique(np.concatenate(keys), return_inverse=True)
        self._places = self._places[: -len(keys[-1]) or None]
        tables = np.searchsorted(self._keys, order * np.arange(order + 1)), self._keys % order
        self._values = np.zeros(len(self._keys))
        self.petsc = PETSc.Mat().createAIJWithArrays(
            (order, order), (*(table.astype(PETSc.IntType) for table in tables), self._values), comm=PETSc.COMM_SELF
        )
        self.petsc.setOption(PETSc.Mat.Option.KEEP_NONZERO_PATTERN, True)

    def assemble(self, columns: np.ndarray, rows: np.ndarray, corner: np.ndarray, more: tuple) -> None:
        """Write the matrix.

        Args:
            columns, rows: of h̄ and λ, shape (2, size).
            corner: shape (2, 2).
            more: rows, columns and values of entries that are added.
        """
        self._blocked.data[:] = 0.0
        assemble: Any = fem.assemble_matrix  # of its forms, types know the one that makes a matrix
        assemble(self._blocked, self._form)
        parts = (self._blocked.data, np.hstack([rows, corner]), columns.T)
        self._values[:] = np.bincount(self._places, np.concatenate([part.ravel() for part in parts]), len(self._keys))
        i, j, values = more
        np.add.at(self._values, np.searchsorted(self._keys, i * self._order + j), values)
        self.petsc.assemble()
        self.petsc.stateIncrease()
