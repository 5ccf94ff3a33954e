"""The direct solver on several ranks: each eliminates its own unknowns, and all of them the interface.

The wire is divided into contiguous pieces. An unknown coupled with one of a lower rank is an *interface* unknown s; the
other unknowns i of a rank are then coupled only among themselves and with interface unknowns:

    S = A_ss − Σ_ranks A_si A_ii⁻¹ A_is,    S x_s = b_s − Σ_ranks A_si A_ii⁻¹ b_i,    A_ii x_i = b_i − A_is x_s.

At a cut of the wire, s are the unknowns of one node. Coils that touch across it add those of one winding; the seats,
which belong to the last rank, are included. S is gathered, and every rank eliminates it in the same order, so that the
result is the same to the bit on all ranks and in every run.

If many unknowns couple ranks, as in short springs of many elements whose coils touch, the blocks of S may cost more
than they save. All unknowns then belong to the interface, and each rank eliminates the whole matrix.
"""

from dataclasses import replace

import numpy as np
from mpi4py import MPI
from numba import njit
from petsc4py import PETSc

from coilset.model.equilibrium.aij import AijEntries, take
from coilset.model.equilibrium.elimination import Plan, plan_elimination
from coilset.model.equilibrium.multifrontal import PartialLU

# Interface unknowns, and their share of all, up to which eliminating the whole matrix is not considered. N windings on
# R ranks have R − 1 of them in the interface, (R − 1)/N of all: if that is little, a rank has many windings of its own.
FEW, SMALL_SHARE = 200, 0.05


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
        self.comm, self.negative_pivots = mat.getComm().tompi4py(), 0
        self.size, (self.start, self.stop) = mat.getSize()[0], mat.getOwnershipRange()
        self._starts, self._entries = mat.getOwnershipRanges(), AijEntries(mat)
        coupled = self.start + coupled_rows(*self._entries.pattern, self.start)
        self.interface = np.concatenate(self.comm.allgather(coupled))
        self._divide()
        if len(self.interface) > max(FEW, SMALL_SHARE * self.size) and self._whole_is_cheaper():
            self.interface = np.arange(self.size)
            self._divide()
        self._local, self._shared = PartialLU(self._local_plan), PartialLU(self._shared_plan)
        self._blocks = np.empty(self._block_starts[-1])
        self._gathered = [self.comm.allgather(places) for places in (self._rows, self._at)]
        # entries in columns of other ranks, what is fetched, and a zero
        self._behind = np.zeros(len(self._entries.others[1]) + self._take.sum() + 1)

    # ---- plan ------------------------------------------------------------------------------------------------------

    def _divide(self) -> None:
        """Plan the rank's own elimination, of its rows outside the interface, and that of S."""
        indptr, indices = self._entries.pattern
        of_interface, places = np.zeros(self.size, dtype=bool), self._entries.places()
        of_interface[self.interface] = True
        mine, across, complete = split_entries(indptr, indices, self.start, of_interface)
        fetched = self._plan_fetching(across, mine, complete, places)
        kept = np.unique(indices[across])
        self._numbers = np.union1d(self.start + np.flatnonzero(~of_interface[self.start : self.stop]), kept)
        at, keep = np.zeros(self.size, np.int32), of_interface[self._numbers]
        at[self._numbers] = np.arange(len(self._numbers))
        own_indptr, own_indices, entries = own_pattern(
            indptr, indices, self.start, self._numbers, at, keep, places, fetched
        )
        plan = plan_elimination(own_indptr, own_indices, keep)
        self._local_plan = replace(plan, entry=entries[plan.entry])
        self._inner, last = np.split(plan.order, [len(keep) - plan.kept])
        self._kept, self._inner_rows = self._numbers[last], self._numbers[self._inner] - self.start
        self._shared_plan = self._plan_shared(mine[of_interface[indices[mine]]], places)

    def _unknowns(self, entries: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Rows and columns of some of this rank's entries."""
        indptr, indices = self._entries.pattern
        return self.start + np.searchsorted(indptr, entries, side="right") - 1, indices[entries].astype(np.int64)

    def _plan_fetching(self, across: np.ndarray, mine: np.ndarray, complete: bool, places: np.ndarray) -> np.ndarray:
        """Plan to fetch A_si, whose pattern is that of A_is, from the ranks of its rows; collective.

        Args:
            across: entries of A_is.
            mine: entries of this rank's own interface rows.
            complete: is the interface all that couples this rank's other rows with other ranks?
            places: of this rank's entries.

        Returns:
            Places of the entries of A_si behind this rank's own, in the order of A_is.

        Raises:
            ValueError: if there are no such entries.
        """
        columns, rows = self._unknowns(across)
        owner = np.searchsorted(self._starts, rows, side="right") - 1
        wanted = self.comm.alltoall([(rows * self.size + columns)[owner == rank] for rank in range(self.comm.size)])
        own_rows, own_columns = self._unknowns(mine)
        keys = own_rows * self.size + own_columns
        complete = complete and all(np.isin(each, keys).all() for each in wanted)
        if not self.comm.allreduce(int(complete), op=MPI.MIN):
            raise ValueError("the pattern of the matrix is not symmetric")
        at = [mine[np.searchsorted(keys, each)] for each in wanted]
        self._sent, self._give = places[np.concatenate(at)], np.array([len(each) for each in at])
        self._take = np.bincount(owner, minlength=self.comm.size)
        fetched = np.empty(len(rows), np.int64)
        fetched[np.argsort(owner, kind="stable")] = len(places) + np.arange(len(rows))
        return fetched

    def _plan_shared(self, entries: np.ndarray, places: np.ndarray) -> Plan:
        """Plan for S, whose entries are those of A_ss, of which this rank has some, and a dense block of each rank."""
        size, self._shared_entries = len(self.interface), places[entries]
        self._rows = np.flatnonzero((self.interface >= self.start) & (self.interface < self.stop))
        rows, columns = (np.searchsorted(self.interface, unknowns) for unknowns in self._unknowns(entries))
        gathered = self.comm.allgather(rows * size + columns)
        self._counts, entries = [len(each) for each in gathered], np.concatenate(gathered)
        at = np.searchsorted(self.interface, self._kept)  # of the rank's own block
        blocks = [(each[:, None] * size + each).ravel() for each in self.comm.allgather(at)]
        pattern = np.unique(np.concatenate([entries, np.arange(size) * (size + 1), *blocks]))
        self._shared_places = np.searchsorted(pattern, entries)
        self._block_places = [np.searchsorted(pattern, block) for block in blocks]
        self._at, self._values = at, np.empty(len(pattern))
        self._block_starts = np.append(0, np.cumsum([len(block) for block in blocks]))
        counts = np.bincount(pattern // max(size, 1), minlength=size)
        columns = (pattern % max(size, 1)).astype(np.int32)
        return plan_elimination(np.append(0, np.cumsum(counts)), columns, np.zeros(size, dtype=bool))

    def _whole_is_cheaper(self) -> bool:
        """Whether eliminating the whole matrix takes fewer multiplications than the two plans; collective."""
        mine = np.diff(self._entries.pattern[0]), self._entries.pattern[1]
        lengths, indices = (np.concatenate(self.comm.allgather(each)) for each in mine)
        indptr = np.append(0, np.cumsum(lengths))
        plan = plan_elimination(indptr, indices, np.zeros(len(indptr) - 1, dtype=bool))
        local = self.comm.allreduce(self._local_plan.multiplications, op=MPI.MAX)
        return plan.multiplications < local + self._shared_plan.multiplications

    # ---- factors ---------------------------------------------------------------------------------------------------

    def factorise(self) -> bool:
        """Factorise the current matrix; False on every rank if a pivot is zero or NaN; collective."""
        (own, others), behind = self._entries.arrays(only_read=True), self._behind
        behind[: len(others)] = others
        sent = take(self._sent, own, behind)
        self.comm.Alltoallv((sent, self._give), (behind[len(others) : -1], self._take))
        found = self._local.factorise(own, behind)
        starts = self._block_starts
        self.comm.Allgatherv(self._local.schur.ravel(), (self._blocks, np.diff(starts)))
        self._values[:] = 0.0
        shared = np.empty(sum(self._counts))
        self.comm.Allgatherv(take(self._shared_entries, own, behind), (shared, self._counts))
        self._values[self._shared_places] = shared
        for rank, places in enumerate(self._block_places):
            self._values[places] += self._blocks[starts[rank] : starts[rank + 1]]
        found &= self._shared.factorise(self._values)
        failed, negative = self.comm.allreduce(np.array([not found, self._local.negative_pivots]))
        self.negative_pivots = int(negative) + self._shared.negative_pivots
        return failed == 0

    def solve(self, right: np.ndarray, out: np.ndarray) -> None:
        """Write this rank's part of the solution into `out`, given that of the right side; collective."""
        b = np.zeros(len(self._numbers))
        b[self._inner] = right[self._inner_rows]
        mine = right[self.interface[self._rows] - self.start], self._local.forward(b)
        parts = self.comm.allgather(mine)
        x = np.zeros(len(self.interface))
        for places, values in zip(self._gathered, zip(*parts, strict=True), strict=True):
            for place, value in zip(places, values, strict=True):
                x[place] += value
        self._shared.backward(self._shared.forward(x), x)
        self._local.backward(x[self._at], b)
        out[self._inner_rows] = b[self._inner]
        out[self.interface[self._rows] - self.start] = x[self._rows]


@njit(cache=True)
def coupled_rows(indptr: np.ndarray, indices: np.ndarray, start: int) -> np.ndarray:
    """Which of a rank's rows, from `start` on, have columns of lower ranks."""
    coupled = np.zeros(len(indptr) - 1, np.bool_)
    for row in range(len(coupled)):
        for e in range(indptr[row], indptr[row + 1]):
            coupled[row] |= indices[e] < start
    return np.flatnonzero(coupled)


@njit(cache=True)
def split_entries(
    indptr: np.ndarray, indices: np.ndarray, start: int, of_interface: np.ndarray
) -> tuple[np.ndarray, np.ndarray, bool]:
    """Entries of a rank's rows of interface unknowns; those of A_is; do these couple it with other ranks alone?"""
    mine, across, complete = np.empty(len(indices), np.int64), np.empty(len(indices), np.int64), True
    many_mine = many_across = 0
    for row in range(len(indptr) - 1):
        for e in range(indptr[row], indptr[row + 1]):
            column = indices[e]
            if of_interface[start + row]:
                mine[many_mine] = e
                many_mine += 1
            elif of_interface[column]:
                across[many_across] = e
                many_across += 1
            else:
                complete &= start <= column < start + len(indptr) - 1
    return mine[:many_mine].copy(), across[:many_across].copy(), complete


@njit(cache=True)
def own_pattern(
    indptr: np.ndarray,
    indices: np.ndarray,
    start: int,
    numbers: np.ndarray,
    at: np.ndarray,
    keep: np.ndarray,
    places: np.ndarray,
    fetched: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pattern of a rank's own matrix, without couplings between interface unknowns, which are in A_ss.

    Args:
        indptr, indices, start: pattern of the rank's rows.
        numbers: unknowns of its own matrix, ascending; at: the reverse.
        keep: which of them are interface unknowns.
        places: of the rank's entries in an array; fetched: of those of A_si in the order of A_is, behind them, where a
            zero follows.

    Returns:
        The pattern, CSR with ascending columns and a full diagonal, and the places of its entries.
    """
    n, zero = len(numbers), len(places) + len(fetched)
    out = np.zeros(n + 1, np.int64)
    for i in range(n):
        if keep[i]:
            out[i + 1] += 1
            continue
        row = numbers[i] - start
        out[i + 1] += indptr[row + 1] - indptr[row]
        for e in range(indptr[row], indptr[row + 1]):
            if keep[at[indices[e]]]:
                out[at[indices[e]] + 1] += 1
    out = np.cumsum(out)
    columns, entries, filled, mirrored = np.empty(out[n], np.int32), np.empty(out[n], np.int32), out[:-1].copy(), 0
    for i in range(n):  # in this order, columns ascend in the rows of A_si, too
        if keep[i]:
            columns[filled[i]], entries[filled[i]] = i, zero
            filled[i] += 1
            continue
        row, place = numbers[i] - start, filled[i]
        for e in range(indptr[row], indptr[row + 1]):
            j = at[indices[e]]
            columns[place], entries[place] = j, places[e]
            place += 1
            if keep[j]:
                columns[filled[j]], entries[filled[j]] = i, fetched[mirrored]
                filled[j] += 1
                mirrored += 1
    return out, columns, entries


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
