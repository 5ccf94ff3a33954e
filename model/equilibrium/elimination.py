"""Symbolic phase of a partial sparse LU factorisation: its fronts, and which updates each one takes.

Unknowns with the same neighbours form a *group*, such as those of a node. A *front* is a dense matrix of the k unknowns
that it eliminates and of the m unknowns that these are then coupled with. Its update of the latter, m × m, is added to
the front that eliminates the first of them. Fronts are ordered so that pending updates form a stack.
"""

from dataclasses import dataclass
from operator import itemgetter

import numpy as np
from numba import njit

from coilset.model.equilibrium.fronts import find_fronts
from coilset.model.equilibrium.ordering import NARROW, fill_reducing_order, narrow_fronts, swept_order


@dataclass(frozen=True)
class Plan:
    """Elimination plan for all matrices with the same pattern.

    Attributes:
        order: unknown at each place of the elimination, shape (n,); the kept ones come last.
        kept: number of these.
        first: place of each front's first pivot, and n, shape (fronts + 1,). The last front holds the kept unknowns.
        rest_start, rest: places that each front is coupled with beyond its pivots, in ranges.
        into: row in the next front of each of `rest`.
        child_start, child: fronts whose updates each front takes, in ranges.
        entry_start, entry, position: entries of the matrix that each front takes, in ranges, and where they go in it.
        stack: maximum size of the stack of updates, in numbers.
        multiplications: of a factorisation.
    """

    order: np.ndarray
    kept: int
    first: np.ndarray
    rest_start: np.ndarray
    rest: np.ndarray
    into: np.ndarray
    child_start: np.ndarray
    child: np.ndarray
    entry_start: np.ndarray
    entry: np.ndarray
    position: np.ndarray
    stack: int
    multiplications: float


def plan_elimination(indptr: np.ndarray, indices: np.ndarray, keep: np.ndarray) -> Plan:
    """Plan for a pattern.

    Args:
        indptr, indices: the pattern, CSR with ascending columns and a full diagonal.
        keep: whether each unknown is kept, shape (n,), bool.

    Raises:
        ValueError: if the pattern is not symmetric.
    """
    mirror = mirrored_entries(indptr, indices)
    if not len(mirror) and len(indices):
        raise ValueError("the pattern of the matrix is not symmetric")
    group = np.unique(fingerprints(indptr, indices, keep), return_inverse=True)[1].astype(np.int64)
    size, members = np.bincount(group), np.argsort(group, kind="stable")
    graph = group_graph(indptr, indices, group, members, size)
    kept = np.zeros(len(size), dtype=bool)
    kept[group[keep]] = True
    order = fill_reducing_order(graph[0], graph[1], np.flatnonzero(kept))
    eliminated = int((~kept).sum())
    fronts = find_fronts(*graph, order, eliminated, size)
    places, narrow = number_places(*fronts, size, members), narrow_fronts(*fronts, size, NARROW)
    if narrow.sum() < eliminated:
        order = swept_order(order, narrow, kept, along=members[np.cumsum(size) - size])
        swept = number_places(*find_fronts(*graph, order, eliminated, size), size, members)
        places = min(places, swept, key=itemgetter(-1))
    order, first, rest_start, rest, child_start, child, stack, multiplications = places
    into, entry_start, entry, position = place_entries(
        indptr, indices, mirror, order, first, rest_start, rest, child_start, child
    )
    return Plan(
        order,
        int(keep.sum()),
        first,
        rest_start,
        rest,
        into,
        child_start,
        child,
        entry_start,
        entry,
        position,
        stack,
        multiplications,
    )


@njit(cache=True)
def mirrored_entries(indptr: np.ndarray, indices: np.ndarray) -> np.ndarray:
    """Entry (j, i) for each entry (i, j); nothing if one is missing."""
    mirror, next_in_row = np.empty(len(indices), np.int32), indptr[:-1].astype(np.int32)
    for i in range(len(indptr) - 1):
        for e in range(indptr[i], indptr[i + 1]):
            j = indices[e]
            mirror[e] = next_in_row[j]
            if next_in_row[j] >= indptr[j + 1] or indices[next_in_row[j]] != i:
                return np.empty(0, np.int32)
            next_in_row[j] += 1
    return mirror


@njit(cache=True)
def fingerprints(indptr: np.ndarray, indices: np.ndarray, keep: np.ndarray) -> np.ndarray:
    """A number for each row by the set of its columns, and by whether it is kept (Steele's SplitMix64, summed)."""
    found = np.empty(len(indptr) - 1, np.uint64)
    for i in range(len(found)):
        total = np.uint64(keep[i])
        for e in range(indptr[i], indptr[i + 1]):
            z = np.uint64(indices[e] + 1) * np.uint64(0x9E3779B97F4A7C15)
            z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
            z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
            total += z ^ (z >> np.uint64(31))
        found[i] = total
    return found


@njit(cache=True)
def group_graph(
    indptr: np.ndarray, indices: np.ndarray, group: np.ndarray, members: np.ndarray, size: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Neighbours of each group, itself among them, CSR; all rows of a group are equal."""
    n = len(size)
    out_ptr, out, seen, row = np.zeros(n + 1, np.int64), np.empty(len(indices), np.int64), np.full(n, -1), 0
    for g in range(n):
        out_ptr[g + 1] = out_ptr[g]
        i = members[row]
        for e in range(indptr[i], indptr[i + 1]):
            h = group[indices[e]]
            if seen[h] != g:
                seen[h] = g
                out[out_ptr[g + 1]] = h
                out_ptr[g + 1] += 1
        row += size[g]
    return out_ptr, out[: out_ptr[n]].copy()


@njit(cache=True)
def number_places(
    own_start: np.ndarray,
    own: np.ndarray,
    rest_start: np.ndarray,
    rest: np.ndarray,
    takes: np.ndarray,
    size: np.ndarray,
    members: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray, int, float]:
    """From groups to unknowns: see Plan for what comes back."""
    fronts, groups = len(own_start) - 1, len(size)
    begin = np.zeros(groups + 1, np.int64)
    begin[1:] = np.cumsum(size)
    order, place, first = np.empty(len(members), np.int64), np.empty(groups, np.int64), np.zeros(fronts + 1, np.int64)
    count = 0
    for f in range(fronts):
        first[f] = count
        for e in range(own_start[f], own_start[f + 1]):
            g = own[e]
            place[g] = count
            order[count : count + size[g]] = members[begin[g] : begin[g + 1]]
            count += size[g]
    first[fronts] = count
    out_start, total = np.zeros(fronts + 1, np.int64), 0
    for e in range(len(rest)):
        total += size[rest[e]]
    out, total = np.empty(total, np.int64), 0
    child_start = np.zeros(fronts + 1, np.int64)
    multiplications = 0.0
    for f in range(fronts):
        for e in range(rest_start[f], rest_start[f + 1]):
            g = rest[e]
            for k in range(size[g]):
                out[total] = place[g] + k
                total += 1
        out_start[f + 1] = total
        if takes[f] >= 0:
            child_start[takes[f] + 1] += 1
        if f < fronts - 1:
            pivots, others = float(first[f + 1] - first[f]), float(out_start[f + 1] - out_start[f])
            multiplications += pivots**3 / 3.0 + pivots**2 * others + pivots * others**2
    child_start = np.cumsum(child_start)
    child, filled = np.empty(child_start[fronts], np.int64), child_start.copy()
    top, highest = 0, 0
    for f in range(fronts):
        for e in range(child_start[f], child_start[f + 1]):
            top -= (out_start[child[e] + 1] - out_start[child[e]]) ** 2
        if takes[f] >= 0:
            child[filled[takes[f]]] = f
            filled[takes[f]] += 1
            top += (out_start[f + 1] - out_start[f]) ** 2
            highest = max(highest, top)
    return order, first, out_start, out, child_start, child, highest, multiplications


@njit(cache=True)
def place_entries(
    indptr: np.ndarray,
    indices: np.ndarray,
    mirror: np.ndarray,
    order: np.ndarray,
    first: np.ndarray,
    rest_start: np.ndarray,
    rest: np.ndarray,
    child_start: np.ndarray,
    child: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Where the updates and the matrix's entries go: `into`, `entry_start`, `entry`, `position` of Plan."""
    n, fronts = len(order), len(first) - 1
    place, row = np.empty(n, np.int32), np.zeros(n, np.int32)  # row: of what follows a front's pivots
    for p in range(n):
        place[order[p]] = p
    into, entry_start = np.zeros(len(rest), np.int32), np.zeros(fronts + 1, np.int64)
    entry, position, count = np.empty(len(indices), np.int32), np.empty(len(indices), np.int32), 0
    for f in range(fronts):
        begin, stop = first[f], first[f + 1]
        k, m = stop - begin, rest_start[f + 1] - rest_start[f]
        w = k + m
        for p in range(m):
            row[rest[rest_start[f] + p]] = k + p
        for c in child[child_start[f] : child_start[f + 1]]:
            for e in range(rest_start[c], rest_start[c + 1]):
                into[e] = rest[e] - begin if rest[e] < stop else row[rest[e]]
        for p in range(begin, stop):
            i = order[p]
            for e in range(indptr[i], indptr[i + 1]):
                q = place[indices[e]]
                if q >= stop:
                    entry[count], position[count] = e, (p - begin) * w + row[q]
                    entry[count + 1], position[count + 1] = mirror[e], row[q] * w + (p - begin)
                    count += 2
                elif q >= begin:
                    entry[count], position[count] = e, (p - begin) * w + (q - begin)
                    count += 1
        entry_start[f + 1] = count
    return into, entry_start, entry, position
