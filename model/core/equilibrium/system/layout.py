"""Positions of the unknowns in PETSc's vectors, and the natural order, which is independent of the partition."""

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from dolfinx import fem
from mpi4py import MPI
from petsc4py import PETSc

from coilset.model.core.body.state import Field, Where
from coilset.model.core.contact.base import SEAT_DOFS
from coilset.model.core.rotations.vectors import carried, rotated

if TYPE_CHECKING:
    from coilset.model.core.rod.rod import Rod

SEATS = 2 * SEAT_DOFS  # unknowns of bottom and top seat


class Layout:
    """Vectors of a body's unknowns, followed by `extra` ones on the last rank.

    The body's unknowns keep DOLFINx's numbering, so that DOLFINx can assemble into the enlarged vectors directly.

    Args:
        space: the body's function space.
        extra: number of further unknowns.
        comm: of PETSc's objects; None: that of the space's mesh. On several ranks PETSc keeps what Python drops by
            communicator until it is told to free it: one that outlives the body lets the next one free all of this.

    Attributes:
        owned: number of the body's unknowns on this rank; they come first.
        size_local, size: of a vector, on this rank and in all.
        start, stop: range of this rank's unknowns.
        has_extra: whether this rank owns the extra unknowns.
    """

    def __init__(self, space: fem.FunctionSpace, extra: int = 0, comm: MPI.Comm | None = None) -> None:
        dofmap = space.dofmap
        self.comm, self.block_size = comm or space.mesh.comm, dofmap.index_map_bs
        self.index_map = dofmap.index_map
        self.owned = dofmap.index_map.size_local * self.block_size
        self.body_size = dofmap.index_map.size_global * self.block_size
        self._vector_block = 1 if extra % self.block_size else self.block_size
        self.has_extra = self.comm.rank == self.comm.size - 1
        self.size_local, self.size = self.owned + (extra if self.has_extra else 0), self.body_size + extra
        self.start = self.index_map.local_range[0] * self.block_size
        self.stop = self.start + self.size_local

    @cached_property
    def weights(self) -> np.ndarray:
        """M of this rank's unknowns: how much each counts in the norm of a mode, shape (size_local,)."""
        return np.ones(self.size_local)

    @cached_property
    def arms(self) -> np.ndarray:
        """By what each of this rank's forces is divided to compare them all, shape (size_local,), 1 or mm."""
        return np.ones(self.size_local)

    @cached_property
    def directions(self) -> np.ndarray:
        """0, 1, 2 of this rank's forces along x, y, z, whose sum is that on the body; else 3; shape (size_local,)."""
        return np.full(self.size_local, 3)

    def vector(self, values: np.ndarray | None = None) -> PETSc.Vec:
        """A PETSc vector of the unknowns: new and zero, or around this rank's `values`, shape (size_local,)."""
        if values is None:
            return PETSc.Vec().createMPI((self.size_local, None), bsize=self._vector_block, comm=self.comm)
        return PETSc.Vec().createWithArray(values, (self.size_local, None), bsize=self._vector_block, comm=self.comm)

    def extra(self, values: np.ndarray) -> np.ndarray:
        """The extra unknowns of this rank's part `values` of a vector, the same on every rank."""
        mine = values[self.owned :]  # empty except on the last rank, which owns them
        return mine if self.comm.size == 1 else self.comm.bcast(mine, root=self.comm.size - 1)

    def values(self, vector: PETSc.Vec, dofs: np.ndarray) -> np.ndarray:
        """Entries of a vector at `dofs`, in their shape, on every rank."""
        dofs = np.asarray(dofs)
        if self.comm.size == 1:
            return vector.getArray(readonly=True)[dofs]
        mine, out = (dofs >= self.start) & (dofs < self.stop), np.zeros(dofs.shape)
        out[mine] = vector.getArray(readonly=True)[dofs[mine] - self.start]
        return self.comm.allreduce(out)


class LineLayout(Layout):
    """Unknowns of a rod, then x, y, z and rotations of the bottom and of the top seat.

    Attributes:
        station_dofs: of the stations' displacements and rotations, shape (stations, 6).
        element_dofs: of the elements' own unknowns, shape (elements, own).
        seat_dofs: of the seats, shape (12,).
        rod: the Rod whose unknowns they are.
        own_stations: numbers of this rank's stations, in the order of the local nodes.
        contact_dofs: unknown of each degree of freedom as contacts number them, see coilset.model.core.contact.base.
    """

    def __init__(self, rod: "Rod") -> None:
        super().__init__(rod.V, SEATS, rod.comm)
        self.rod = rod
        comm, line, index_map = self.comm, rod.line, self.index_map
        self.line = line
        self._nodes = line.mesh.geometry.index_map().size_local
        mine = np.concatenate([rod.numbering.u[: self._nodes], rod.numbering.rotations[: self._nodes]], axis=1)
        mine = index_map.local_to_global(mine.ravel().astype(np.int32)).reshape(-1, 6)
        self.own_stations = line.node[: self._nodes]
        parts = comm.allgather(self.own_stations)
        self._order = np.concatenate(parts)
        self._place, self._before = np.argsort(self._order), sum(map(len, parts[: comm.rank]))
        self.station_dofs = np.empty((len(line.stations), 6), dtype=PETSc.IntType)
        self.station_dofs[self._order] = np.concatenate(comm.allgather(mine))
        self.seat_dofs = self.body_size + np.arange(SEATS, dtype=PETSc.IntType)
        self.contact_dofs = np.concatenate(
            [self.station_dofs[:, :3].ravel(), self.seat_dofs, self.station_dofs[:, 3:].ravel()]
        )
        own = index_map.local_to_global(rod.numbering.own.ravel().astype(np.int32)).reshape(rod.numbering.own.shape)
        element = np.concatenate(comm.allgather(line.element[: line.owned_cells]))
        self.element_dofs = np.empty((len(element), rod.element.own), dtype=PETSc.IntType)
        self.element_dofs[element] = np.concatenate(comm.allgather(own))

    @cached_property
    def weights(self) -> np.ndarray:
        """See Layout: 1 of displacements, a tenth of the extent squared of rotations; collective."""
        n, natural = len(self.station_dofs), np.ones(self.size)
        natural[: 6 * n].reshape(n, 6)[:, 3:] = (0.1 * self.rod.extent) ** 2
        return self.from_order(natural).copy()

    @cached_property
    def arms(self) -> np.ndarray:
        """See Layout: 1 of forces, the extent of moments, so that N mm are not added to N; collective."""
        n, natural = len(self.station_dofs), np.ones(self.size)
        for rows in (natural[: 6 * n], natural[-SEATS:]):
            rows.reshape(-1, 6)[:, 3:] = self.rod.extent
        return self.from_order(natural).copy()

    @cached_property
    def directions(self) -> np.ndarray:
        """See Layout: of the forces on the stations; collective."""
        n, natural = len(self.station_dofs), np.full(self.size, 3)
        natural[: 6 * n].reshape(n, 6)[:, :3] = range(3)
        return self.from_order(natural).astype(int)

    def greatest_rotation(self, values: np.ndarray) -> float:
        """The greatest of the stations' rotations in `values`, parts here, rad."""
        turns = self.rod.numbering.rotations
        own = turns[(turns < self.owned).all(axis=1)]
        return float(np.linalg.norm(values[own], axis=1).max(initial=0.0))

    def carry(self, values: np.ndarray, rotations: np.ndarray, of: float, gap: float, to: float) -> None:
        """Carry each station's displacement and rotation in `values` on with its rotation in `rotations`, parts here.

        Lengths of intervals are as of `carried`, in those over which the rotations are.
        """
        moves, turns = self.rod.numbering.u, self.rod.numbering.rotations
        own = (np.hstack([moves, turns]) < self.owned).all(axis=1)
        ψ = rotations[turns[own]]
        values[moves[own]] = carried(values[moves[own]], ψ, of, gap, to)
        values[turns[own]] = rotated(values[turns[own]], (0.5 * of + gap + 0.5 * to) * ψ)

    @property
    def _all_dofs(self) -> np.ndarray:
        """Unknowns by stations, elements and seats."""
        return np.concatenate([self.station_dofs.ravel(), self.element_dofs.ravel(), self.seat_dofs])

    def gather(self, values: np.ndarray) -> np.ndarray:
        """Values of the local nodes, in the order of the stations on every rank; shape (nodes, …) → (stations, …)."""
        gathered = values[: self._nodes]
        if self.comm.size > 1:
            gathered = np.concatenate(self.comm.allgather(gathered))
        return gathered.take(self._place, axis=0)

    def at_station(self, values: np.ndarray, station: int) -> np.ndarray:
        """Values of the local nodes, shape (nodes, …), at one station, on every rank, shape (…); collective."""
        node = self._place[station] - self._before
        if self.comm.size == 1:
            return values[node].copy()
        mine = 0 <= node < self._nodes
        return self.comm.allreduce(values[node] if mine else np.zeros(values.shape[1:]))

    def acts_here(self, dofs: np.ndarray) -> np.ndarray:
        """Which contact elements act on unknowns of this rank, shape (m, k) → (m,), bool."""
        rows = self.contact_dofs[dofs]
        return ((rows >= self.start) & (rows < self.stop)).any(axis=1)

    def begins_here(self, dofs: np.ndarray) -> np.ndarray:
        """Which contact elements have their first unknown on this rank, so that each counts once; as `acts_here`."""
        return self.acts_here(dofs[:, :1])

    def to_order(self, values: np.ndarray) -> np.ndarray:
        """This rank's part of a vector → the whole by stations, elements and seats, the same on any number of ranks."""
        return np.concatenate(self.comm.allgather(values))[self._all_dofs]

    def from_order(self, ordered: np.ndarray) -> np.ndarray:
        """The inverse of `to_order`: this rank's part."""
        everything = np.empty(len(ordered))
        everything[self._all_dofs] = ordered
        return everything[self.start : self.stop]

    def natural(self, field: Field) -> np.ndarray:
        """A field at the last equilibrium in natural order; cells on rank 0 only; collective."""
        if field.where is Where.STATION:
            return self.gather(field.equilibrium)
        if field.where is Where.ELEMENT:
            return self.line.in_order(field.equilibrium)
        return self.to_order(field.equilibrium) if field.where is Where.UNKNOWN else field.equilibrium

    def take(self, field: Field, natural: np.ndarray) -> None:
        """Set a field's last equilibrium from the output of `natural`, complete on every rank."""
        if field.where is Where.STATION:
            natural = natural[self.line.node]
        elif field.where is Where.ELEMENT:
            natural = natural[self.line.element[: self.line.owned_cells]]
        elif field.where is Where.UNKNOWN:
            natural = self.from_order(natural)
        field.equilibrium[...] = natural
