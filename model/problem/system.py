"""One vector for PETSc: the rod's increments, places and turns of the seats, with constraints and loads.

The rod's unknowns keep DOLFINx's numbering; those of the seats follow as the last entries of the last rank, so that
DOLFINx assembles into the enlarged matrix as it stands.
"""

import numpy as np
from dolfinx import la
from dolfinx.fem import petsc as _  # noqa: F401  (registers the PETSc assembly)
from mpi4py import MPI
from petsc4py import PETSc
from scipy import sparse

from coilset.model.contact.base import LEVEL, SEAT_DOFS, Augmented, HasMemory, LimitsStep, TrialPositions

SEATS = 2 * SEAT_DOFS  # unknowns of bottom and top seat
DEEP = 0.02  # penetration in wire diameters that no correction need avoid; at rest it is some tenths of that
GROWTH = 1.5
LEAST_WAY = 0.02  # share of a correction that is always gone


def comm_max(comm, value):
    """Greatest value of all ranks."""
    return comm.allreduce(float(value), op=MPI.MAX) if comm.size > 1 else float(value)


class System:
    """Residual and tangent of rod, contacts, prescribed values and forces.

    Args:
        rod: Rod.
        contacts: kinds of contact, see coilset.model.contact.base.
        seats: levels of bottom and top seat at the start, mm.

    Attributes:
        seats: x, y, z and turns of the bottom seat, then those of the top seat, shape (12,), mm and rad.
        fixed: system dof → increment prescribed in this step; set by the load program before each solve.
        forces: system dof → external force, N or N mm.
        share: of the step's increments and change of forces that is asked for at present; 1 but for a solve in parts.
        failed: True if the last evaluation found no stress at some point.
        fresh: is a solve about to begin? Its matrix has places for the contacts at its start and no others, so that the
            rounding of a factorisation does not depend on how the spring came there.
        patterns: how often the rows of a matrix were allocated; factors from before are of no use.
        reaction_start: internal forces at the last equilibrium, to measure the change of the reactions by.
    """

    def __init__(self, rod, contacts=(), seats=(0.0, 0.0)):
        self.rod, self.contacts, self.comm = rod, list(contacts), rod.mesh.comm
        self.memories = [contact.memory for contact in self.contacts if isinstance(contact, HasMemory)]
        self.limiting = [contact for contact in self.contacts if isinstance(contact, LimitsStep)]
        self.seats_start = np.zeros(SEATS)
        self.seats_start[LEVEL::SEAT_DOFS] = seats
        self.seats = self.seats_start.copy()
        self.share, self.failed, self.fresh, self.patterns = 1.0, False, True, 0
        self._number()
        self.contributions = []
        self._local = la.vector(rod.V.dofmap.index_map, rod.V.dofmap.index_map_bs)
        self.internal = self.vector()  # internal forces without constraints and loads
        self.reaction_start = self.internal.duplicate()
        self.fixed, self.forces = {}, {}
        self._evaluated = None
        # rows of prescribed values are weighted by an axial stiffness, so that norms of the residual are of one kind
        E, r, l = rod.law.E, rod.radius, rod.l0
        self.weight = comm_max(self.comm, (E * np.pi * r**2 / l).max(initial=0.0))
        self.largest_radius = comm_max(self.comm, r.max(initial=0.0))
        self.extent = float(np.ptp(rod.line.stations, axis=0).max())
        self.axial_force = E * np.pi * self.largest_radius**2  # E A

    # ---- constraints and loads -----------------------------------------------------------------------------------

    @property
    def fixed(self):
        """System dof → increment prescribed in this step."""
        return self._fixed

    @fixed.setter
    def fixed(self, values):
        self._fixed, self._held = values, self._mine(values)

    @property
    def forces(self):
        """System dof → external force at the end of this step, N or N mm."""
        return self._forces

    @forces.setter
    def forces(self, values):
        self._forces, self._loaded = values, self._mine(values)

    def _mine(self, entries):
        """Places in this rank's part of a vector, and values, of `entries`, a dict by system dofs."""
        start, stop = self.internal.getOwnershipRange()
        dofs = [dof for dof in entries if start <= dof < stop]
        return np.array(dofs, dtype=PETSc.IntType) - start, np.array([entries[dof] for dof in dofs], dtype=float)

    # ---- numbering -------------------------------------------------------------------------------------------------

    def _number(self):
        """Global dofs of all stations, and sizes of the enlarged vector."""
        index_map, comm = self.rod.V.dofmap.index_map, self.comm
        self.owned, self.last = index_map.size_local, comm.rank == comm.size - 1
        self.size_rod = index_map.size_global
        self.size_local = self.owned + (SEATS if self.last else 0)
        line, n = self.rod.line, len(self.rod.line.stations)
        nodes = line.mesh.geometry.index_map().size_local
        mine = np.concatenate([self.rod.u_dofs[:nodes], self.rod.turn_dofs[:nodes]], axis=1)
        mine = index_map.local_to_global(mine.ravel().astype(np.int32)).reshape(-1, 6)
        self.station_dofs = np.empty((n, 6), dtype=PETSc.IntType)
        self._order = np.concatenate(comm.allgather(line.node[:nodes]))
        self.station_dofs[self._order] = np.concatenate(comm.allgather(mine))
        self.seat_dofs = self.size_rod + np.arange(SEATS, dtype=PETSc.IntType)
        self.contact_dofs = np.concatenate(
            [self.station_dofs[:, :3].ravel(), self.seat_dofs, self.station_dofs[:, 3:].ravel()]
        )
        self._nodes = nodes
        shear = index_map.local_to_global(self.rod.shear_dofs.ravel().astype(np.int32)).reshape(-1, 2)
        element = np.concatenate(comm.allgather(line.element[: line.owned_cells]))
        self.element_dofs = np.empty((len(element), 2), dtype=PETSc.IntType)
        self.element_dofs[element] = np.concatenate(comm.allgather(shear))
        self._all_dofs = np.concatenate([self.station_dofs.ravel(), self.element_dofs.ravel(), self.seat_dofs])

    def to_order(self, vector):
        """Values of a vector of the system by stations, elements and seats, the same on any number of ranks."""
        parts = self.comm.allgather(vector.getArray(readonly=True))
        return np.concatenate(parts)[self._all_dofs]

    def from_order(self, values, vector):
        """Set a vector of the system from what `to_order` gave."""
        everything = np.empty(len(values))
        everything[self._all_dofs] = values
        vector.setArray(everything[slice(*vector.getOwnershipRange())])

    def vector(self):
        """A new PETSc vector of the system, zero."""
        return PETSc.Vec().createMPI((self.size_local, None), comm=self.comm)

    def matrix(self):
        """A new PETSc matrix of the system."""
        index_map = self.rod.V.dofmap.index_map
        A = PETSc.Mat().create(self.comm)
        A.setSizes(((self.size_local, None), (self.size_local, None)))
        A.setType(PETSc.Mat.Type.AIJ)
        ghosts = np.concatenate([np.arange(*index_map.local_range), index_map.ghosts]).astype(PETSc.IntType)
        A.setLGMap(PETSc.LGMap().create(ghosts, comm=self.comm), PETSc.LGMap().create(ghosts, comm=self.comm))
        A.setOption(PETSc.Mat.Option.KEEP_NONZERO_PATTERN, True)
        self._make_room(A)
        return A

    def _make_room(self, A):
        """Allocate the rows of `A` anew: a node couples with neighbours, shear angles, and what it touches."""
        entries = np.full(self.size_local, 22, dtype=PETSc.IntType)
        entries[self.rod.shear_dofs] = 14
        size, start = len(self._all_dofs), self.rod.V.dofmap.index_map.local_range[0]
        for part in self.contributions:
            dofs = self.contact_dofs[part.dofs]
            rows, columns = np.broadcast_arrays(dofs[:, :, None], dofs[:, None, :])
            places = rows.ravel(), columns.ravel()
            pattern = sparse.coo_array((np.ones(rows.size, np.int8), places), (size, size))
            entries += np.diff(pattern.tocsr().indptr)[start : start + self.size_local].astype(PETSc.IntType)
        here = np.minimum(entries, self.size_local)  # in columns of this rank
        there = np.minimum(entries, size - self.size_local)
        A.setPreallocationNNZ((here, there) if self.comm.size > 1 else here)
        A.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, False)
        self._places = self._contact_places()
        self.patterns += 1

    def _contact_places(self):
        """A number for each contact element by its first and last dof, which tell between what it acts."""
        places = [part.dofs[:, 0] * len(self.contact_dofs) + part.dofs[:, -1] for part in self.contributions]
        return np.concatenate(places) if places else np.empty(0, dtype=np.int64)

    # ---- state -----------------------------------------------------------------------------------------------------

    def gather(self, values):
        """Values of the local nodes, in the order of the stations on every rank; shape (nodes, …) → (stations, …)."""
        if self.comm.size == 1:
            gathered = values[: self._nodes]
        else:
            gathered = np.concatenate(self.comm.allgather(values[: self._nodes]))
        out = np.empty_like(gathered)
        out[self._order] = gathered
        return out

    def set_increments(self, X):
        """Bring the rod and the contacts to the increments in the PETSc vector `X`; False if no stress was found."""
        values = X.getArray(readonly=True)
        self._evaluated = values.copy()
        self.rod.increment.x.array[: self.owned] = values[: self.owned]
        self.rod.increment.x.scatter_forward()
        moved = values[self.owned :].copy() if self.last else None
        if self.comm.size > 1:
            moved = self.comm.bcast(moved, root=self.comm.size - 1)
        self.seats = self.seats_start + moved
        self._touch(self.rod.update())
        return not self.failed

    def _touch(self, good):
        """Evaluate the contacts at the rod's trial state, if stresses were found for it on every rank."""
        if self.comm.size > 1:
            good = self.comm.allreduce(int(good)) == self.comm.size
        self.contributions, self.failed = [], not good
        if self.contacts and good:
            rotations = None
            if any(contact.needs_rotations for contact in self.contacts):
                rotations = self.gather(self.rod.increment.x.array[self.rod.turn_dofs])
            trial = TrialPositions(self.gather(self.rod.x), self.seats, rotations)
            self.contributions = [contact.evaluate(trial) for contact in self.contacts]

    def commit(self):
        """Make the trial state the equilibrium."""
        self.internal.copy(self.reaction_start)
        self._evaluated = None
        self.rod.commit()
        self.seats_start = self.seats.copy()
        for memory in self.memories:
            memory.commit()

    def restore(self):
        """Go back to the last equilibrium."""
        self.seats = self.seats_start.copy()
        self.forget()
        self._touch(self.rod.restore())

    def forget(self):
        """Go back to what the contacts remember of the last equilibrium."""
        self._evaluated = None
        for memory in self.memories:
            memory.restore()

    def augment(self):
        """Press contacts harder where they have sunk in (augmented Lagrange), from the next evaluation on."""
        self._evaluated = None
        trial = TrialPositions(self.gather(self.rod.x), self.seats)
        for contact in self.contacts:
            if isinstance(contact, Augmented):
                contact.augment(trial)

    # ---- residual and tangent --------------------------------------------------------------------------------------

    def assemble_internal(self):
        """Internal forces of rod and contacts at the trial state, into `self.internal`."""
        local = self._local
        local.array[:] = 0.0
        self.rod.assemble_forces(local.array)
        local.scatter_reverse(la.InsertMode.add)
        with self.internal as values:
            values[: self.owned] = local.array[: self.owned]
            values[self.owned :] = 0.0
        start, stop = self.internal.getOwnershipRange()
        if self.contributions:
            rows = np.concatenate([self.contact_dofs[part.dofs].ravel() for part in self.contributions])
            forces = np.concatenate([part.forces.ravel() for part in self.contributions])
            mine = (rows >= start) & (rows < stop)
            with self.internal as values:
                np.add.at(values, rows[mine] - start, forces[mine])

    def residual(self, snes, X, F):
        """SNES callback: internal minus external forces; increment minus prescribed increment where it is fixed."""
        self.bring_to(X)
        self.balance(X, F)

    def balance(self, X, F):
        """The residual at the state of the last evaluation, `X`, into F."""
        self.internal.copy(F)
        values, x, before = F.getArray(), X.getArray(readonly=True), self.reaction_start.getArray(readonly=True)
        dofs, force = self._loaded
        values[dofs] -= self.share * force + (1.0 - self.share) * before[dofs]
        dofs, target = self._held
        values[dofs] = self.weight * (x[dofs] - self.share * target)
        if self.failed:
            F.set(np.inf)  # SNES sees a domain error; the step is cut

    def _is_evaluated(self, X):
        same = self._evaluated is not None and np.array_equal(self._evaluated, X.getArray(readonly=True))
        return self.comm.allreduce(int(same)) == self.comm.size if self.comm.size > 1 else same

    def value(self, vector, dof):
        """One entry of a vector of the system, on every rank."""
        return float(self.values(vector, dof))

    def values(self, vector, dofs):
        """Entries of a vector of the system at `dofs`, in their shape, on every rank."""
        start, stop = vector.getOwnershipRange()
        dofs = np.asarray(dofs)
        mine, out = (dofs >= start) & (dofs < stop), np.zeros(dofs.shape)
        out[mine] = vector.getArray(readonly=True)[dofs[mine] - start]
        return self.comm.allreduce(out) if self.comm.size > 1 else out

    def rounding(self, X):
        """Norm of the out-of-balance forces that rounding leaves, N.

        That of the increments, times the axial stiffness of the shortest element; and the force that strains the wire
        by 1e-14, so that a step without any change of load is at rest too.
        """
        greatest = comm_max(self.comm, np.abs(X.getArray(readonly=True)).max(initial=0.0))
        greatest = min(greatest, self.extent)  # what flies away is not at rest
        increments = np.finfo(float).eps * greatest * self.weight * np.sqrt(X.getSize())
        return max(increments, 1e-14 * self.axial_force)

    def bring_to(self, X):
        """Make `X` the trial state, if the last evaluation was at another one, as line searches may leave it."""
        if not self._is_evaluated(X):
            self.set_increments(X)
            self.assemble_internal()

    def misses(self, X):
        """Do the increments `X` miss a prescribed value by more than rounding?"""
        dofs, target = self._held
        off = np.abs(X.getArray(readonly=True)[dofs] - self.share * target).max(initial=0.0)
        scale = max((abs(value) for value in self.fixed.values()), default=0.0)
        return comm_max(self.comm, off) > 1e-12 * scale

    @property
    def depth(self):
        """Greatest penetration of coils and seats at the trial state, mm; infinite where no stress was found."""
        if self.failed:
            return np.inf
        parts = zip(self.contacts, self.contributions, strict=False)
        found = (part.penetration.max(initial=0.0) for contact, part in parts if isinstance(contact, LimitsStep))
        return max(found, default=0.0)

    def allowed_depth(self, depth):
        """Penetration up to which a correction may press, from a state with the penetration `depth`, mm."""
        return max(DEEP * 2.0 * self.largest_radius, GROWTH * depth)

    def reached(self, X):
        """Share of the prescribed increments in the increments `X`: that of the greatest one."""
        dof = max(self.fixed, key=lambda dof: abs(self.fixed[dof]))
        return self.value(X, dof) / self.fixed[dof]

    def free_way(self, X, Y, sign=1.0):
        """Greatest λ ≤ 1 up to which the increments X + λ · sign · Y do not press coils or seats far into each other.

        Penetrations up to DEEP wire diameters are free; from deeper ones it goes on as long as they less than double.
        """
        if not self.limiting:
            return 1.0
        n, start = len(self.station_dofs), self.gather(self.rod.equilibrium["x"])
        (x, seats), (u, moved) = ((values[: 6 * n].reshape(n, 6)[:, :3], values[-SEATS:])
                                  for values in (self.to_order(X), sign * self.to_order(Y)))  # fmt: skip
        x, seats = start + x, self.seats_start + seats

        def depth(share):
            trial = TrialPositions(x + share * u, seats + share * moved)
            return max(contact.max_penetration(trial) for contact in self.limiting)

        allowed = self.allowed_depth(depth(0.0))
        if depth(1.0) <= allowed:
            return 1.0
        low, high = LEAST_WAY, 1.0
        for _attempt in range(6):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if depth(middle) <= allowed else (low, middle)
        return low

    def clear_fixed(self, vector):
        """Zero the entries of a vector that belong to prescribed values."""
        values = vector.getArray()
        values[self._held[0]] = 0.0

    def imbalance(self, F):
        """How far the trial state with residual `F` is from equilibrium.

        Returns:
            Norm of the out-of-balance forces, norm of the change of loads and reactions since the step's start, N, and
            share of the prescribed increments that is still missing.
        """
        fixed, loaded = self._held[0], self._loaded[0]
        rest = F.getArray(readonly=True).copy()
        rest[fixed] = 0.0
        held = np.union1d(fixed, loaded) if len(loaded) else fixed
        change = self.internal.getArray(readonly=True)[held] - self.reaction_start.getArray(readonly=True)[held]
        missed = F.getArray(readonly=True)[fixed] / self.weight
        squares = np.array([rest @ rest, change @ change, missed @ missed])
        if self.comm.size > 1:
            squares = self.comm.allreduce(squares)
        rest, change, missed = np.sqrt(squares)
        prescribed = np.linalg.norm(list(self.fixed.values()))
        return rest, change, missed / prescribed if prescribed > 0.0 else missed

    def tangent(self, snes, X, J, P):
        """SNES callback: derivative of the residual at the state of the last evaluation."""
        if not self._is_evaluated(X):
            self.set_increments(X)
        places = self._contact_places()
        if np.array_equal(places, self._places) if self.fresh else np.isin(places, self._places).all():
            P.zeroEntries()
        else:  # a row that is full would be moved at each new entry, and the whole matrix with it
            self._make_room(P)
        self.fresh = False
        self.rod.assemble_tangent(P)
        start, stop = P.getOwnershipRange()
        for part in self.contributions:
            dofs = self.contact_dofs[part.dofs]
            mine = ((dofs >= start) & (dofs < stop)).any(axis=1)
            add_blocks(P, dofs[mine], part.stiffness[mine], start, stop)
        if self.last:
            for dof in self.seat_dofs:  # the diagonal must exist for a fixed or untouched seat
                P.setValue(dof, dof, 0.0, addv=PETSc.InsertMode.ADD_VALUES)
        P.assemble()
        P.zeroRows(self._held[0] + start, diag=self.weight)
        return True


def add_blocks(A, dofs, blocks, start, stop):
    """Add element matrices, shape (m, k, k), to the rows start ≤ row < stop of a PETSc matrix."""
    if not len(dofs):
        return
    rows = np.where((dofs >= start) & (dofs < stop), dofs, -1).astype(PETSc.IntType)  # PETSc skips negative rows
    A.setValuesRCV(rows, np.ascontiguousarray(dofs, dtype=PETSc.IntType), blocks, addv=PETSc.InsertMode.ADD_VALUES)
