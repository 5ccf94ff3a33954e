"""Matrices that are joined from small ones, each on some unknowns: the pattern of all of them, and their sum.

PETSc's own insertion seeks every entry of every small matrix in its row. Here runs of neighbouring unknowns, such as
the displacements of a station, are sought once, and first of all where they lay in the row before: the unknowns of a
station mostly have the same neighbours.
"""

from collections.abc import Sequence

import numpy as np

from coilset.model.runtime.kernels import njit


def join_patterns(
    pattern: tuple[np.ndarray, np.ndarray], tables: Sequence[np.ndarray], start: int, size: int
) -> tuple[np.ndarray, np.ndarray]:
    """Indptr and indices of a range of a matrix's rows, columns ascending, with room for further small matrices.

    Args:
        pattern: indptr and indices without them.
        tables: unknowns of the small matrices, shapes (m, k), (m', k') …
        start: number of the first row; size: number of all columns.
    """
    sizes = [np.full(len(unknowns), unknowns.shape[1]) for unknowns in tables]
    first = np.concatenate([np.zeros(1, np.int64), *sizes]).cumsum()
    unknowns = np.concatenate([pattern[1][:0], *(table.ravel() for table in tables)])
    return _join(*pattern, first, unknowns, start, size)


def add_matrices(
    own: tuple[np.ndarray, np.ndarray],
    others: tuple[np.ndarray, np.ndarray],
    unknowns: np.ndarray,
    numbers: np.ndarray,
    matrices: np.ndarray,
    stop: int,
    values: tuple[np.ndarray, np.ndarray],
) -> None:
    """Add small matrices to some rows of a matrix, which is kept in two parts: see `AijEntries`.

    Args:
        own: indptr and indices of the rows in their own columns, numbered from 0 on; they have room for the matrices.
        others: of the rows in the other columns, as well.
        unknowns: by what the small matrices call them: numbers of own columns, behind them of the others, and behind
            these any number for those that are in neither.
        numbers: what the small matrices call their unknowns, shape (m, k).
        matrices: shape (m, k, k).
        stop: one more than the greatest of the unknowns.
        values: of the entries of both parts.

    Raises:
        ValueError: if there is no room for them.
    """
    n = len(own[0]) - 1
    found = _add(*own, unknowns, numbers, matrices, 0, n, values[0])
    if stop > n:
        found &= _add(*others, unknowns, numbers, matrices, n, stop, values[1])
    if not found:
        raise ValueError("the matrix has no entries for some of the contacts")


@njit(cache=True)
def _matrices_of_rows(first: np.ndarray, unknowns: np.ndarray, start: int, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Which of the small matrices have each of n rows, in ranges."""
    begin = np.zeros(n + 1, np.int64)
    for unknown in unknowns:
        if start <= unknown < start + n:
            begin[unknown - start + 1] += 1
    begin = np.cumsum(begin)
    holders, at = np.empty(begin[n], np.int64), begin[:-1].copy()
    for matrix in range(len(first) - 1):
        for unknown in unknowns[first[matrix] : first[matrix + 1]]:
            row = unknown - start
            if 0 <= row < n:
                holders[at[row]] = matrix
                at[row] += 1
    return begin, holders


@njit(cache=True)
def _same(a: np.ndarray, b: np.ndarray) -> bool:
    same = len(a) == len(b)
    for i in range(len(a)):
        same = same and a[i] == b[i]
    return same


@njit(cache=True)
def _join(
    indptr: np.ndarray, indices: np.ndarray, first: np.ndarray, unknowns: np.ndarray, start: int, size: int
) -> tuple[np.ndarray, np.ndarray]:
    """As `join_patterns`, of small matrices whose unknowns lie one after the other, from `first` on."""
    n, count = len(indptr) - 1, 0
    begin, holders = _matrices_of_rows(first, unknowns, start, n)
    most = len(indices) + np.sum((first[1:] - first[:-1]) ** 2)  # most of which will never be touched
    out, found, seen = np.zeros_like(indptr), np.empty(most, indices.dtype), np.full(size, -1)
    for row in range(n):
        own, of_row = indices[indptr[row] : indptr[row + 1]], holders[begin[row] : begin[row + 1]]
        if (
            row > 0
            and _same(of_row, holders[begin[row - 1] : begin[row]])
            and _same(own, indices[indptr[row - 1] : indptr[row]])
        ):
            for k in range(out[row - 1], count):  # numba takes 3 s to compile the assignment of a slice
                found[count + k - out[row - 1]] = found[k]
            count += count - out[row - 1]
            out[row + 1] = count
            continue
        end = count
        for column in own:
            found[end], seen[column] = column, row
            end += 1
        for matrix in of_row:
            for unknown in unknowns[first[matrix] : first[matrix + 1]]:
                if seen[unknown] != row:
                    seen[unknown] = row
                    found[end] = unknown
                    end += 1
        found[count:end].sort()
        count = end
        out[row + 1] = count
    return out, found[:count]


@njit(cache=True)
def _find_runs(
    columns: np.ndarray, start: int, stop: int, begin: np.ndarray, length: np.ndarray, first: np.ndarray
) -> int:
    """Runs of neighbouring columns from `start` to `stop`: write at which places they begin, how long they are, and
    their first columns, counted from `start`; their number."""
    runs, b = 0, 0
    while b < len(columns):
        end = b + 1
        if start <= columns[b] < stop:
            while end < len(columns) and columns[end] == columns[end - 1] + 1 and columns[end] < stop:
                end += 1
            begin[runs], length[runs], first[runs] = b, end - b, columns[b] - start
            runs += 1
        b = end
    return runs


@njit(cache=True)
def _add(
    indptr: np.ndarray,
    indices: np.ndarray,
    unknowns: np.ndarray,
    numbers: np.ndarray,
    matrices: np.ndarray,
    start: int,
    stop: int,
    values: np.ndarray,
) -> bool:
    """As `add_matrices`, to the part of the columns from `start` to `stop`; False if some entry has no place."""
    n, k = len(indptr) - 1, numbers.shape[1]
    columns, begin, length, first = np.empty((4, k), np.int64)
    offset = np.zeros(k, np.int64)  # of each run: its place in a row
    for m in range(len(numbers)):
        for a in range(k):
            columns[a] = unknowns[numbers[m, a]]
        runs = _find_runs(columns, start, stop, begin, length, first)
        for a in range(k):
            row = columns[a]
            if row < 0 or row >= n:
                continue
            low, high, of_row = indptr[row], indptr[row + 1], matrices[m, a]
            for run in range(runs):
                b, many, column, p = begin[run], length[run], first[run], low + offset[run]
                if p + many > high or indices[p] != column:
                    p = low + np.searchsorted(indices[low:high], column)
                    if p + many > high or indices[p] != column:
                        return False
                    offset[run] = p - low
                if indices[p + many - 1] != column + many - 1:  # columns ascend: those between are right, too
                    return False
                if many == 3:  # a station's displacements
                    values[p] += of_row[b]
                    values[p + 1] += of_row[b + 1]
                    values[p + 2] += of_row[b + 2]
                else:
                    for j in range(many):
                        values[p + j] += of_row[b + j]
    return True


@njit(cache=True)
def add_vectors(unknowns: np.ndarray, numbers: np.ndarray, vectors: np.ndarray, start: int, out: np.ndarray) -> None:
    """Add small vectors, shape (m, k), to the `out` of a range of rows from `start` on; see `add_matrices`."""
    for m in range(len(numbers)):
        for a in range(numbers.shape[1]):
            row = unknowns[numbers[m, a]] - start
            if 0 <= row < len(out):
                out[row] += vectors[m, a]


@njit(cache=True)
def number_pairs(numbers: np.ndarray, count: int, out: np.ndarray) -> None:
    """Write a number for the first and the last of the `count` unknowns in each row of `numbers`, shape (m, k)."""
    for m in range(len(numbers)):
        out[m] = numbers[m, 0] * count + numbers[m, -1]
