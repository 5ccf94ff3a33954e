"""The tangent as a PETSc matrix: the sum of the elements' tangents and of the contacts' stiffness.

Its entries are allocated for all elements and for some contacts, and again when others close. At the start of a solve
they are allocated for exactly the contacts that are closed, so that the rounding of a factorisation does not depend on
the history.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from petsc4py import PETSc

from coilset.model.core.body.body import Body
from coilset.model.core.contact.base import Contribution
from coilset.model.core.equilibrium.system.coo import SumOfMatrices
from coilset.model.core.equilibrium.system.factors import FILL_REDUCING, NATURAL
from coilset.model.core.equilibrium.system.layout import Layout, LineLayout
from coilset.model.core.equilibrium.system.sums import add_matrices

END = np.array([np.iinfo(np.int64).max])  # behind the numbers of contacts
MOST = 64  # more than the unknowns of any contact element


class TangentMatrix:
    """A matrix of the system.

    Args:
        body: Body.
        layout: Layout of its unknowns.

    Attributes:
        mat: PETSc's matrix.
        version: how often its entries were allocated; older factors are invalid.
        ordering: PETSc's name of the order in which its LU should eliminate, the same on all ranks.
    """

    def __init__(self, body: Body, layout: Layout) -> None:
        self.body, self.layout = body, layout
        self.mat, self.version, self.ordering = body.create_matrix(layout.size_local), 0, NATURAL
        self._sum: SumOfMatrices | None = None
        # Numbers of the contacts that it has room for, ascending, and where the stiffness of each begins; END: it ends
        self._known, self._starts = END, np.zeros(1, np.int64)

    def fill(self, contributions: Sequence[Contribution], exactly: bool = False, share: float | None = None) -> None:
        """Set it to the body's tangent and the stiffness of contacts; collective.

        Args:
            contributions: of the contacts; the matrix gets room for those that are closed.
            exactly: whether it is to have room for no others.
            share: as in `Body.element_tangents`.
        """
        if self.body.element_dofs is None:
            self.mat.zeroEntries()
            self.body.tangent(self.mat)
            self.mat.assemble()
            return
        closed = {kind: part for kind, part in enumerate(contributions) if len(part.dofs)}
        starts, begin = self._room_for(closed, exactly), 0
        assert self._sum is not None
        for cells, tangents in self.body.element_tangents(share):
            self._sum.parts[0][cells] = tangents
        stiffness = self._sum.values[len(self._sum.values) - self._starts[-1] :]
        stiffness[:] = 0.0
        for part in closed.values():
            add_matrices(part.stiffness, starts[begin : begin + len(part.dofs)], stiffness)
            begin += len(part.dofs)
        self._sum.assemble()

    def hold(self, held: np.ndarray) -> None:
        """Set the rows of prescribed increments, given by their places on this rank; collective.

        See Body.
        """
        rows = (held + self.layout.start).astype(PETSc.IntType)
        if self.body.element_dofs is None:
            self.body.hold(self.mat, rows)
        else:
            self.mat.zeroRows(rows, diag=self.body.constraint_weight)

    def _room_for(self, closed: Mapping[int, Contribution], exactly: bool) -> np.ndarray:
        """Where the stiffness of each contact element begins; collective.

        The entries are allocated anew unless there is room for all of them; with `exactly`, for no others.
        """
        numbers = np.concatenate([END[:0], *(self._numbers(kind, part.dofs) for kind, part in closed.items())])
        found = self._known.searchsorted(numbers)
        fits = self._sum is not None and bool((self._known[found] == numbers).all())
        if exactly:
            fits = fits and len(np.unique(found)) == len(self._known) - 1
        if self.layout.comm.size > 1:
            fits = self.layout.comm.allreduce(int(fits)) == self.layout.comm.size
        if not fits:
            self._allocate(closed)
            found = self._known.searchsorted(numbers)
        return self._starts[found]

    def _numbers(self, kind: int, dofs: np.ndarray) -> np.ndarray:
        """Of contact elements, shape (m, k) → (m,): in a kind of contact, first and last dof identify the bodies."""
        size = self.layout.size
        return ((kind * MOST + dofs.shape[1]) * size + dofs[:, 0]) * size + dofs[:, -1]

    def _allocate(self, closed: Mapping[int, Contribution]) -> None:
        """Allocate the entries of the elements, of the extra unknowns' diagonal and of contacts; collective."""
        layout, local = self.layout, self.body.element_dofs
        assert local is not None
        elements = layout.index_map.local_to_global(local.ravel()).reshape(local.shape)
        extra = np.arange(layout.start + layout.owned, layout.stop)[:, None]
        tables = [(elements, elements), (extra, extra)]
        known, starts = [END[:0]], [np.zeros(1, np.int64)]
        for kind, part in closed.items():
            assert isinstance(layout, LineLayout)
            numbers, once = np.unique(self._numbers(kind, part.dofs), return_index=True)  # several may join the same
            unknowns = layout.contact_dofs[part.dofs[once]]
            here = (unknowns >= layout.start) & (unknowns < layout.stop)
            tables.append((np.where(here, unknowns, -1), unknowns))  # other ranks add their rows of it themselves
            known.append(numbers)
            starts.append(starts[-1][-1] + unknowns.shape[1] ** 2 * np.arange(1, len(numbers) + 1))
        self._known, self._starts = np.concatenate([*known, END]), np.concatenate(starts)
        self._sum = None  # so that its memory is free
        self._sum = SumOfMatrices(self.mat, tables)
        # Contacts add entries outside the band. Pattern and factors take 0.8, 8.1, 3.1 ms in band order and 0.4, 6.6,
        # 1.9 ms in the other one for the example, the closed and ground spring, the hourglass, each with friction; with
        # 2,560 elements in 2.5 windings factors take 2.8 s or 11 ms.
        self.ordering = FILL_REDUCING if layout.comm.allreduce(len(closed)) > 0 else NATURAL
        self.version += 1
