"""Elimination of the first unknowns of a dense matrix, a front, without pivoting.

A small front fits into a processor's nearest cache and is eliminated row after row. In a large one this would read all
pivot rows from memory again for each row. There PANEL pivots are eliminated at a time, first in their own columns; what
they do to the rest is a product of two matrices, which is subtracted in tiles of ROWS rows that stay in the nearest
cache while the panel's pivots pass, those of TILE columns in the next one.
"""

import numpy as np
from numba import njit

LARGE = 100  # rows of a front that is eliminated in panels: below, copies of the tiles cost more than they save
PANEL, ROWS, TILE = 64, 4, 256


@njit(cache=True, error_model="numpy")
def eliminate_pivots(F: np.ndarray, k: int, tiles: np.ndarray) -> int:
    """Eliminate the first k unknowns of a front in place.

    Args:
        F: the front, shape (w, w); L below the diagonal and U above it afterwards.
        k: number of pivots.
        tiles: room for (PANEL + ROWS) · TILE numbers.

    Returns:
        Number of negative pivots; −1 if one is zero or not finite.
    """
    w, negative, inverse = len(F), 0, np.empty(k)  # a division takes as long as many products
    if w < LARGE:
        return eliminate_rows(F, 0, k, 0, w, w, inverse)
    for begin in range(0, k, PANEL):
        stop = min(begin + PANEL, k)
        found = eliminate_rows(F, begin, stop, begin, stop, w, inverse)
        if found < 0:
            return -1
        negative += found
        eliminate_rows(F, begin, stop, stop, w, stop, inverse)
        for column in range(stop, w, TILE):
            subtract_product(F, begin, stop, column, min(column + TILE, w), tiles)
    return negative


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def eliminate_rows(F: np.ndarray, begin: int, stop: int, first: int, last: int, width: int, inverse: np.ndarray) -> int:
    """Eliminate the pivots from `begin` to `stop` from some rows' columns up to `width`, row after row.

    Args:
        F: the front.
        begin, stop: pivots.
        first, last: rows.
        width: number of columns.
        inverse: of the pivots, shape (k,); written where the rows are pivot rows, else read.

    Returns:
        Number of negative pivots among the rows; −1 if one is zero or not finite.
    """
    negative = 0
    for i in range(first, last):
        row, p, end = F[i], begin, min(i, stop)
        while p + 3 < end:  # four pivot rows at a time, as each number of the row is read and written once then
            one, two, three, four = F[p], F[p + 1], F[p + 2], F[p + 3]
            a = row[p] * inverse[p]
            b = (row[p + 1] - a * one[p + 1]) * inverse[p + 1]
            c = (row[p + 2] - a * one[p + 2] - b * two[p + 2]) * inverse[p + 2]
            d = (row[p + 3] - a * one[p + 3] - b * two[p + 3] - c * three[p + 3]) * inverse[p + 3]
            row[p], row[p + 1], row[p + 2], row[p + 3] = a, b, c, d
            for j in range(p + 4, width):
                row[j] -= (a * one[j] + b * two[j]) + (c * three[j] + d * four[j])
            p += 4
        if p + 1 < end:
            one, two = F[p], F[p + 1]
            a = row[p] * inverse[p]
            b = (row[p + 1] - a * one[p + 1]) * inverse[p + 1]
            row[p], row[p + 1] = a, b
            for j in range(p + 2, width):
                row[j] -= a * one[j] + b * two[j]
            p += 2
        if p < end:
            one = F[p]
            a = row[p] * inverse[p]
            row[p] = a
            for j in range(p + 1, width):
                row[j] -= a * one[j]
        if i < stop:
            if not abs(row[i]) > 0.0 or not abs(row[i]) < np.inf:
                return -1
            inverse[i] = 1.0 / row[i]
            negative += row[i] < 0.0
    return negative


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def subtract_product(F: np.ndarray, begin: int, stop: int, left: int, right: int, tiles: np.ndarray) -> None:
    """F_ij −= Σ F_ip F_pj over the pivots p from `begin` to `stop`, in all rows below and the columns from `left`.

    Rows lie TILE numbers apart in `tiles`, a distance that the compiler knows: it sees that they do not overlap.

    Args:
        F: the front.
        begin, stop: pivots, at most PANEL.
        left, right: columns, at most TILE.
        tiles: room for the pivot rows, and for ROWS rows in front of them.
    """
    n, many = right - left, stop - begin
    for p in range(many):
        for j in range(n):
            tiles[(ROWS + p) * TILE + j] = F[begin + p, left + j]
    for i in range(stop, len(F), ROWS):
        rows = min(ROWS, len(F) - i)
        for r in range(rows):
            for j in range(n):
                tiles[r * TILE + j] = F[i + r, left + j]
        p = 0
        while rows == ROWS and p + 3 < many:
            a, b, c, d = F[i, begin + p :], F[i + 1, begin + p :], F[i + 2, begin + p :], F[i + 3, begin + p :]
            a0, a1, a2, a3 = a[0], a[1], a[2], a[3]
            b0, b1, b2, b3 = b[0], b[1], b[2], b[3]
            c0, c1, c2, c3 = c[0], c[1], c[2], c[3]
            d0, d1, d2, d3 = d[0], d[1], d[2], d[3]
            at = (ROWS + p) * TILE
            for j in range(n):
                u0, u1, u2, u3 = tiles[at + j], tiles[at + TILE + j], tiles[at + 2 * TILE + j], tiles[at + 3 * TILE + j]
                tiles[j] = tiles[j] - a0 * u0 - a1 * u1 - a2 * u2 - a3 * u3
                tiles[TILE + j] = tiles[TILE + j] - b0 * u0 - b1 * u1 - b2 * u2 - b3 * u3
                tiles[2 * TILE + j] = tiles[2 * TILE + j] - c0 * u0 - c1 * u1 - c2 * u2 - c3 * u3
                tiles[3 * TILE + j] = tiles[3 * TILE + j] - d0 * u0 - d1 * u1 - d2 * u2 - d3 * u3
            p += 4
        for q in range(p, many):
            for r in range(rows):
                factor, at = F[i + r, begin + q], (ROWS + q) * TILE
                for j in range(n):
                    tiles[r * TILE + j] -= factor * tiles[at + j]
        for r in range(rows):
            for j in range(n):
                F[i + r, left + j] = tiles[r * TILE + j]
