"""The tangent as a PETSc matrix whose rows have room for contacts.

A new entry in a full row would move the whole matrix, so the rows are reallocated when contacts close for which the
matrix has no entries. At the start of a solve they are allocated for exactly the contacts that are closed, so that the
rounding of a factorisation does not depend on the history.
"""

from collections.abc import Sequence

import numpy as np
from petsc4py import PETSc

from coilset.model.body.body import Body
from coilset.model.contact.base import Contribution
from coilset.model.equilibrium.system.aij import AijEntries
from coilset.model.equilibrium.system.element_entries import ElementEntries, set_rows
from coilset.model.equilibrium.system.factors import FILL_REDUCING, NATURAL
from coilset.model.equilibrium.system.joined import add_matrices, join_patterns, number_pairs
from coilset.model.equilibrium.system.layout import Layout, LineLayout


class TangentMatrix:
    """A matrix of the system.

    Args:
        body: Body.
        layout: Layout of its unknowns.

    Attributes:
        mat: PETSc's matrix.
        version: how often its rows were allocated; older factors are invalid.
        ordering: PETSc's name of the order in which its LU should eliminate, the same on all ranks.
    """

    def __init__(self, body: Body, layout: Layout) -> None:
        self.body, self.layout = body, layout
        self.mat, self.version, self.ordering = body.create_matrix(layout.size_local), 0, NATURAL
        self._places, self._known = list[int](), set[int]()
        self._bare: tuple[np.ndarray, np.ndarray] | None = None  # the pattern without contacts, while there are some
        self._entries: AijEntries | None = None
        self._unknowns, self._stop = np.empty(0, PETSc.IntType), 0  # of contacts, in the entries' numbers, all below
        self._elements = None if body.element_dofs is None else ElementEntries(body, layout)

    def fill(self, contributions: Sequence[Contribution], exactly: bool = False, share: float | None = None) -> None:
        """Set it to the body's tangent and the stiffness of contacts; collective.

        Args:
            contributions: of the contacts; the matrix gets room for those that are closed.
            exactly: whether it is to have room for no others.
            share: as in `Body.element_tangents`.
        """
        self._clear(contributions, exactly)
        if self._elements is not None:
            assert self._entries is not None
            own, _ = self._entries.arrays()
            self._elements.add(self.mat, own, share)
            self._add_contacts(contributions)
            return
        self.body.tangent(self.mat)
        self.mat.assemble()

    def hold(self, held: np.ndarray) -> None:
        """Set the rows of prescribed increments, given by their places on this rank; collective.

        See Body.
        """
        if self._entries is None:
            self.body.hold(self.mat, held + self.layout.start)
            return
        own, others = self._entries.arrays()
        set_rows(*self._entries.own, held, self.body.constraint_weight, own)
        if len(others):
            set_rows(*self._entries.others, held, 0.0, others)

    def _clear(self, contributions: Sequence[Contribution], exactly: bool) -> None:
        """Zero it, with room for the closed contacts; with `exactly`, for no others."""
        places = self._contact_places(contributions).tolist()
        fits = places == self._places or (not exactly and self._known.issuperset(places))
        fits = self._elements is None or (fits and self._entries is not None)
        if self.layout.comm.size > 1:
            fits = self.layout.comm.allreduce(int(fits)) == self.layout.comm.size
        if fits:
            self.mat.zeroEntries()
        else:
            self._make_room(contributions)
            self._places, self._known = places, set(places)

    def _add_contacts(self, contributions: Sequence[Contribution]) -> None:
        """Add the stiffness of contacts."""
        entries, acting = self._entries, [part for part in contributions if len(part.dofs)]
        if not acting:
            return
        assert entries is not None
        values = entries.arrays()
        for part in acting:
            add_matrices(entries.own, entries.others, self._unknowns, part.dofs, part.stiffness, self._stop, values)

    def _make_room(self, contributions: Sequence[Contribution]) -> None:
        """Allocate the rows anew: those of the body, and what the contacts join."""
        layout, elements, tables = self.layout, self._elements, []
        assert elements is not None
        for part in contributions:
            if len(part.dofs):
                assert isinstance(layout, LineLayout)
                once = np.unique(self._contact_places([part]), return_index=True)[1]  # several may join the same
                tables.append(layout.contact_dofs[part.dofs[once]])
        pattern = bare = self._bare_pattern(elements) if self._bare is None else self._bare
        if tables:
            pattern = join_patterns(bare, tables, layout.start, layout.size)
        self._bare = bare if tables else None  # which fills as much memory as a third of the matrix
        self.mat.setPreallocationCSR(pattern)
        self.mat.setOption(PETSc.Mat.Option.KEEP_NONZERO_PATTERN, True)
        self._entries = AijEntries(self.mat)
        if tables:
            assert isinstance(layout, LineLayout)
            self._unknowns = self._entries.local(layout.contact_dofs).astype(PETSc.IntType)  # as on one rank
            self._stop = int(self._unknowns.max()) + 1
        elements.find(self._entries)
        # Contacts add entries outside the band. Pattern and factors take 0.8, 8.1, 3.1 ms in band order and 0.4, 6.6,
        # 1.9 ms in the other one for the example, the closed and ground spring, the hourglass, each with friction; with
        # 2,560 elements in 2.5 windings factors take 2.8 s or 11 ms.
        touching = layout.comm.allreduce(len(tables)) > 0
        self.ordering = FILL_REDUCING if touching else NATURAL
        self.version += 1

    def _bare_pattern(self, elements: ElementEntries) -> tuple[np.ndarray, np.ndarray]:
        """Indptr and indices of the body alone, and of the seats' diagonal."""
        layout = self.layout
        none = np.zeros(layout.size_local + 1, PETSc.IntType), np.empty(0, PETSc.IntType)
        seats = np.arange(layout.start + layout.owned, layout.stop, dtype=PETSc.IntType)[:, None]
        return join_patterns(none, [*elements.tables, seats], layout.start, layout.size)

    def _contact_places(self, contributions: Sequence[Contribution]) -> np.ndarray:
        """A number for each contact element from its first and last dof, which identify the bodies in contact."""
        places, begin = np.empty(sum(len(part.dofs) for part in contributions), dtype=np.int64), 0
        for part in contributions:
            if len(part.dofs):
                assert isinstance(self.layout, LineLayout)
                number_pairs(part.dofs, len(self.layout.contact_dofs), places[begin : begin + len(part.dofs)])
                begin += len(part.dofs)
        return places
