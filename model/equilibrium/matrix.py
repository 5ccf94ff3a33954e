"""The tangent as a PETSc matrix whose rows have room for contacts.

A new entry in a full row would move the whole matrix, so the rows are reallocated when contacts close for which the
matrix has no entries. At the start of a solve they are allocated for exactly the contacts that are closed, so that the
rounding of a factorisation does not depend on the history.
"""

from collections.abc import Sequence

import numpy as np
from petsc4py import PETSc

from coilset.model.body import Body
from coilset.model.contact.base import Contribution
from coilset.model.equilibrium.layout import Layout, LineLayout

# Contacts add entries outside the band of a line. Up to SMALL unknowns the fill of the natural order costs less than
# finding a better one; beyond, minimum degree: with 2,560 elements in 2.5 windings a factorisation takes 17 ms, in
# band order 2.8 s; in 160 windings 25 ms and 54 ms.
SMALL = 1500
NATURAL, MINIMUM_DEGREE = "natural", "qmd"


class TangentMatrix:
    """A matrix of the system.

    Args:
        body: Body.
        layout: Layout of its unknowns.

    Attributes:
        mat: PETSc's matrix.
        version: how often its rows were allocated; older factors are invalid.
    """

    def __init__(self, body: Body, layout: Layout) -> None:
        self.layout, self._entries = layout, body.row_entries
        self.mat, self.version = body.create_matrix(layout.size_local), 0
        self._places = np.empty(0, dtype=np.int64)
        if self._entries is not None:
            self._make_room([])

    @property
    def ordering(self) -> str:
        """PETSc's name of the order in which its LU should eliminate, on one rank."""
        return MINIMUM_DEGREE if len(self._places) and self.layout.size > SMALL else NATURAL

    def clear(self, contributions: Sequence[Contribution], exactly: bool) -> None:
        """Zero the matrix, with room for the closed contacts; with `exactly`, for no others."""
        places = self._contact_places(contributions)
        fits = np.array_equal(places, self._places) or (not exactly and bool(np.isin(places, self._places).all()))
        if self.layout.comm.size > 1:
            fits = self.layout.comm.allreduce(int(fits)) == self.layout.comm.size
        if fits:
            self.mat.zeroEntries()
        else:
            self._make_room(contributions)

    def add(self, contributions: Sequence[Contribution]) -> None:
        """Add the stiffness of contacts; values stay unassembled."""
        layout = self.layout
        for part in contributions:
            assert isinstance(layout, LineLayout)
            add_blocks(self.mat, layout.contact_dofs[part.dofs], part.stiffness, layout.start, layout.stop)

    def _make_room(self, contributions: Sequence[Contribution]) -> None:
        """Reallocate the rows: a node couples with its neighbours, shear angles, and contacts."""
        layout = self.layout
        assert self._entries is not None
        entries = np.full(layout.size_local, self._entries.max(), dtype=PETSc.IntType)
        entries[: layout.owned] = self._entries
        for part in contributions:
            assert isinstance(layout, LineLayout)
            _, once = np.unique(self._contact_places([part]), return_index=True)  # several may join the same unknowns
            dofs = layout.contact_dofs[part.dofs[once]].astype(np.int64)
            element, k = np.nonzero((dofs >= layout.start) & (dofs < layout.stop))
            rows = dofs[element, k] - layout.start
            places = np.unique(rows[:, None] * layout.size + dofs[element])  # row by row, each once
            entries += np.bincount(places // layout.size, minlength=layout.size_local).astype(PETSc.IntType)
        here = np.minimum(entries, layout.size_local)  # in columns of this rank
        there = np.minimum(entries, layout.size - layout.size_local)
        self.mat.setPreallocationNNZ((here, there) if layout.comm.size > 1 else here)
        self.mat.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, False)
        self.mat.setOption(PETSc.Mat.Option.KEEP_NONZERO_PATTERN, True)  # lost in a parallel allocation
        self._places = self._contact_places(contributions)
        self.version += 1

    def _contact_places(self, contributions: Sequence[Contribution]) -> np.ndarray:
        """A number for each contact element from its first and last dof, which identify the bodies in contact."""
        if not contributions:
            return np.empty(0, dtype=np.int64)
        assert isinstance(self.layout, LineLayout)
        count = len(self.layout.contact_dofs)
        return np.concatenate([part.dofs[:, 0] * count + part.dofs[:, -1] for part in contributions])


def add_blocks(mat: PETSc.Mat, dofs: np.ndarray, blocks: np.ndarray, start: int, stop: int) -> None:
    """Add element matrices, shape (m, k, k), to the rows start ≤ row < stop of a PETSc matrix."""
    if not len(dofs):
        return
    rows = np.where((dofs >= start) & (dofs < stop), dofs, -1).astype(PETSc.IntType)  # PETSc skips negative rows
    mat.setValuesRCV(rows, np.ascontiguousarray(dofs, dtype=PETSc.IntType), blocks, addv=PETSc.InsertMode.ADD_VALUES)
