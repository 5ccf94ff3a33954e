"""The direct solver on several ranks: each eliminates its own unknowns, and all of them the interface.

The wire is divided into contiguous pieces. An unknown coupled with one of a lower rank is an *interface* unknown s; the
other unknowns i of a rank are then coupled only among themselves and with interface unknowns:

    S = A_ss − Σ_ranks A_si A_ii⁻¹ A_is,    S x_s = b_s − Σ_ranks A_si A_ii⁻¹ b_i,    A_ii x_i = b_i − A_is x_s.

At a cut of the wire, s are the unknowns of one node. Coils that touch across it add those of one winding; the seats,
which belong to the last rank, are included. S is gathered, and every rank eliminates it in the same order, so that the
result is the same to the bit on all ranks and in every run.

If most unknowns couple ranks, as in short springs of many elements whose coils touch, the blocks of S would cost more
than they save. All unknowns then belong to the interface, and each rank eliminates the whole matrix.
"""

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from coilset.model.equilibrium.elimination import Plan, plan_elimination
from coilset.model.equilibrium.multifrontal import PartialLU

FEW = 200  # interface unknowns up to which eliminating the whole matrix is not considered


class ChainLU:
    """Factors of a PETSc matrix that is distributed by rows and has a symmetric pattern, which must not change.

    Args:
        mat: the matrix.

    Raises:
        ValueError: if the pattern is not symmetric.

    Attributes:
        interface: global numbers of the interface unknowns, ascending, shape (m,).
        negative_pivots: of all ranks; of a symmetric matrix as many as it has negative eigenvalues.
    """

    def __init__(self, mat: PETSc.Mat) -> None:
        self.mat, self.comm, self.negative_pivots = mat, mat.getComm().tompi4py(), 0
        self.start, self.stop = mat.getOwnershipRange()
        indptr, indices, _ = mat.getValuesCSR()
        self._indptr, self._indices = indptr, indices
        rows = np.repeat(np.arange(self.start, self.stop), np.diff(indptr))
        coupled = np.unique(rows[indices < self.start])
        self.interface = np.concatenate(self.comm.allgather(coupled))
        mine = ~np.isin(rows, coupled)  # entries of the rows outside the interface
        self._numbers = np.union1d(rows[mine], indices[mine])  # of the rank's own matrix
        self._divide()
        if len(self.interface) > FEW and self._whole_is_cheaper():
            self.interface, self._numbers = np.arange(mat.getSize()[0]), self._numbers[:0]
            self._divide()
        self._local, self._shared = PartialLU(self._local_plan), PartialLU(self._shared_plan)
        self._blocks = np.empty(self._block_starts[-1])
        self._gathered = [self.comm.allgather(places) for places in (self._rows, self._at)]

    # ---- plan ------------------------------------------------------------------------------------------------------

    def _divide(self) -> None:
        """Plan the rank's own elimination and that of S."""
        self._set = PETSc.IS().createGeneral(self._numbers.astype(PETSc.IntType), comm=PETSc.COMM_SELF)
        self._part = self.mat.createSubMatrices([self._set], [self._set])
        indptr, indices, self._local_order = ascending_pattern(self._part[0])
        keep = np.isin(self._numbers, self.interface)
        rows = np.repeat(np.arange(len(keep)), np.diff(indptr))
        self._among_kept = np.flatnonzero(keep[rows] & keep[indices])
        self._local_plan = plan_elimination(indptr, indices, keep)
        inner = self._local_plan.order[: len(keep) - self._local_plan.kept]
        self._inner, self._kept = inner, self._numbers[self._local_plan.order[len(inner) :]]
        self._shared_plan = self._plan_shared()

    def _plan_shared(self) -> Plan:
        """Plan for S, whose entries are those of A_ss and a dense block of each rank."""
        size = len(self.interface)
        self._rows = np.flatnonzero((self.interface >= self.start) & (self.interface < self.stop))
        mine = self.interface[self._rows] - self.start
        lengths = np.diff(self._indptr)[mine]
        columns = np.concatenate(
            [self._indices[:0], *(self._indices[self._indptr[i] : self._indptr[i + 1]] for i in mine)]
        )
        self._shared_entries = np.flatnonzero(np.isin(columns, self.interface))
        entries = np.repeat(self._rows, lengths) * size + np.searchsorted(self.interface, columns)
        gathered = self.comm.allgather(entries[self._shared_entries])
        self._counts, entries = [len(each) for each in gathered], np.concatenate(gathered)
        at = np.searchsorted(self.interface, self._kept)  # of the rank's own block
        blocks = [(each[:, None] * size + each).ravel() for each in self.comm.allgather(at)]
        places = np.unique(np.concatenate([entries, np.arange(size) * (size + 1), *blocks]))
        self._shared_places = np.searchsorted(places, entries)
        self._block_places = [np.searchsorted(places, block) for block in blocks]
        self._at, self._values = at, np.empty(len(places))
        self._block_starts = np.append(0, np.cumsum([len(block) for block in blocks]))
        counts = np.bincount(places // max(size, 1), minlength=size)
        return plan_elimination(np.append(0, np.cumsum(counts)), places % max(size, 1), np.zeros(size, dtype=bool))

    def _whole_is_cheaper(self) -> bool:
        """Whether eliminating the whole matrix takes fewer multiplications than the two plans; collective."""
        lengths = np.concatenate(self.comm.allgather(np.diff(self._indptr)))
        indptr, indices = np.append(0, np.cumsum(lengths)), np.concatenate(self.comm.allgather(self._indices))
        plan = plan_elimination(indptr, indices, np.zeros(len(indptr) - 1, dtype=bool))
        local = self.comm.allreduce(self._local_plan.multiplications, op=MPI.MAX)
        return plan.multiplications < local + self._shared_plan.multiplications

    # ---- factors ---------------------------------------------------------------------------------------------------

    def factorise(self) -> bool:
        """Factorise the current matrix; False on every rank if a pivot is zero or NaN; collective."""
        self._part = self.mat.createSubMatrices([self._set], [self._set], self._part)
        own = self._part[0].getValuesCSR()[2][self._local_order]
        own[self._among_kept] = 0.0  # couplings between interface unknowns are in A_ss
        found = self._local.factorise(own)
        starts = self._block_starts
        self.comm.Allgatherv(self._local.schur.ravel(), (self._blocks, np.diff(starts)))
        self._values[:] = 0.0
        shared = np.empty(sum(self._counts))
        self.comm.Allgatherv(self._interface_rows()[self._shared_entries], (shared, self._counts))
        self._values[self._shared_places] = shared
        for rank, places in enumerate(self._block_places):
            self._values[places] += self._blocks[starts[rank] : starts[rank + 1]]
        found &= self._shared.factorise(self._values)
        failed, negative = self.comm.allreduce(np.array([not found, self._local.negative_pivots]))
        self.negative_pivots = int(negative) + self._shared.negative_pivots
        return failed == 0

    def _interface_rows(self) -> np.ndarray:
        """Entries of this rank's rows of interface unknowns."""
        if len(self._rows) == self.stop - self.start:
            return self.mat.getValuesCSR()[2]
        rows = self.interface[self._rows].tolist()
        return np.concatenate([np.empty(0), *(self.mat.getRow(row)[1] for row in rows)])

    def solve(self, right: np.ndarray, out: np.ndarray) -> None:
        """Write this rank's part of the solution into `out`, given that of the right side; collective."""
        b = np.zeros(len(self._numbers))
        b[self._inner] = right[self._numbers[self._inner] - self.start]
        mine = right[self.interface[self._rows] - self.start], self._local.forward(b)
        parts = self.comm.allgather(mine)
        x = np.zeros(len(self.interface))
        for places, values in zip(self._gathered, zip(*parts, strict=True), strict=True):
            for place, value in zip(places, values, strict=True):
                x[place] += value
        self._shared.backward(self._shared.forward(x), x)
        self._local.backward(x[self._at], b)
        out[self._numbers[self._inner] - self.start] = b[self._inner]
        out[self.interface[self._rows] - self.start] = x[self._rows]


def ascending_pattern(mat: PETSc.Mat) -> tuple[np.ndarray, np.ndarray, np.ndarray | slice]:
    """CSR pattern of a matrix with ascending columns, and the permutation of PETSc's entries to it."""
    indptr, indices, _ = mat.getValuesCSR()
    rows = np.repeat(np.arange(len(indptr) - 1), np.diff(indptr))
    entries = rows * mat.getSize()[1] + indices
    if (np.diff(entries) > 0).all():
        return indptr, indices, slice(None)
    order = np.argsort(entries)
    return indptr, indices[order], order


class ChainPC:
    """ChainLU as a preconditioner of PETSc's type `python`."""

    def __init__(self) -> None:
        self.factors: ChainLU | None = None

    def setUp(self, pc: PETSc.PC) -> None:
        """Factorise; collective."""
        if self.factors is None:
            self.factors = ChainLU(pc.getOperators()[1])
        found = self.factors.factorise()
        pc.setFailedReason(PETSc.PC.FailedReason.NOERROR if found else PETSc.PC.FailedReason.FACTOR_NUMERIC_ZEROPIVOT)

    def apply(self, pc: PETSc.PC, right: PETSc.Vec, out: PETSc.Vec) -> None:
        """Solve; collective."""
        assert self.factors is not None  # PETSc sets up before
        self.factors.solve(right.getArray(readonly=True), out.getArray())

    def reset(self, pc: PETSc.PC) -> None:
        """Forget the pattern."""
        self.factors = None
