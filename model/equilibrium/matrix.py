"""The tangent as a PETSc matrix whose rows have room for contacts.

A new entry in a full row would move the whole matrix, so the rows are reallocated when contacts close for which the
matrix has no entries. At the start of a solve they are allocated for exactly the contacts that are closed, so that the
rounding of a factorisation does not depend on the history.
"""

from collections.abc import Sequence

import numpy as np
from petsc4py import PETSc

from coilset.model.body import Body, OfElements
from coilset.model.contact.base import Contribution
from coilset.model.equilibrium.aij import AijEntries
from coilset.model.equilibrium.element_entries import add_elements, find_places, set_rows
from coilset.model.equilibrium.joined import add_matrices, join_patterns, number_pairs
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
        self.body, self.layout = body, layout
        self.mat, self.version = body.create_matrix(layout.size_local), 0
        self._places, self._known = list[int](), set[int]()
        self._bare: tuple[np.ndarray, np.ndarray] | None = None  # the pattern without contacts, once it is needed
        self._entries: AijEntries | None = None
        # if they are added in place
        self._elements = body if isinstance(body, OfElements) and layout.comm.size == 1 else None
        self._places_of_elements: np.ndarray | None = None
        if body.row_entries is not None and self._elements is None:
            self._allocate(body.row_entries)

    @property
    def ordering(self) -> str:
        """PETSc's name of the order in which its LU should eliminate, on one rank."""
        return MINIMUM_DEGREE if len(self._places) and self.layout.size > SMALL else NATURAL

    def fill(self, contributions: Sequence[Contribution], exactly: bool = False) -> None:
        """Set it to the body's tangent and the stiffness of contacts; collective.

        Args:
            contributions: of the contacts; the matrix gets room for those that are closed.
            exactly: whether it is to have room for no others.
        """
        self._clear(contributions, exactly)
        entries, elements = self._entries, self._elements
        if elements is None:
            self.body.tangent(self.mat)
            self._add_seats()
            self.mat.assemble()
        if entries is None:
            return
        room = entries.room()
        if elements is not None:
            if self._places_of_elements is None:
                self._places_of_elements = find_places(*entries.pattern, elements.element_dofs)
            indptr, dofs, places = entries.pattern[0], elements.element_dofs, self._places_of_elements
            for cells, tangents in elements.element_tangents():
                add_elements(indptr, dofs[cells], places[cells], tangents, room)
        self._add_contacts(contributions, entries.pattern, room)
        entries.add(room)

    def hold(self, held: np.ndarray) -> None:
        """Set the rows of prescribed increments, given by their places on this rank, see Body; collective."""
        if self._entries is None or self._elements is None:
            self.body.hold(self.mat, held + self.layout.start)
        else:
            set_rows(*self._entries.pattern, held, self.body.constraint_weight, self._entries.room())

    def _clear(self, contributions: Sequence[Contribution], exactly: bool) -> None:
        """Zero it, with room for the closed contacts; with `exactly`, for no others."""
        places = self._contact_places(contributions).tolist()
        fits = places == self._places or (not exactly and self._known.issuperset(places))
        fits = fits and (self._entries is not None or self._elements is None)
        if self.layout.comm.size > 1:
            fits = self.layout.comm.allreduce(int(fits)) == self.layout.comm.size
        if fits:
            self.mat.zeroEntries()
        else:
            self._make_room(contributions)
            self._places, self._known = places, set(places)

    def _add_contacts(
        self, contributions: Sequence[Contribution], pattern: tuple[np.ndarray, np.ndarray], room: np.ndarray
    ) -> None:
        """Add the stiffness of contacts to the entries of a pattern."""
        layout = self.layout
        for part in contributions:
            if len(part.dofs):
                assert isinstance(layout, LineLayout)
                add_matrices(pattern, layout.contact_dofs, part.dofs, part.stiffness, layout.start, room)

    def _allocate(self, row_entries: np.ndarray) -> None:
        """Room for the body alone, in a new matrix."""
        layout = self.layout
        entries = np.full(layout.size_local, row_entries.max(), dtype=PETSc.IntType)
        entries[: layout.owned] = row_entries
        here = np.minimum(entries, layout.size_local)  # in columns of this rank
        there = np.minimum(entries, layout.size - layout.size_local)
        self.mat.setPreallocationNNZ((here, there) if layout.comm.size > 1 else here)
        self.mat.setOption(PETSc.Mat.Option.KEEP_NONZERO_PATTERN, True)  # lost in a parallel allocation
        self.mat.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, False)  # where frames branch, nodes have more

    def _make_room(self, contributions: Sequence[Contribution]) -> None:
        """Allocate the rows anew: those of the body, and what the contacts join."""
        layout, tables = self.layout, []
        if self._bare is None:
            self._bare = self._bare_pattern()
        for part in contributions:
            assert isinstance(layout, LineLayout)
            once = np.unique(self._contact_places([part]), return_index=True)[1]  # several may join the same unknowns
            tables.append(layout.contact_dofs[part.dofs[once]])
        pattern = join_patterns(self._bare, tables, layout.start, layout.size)
        self.mat.setPreallocationCSR(pattern)
        self.mat.setOption(PETSc.Mat.Option.KEEP_NONZERO_PATTERN, True)
        self._entries, self._places_of_elements = AijEntries(self.mat, pattern), None
        self.version += 1

    def _bare_pattern(self) -> tuple[np.ndarray, np.ndarray]:
        """Indptr and indices of the body alone, and of the seats' diagonal."""
        layout = self.layout
        if self._elements is not None:
            none = np.zeros(layout.size_local + 1, PETSc.IntType), np.empty(0, PETSc.IntType)
            seats = np.arange(layout.owned, layout.size_local, dtype=PETSc.IntType)[:, None]
            return join_patterns(none, [self._elements.element_dofs, seats], 0, layout.size)
        self.body.tangent(self.mat)
        self._add_seats()
        self.mat.assemble()
        return self.mat.getValuesCSR()[:2]

    def _add_seats(self) -> None:
        """Zeros on the diagonal of the seats' rows, which must exist for a fixed or untouched seat."""
        if isinstance(self.layout, LineLayout) and self.layout.has_extra:
            seats = self.layout.seat_dofs[:, None]
            self.mat.setValuesRCV(seats, seats, np.zeros((len(seats), 1, 1)), addv=PETSc.InsertMode.ADD_VALUES)

    def _contact_places(self, contributions: Sequence[Contribution]) -> np.ndarray:
        """A number for each contact element from its first and last dof, which identify the bodies in contact."""
        places, begin = np.empty(sum(len(part.dofs) for part in contributions), dtype=np.int64), 0
        for part in contributions:
            if len(part.dofs):
                assert isinstance(self.layout, LineLayout)
                number_pairs(part.dofs, len(self.layout.contact_dofs), places[begin : begin + len(part.dofs)])
                begin += len(part.dofs)
        return places
