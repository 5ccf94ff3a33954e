"""Fronts of an elimination: which groups of unknowns are eliminated together, and in which order the fronts follow.

A group is eliminated after those on which it depends. What it is coupled with then are its neighbours and theirs that
come later: the structure of its column of L. The first of these takes its update, which makes the eliminated groups a
forest. A group joins the front of one of its children if both are then coupled with the same groups, or nearly so.
"""

import numpy as np
from numba import njit

# Fraction of zeros accepted for larger fronts: small fronts cost more to move than to eliminate.
ZEROS = 0.15
NONE = -1  # no such group


@njit(cache=True)
def find_fronts(
    indptr: np.ndarray, indices: np.ndarray, sequence: np.ndarray, eliminated: int, size: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Fronts by groups, each after those whose updates it takes.

    Args:
        indptr, indices: neighbours of the groups.
        sequence: groups in the order of their elimination, the kept ones last.
        eliminated: number of groups that are not kept.
        size: unknowns in each group.

    Returns:
        Groups of each front in ranges, with those that are kept in the last front; groups of each front's rest in
        ranges; the front that takes its update.
    """
    start, beyond, first_child, sibling, before, absorbed = _forest(indptr, indices, sequence, eliminated, size)
    last = _depth_first(start, beyond, first_child, sibling, before, absorbed)
    fronts, n, total, held = len(last) + 1, len(sequence), 0, 0
    for j in last:
        total += start[j + 1] - start[j]
    own_start, own, rest_start = np.zeros(fronts + 1, np.int64), np.empty(n, np.int64), np.zeros(fronts + 1, np.int64)
    rest, takes, front_of = np.empty(total, np.int64), np.full(fronts, NONE), np.full(n, fronts - 1)
    for f, j in enumerate(last):
        g = j
        while g >= 0:
            front_of[g] = f
            held += 1
            g = before[g]
        g, own_start[f + 1] = j, held
        for place in range(held - 1, own_start[f] - 1, -1):
            own[place] = sequence[g]
            g = before[g]
        rest_start[f + 1] = rest_start[f] + start[j + 1] - start[j]
        rest[rest_start[f] : rest_start[f + 1]] = np.sort(beyond[start[j] : start[j + 1]])
    own[held:] = sequence[eliminated:]
    own_start[fronts], rest_start[fronts] = n, total
    for f in range(fronts - 1):
        if rest_start[f + 1] > rest_start[f]:
            takes[f] = front_of[rest[rest_start[f]]]
    for e in range(total):
        rest[e] = sequence[rest[e]]
    return own_start, own, rest_start, rest, takes


@njit(cache=True)
def _forest(
    indptr: np.ndarray, indices: np.ndarray, sequence: np.ndarray, eliminated: int, size: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """What each group is coupled with when it is eliminated, and which one it joins; groups by their place.

    Args:
        indptr, indices, sequence, eliminated, size: as in `find_fronts`.

    Returns:
        Groups beyond each one, in ranges; its first child and the next with the same parent, or NONE; the group before
        it in its front, or NONE; whether another one has it before it.
    """
    n = len(sequence)
    at, before = np.empty(n, np.int64), np.full(eliminated, NONE)
    at[sequence] = np.arange(n)
    start, beyond, count = np.zeros(eliminated + 1, np.int64), np.empty(4 * len(indices) + 16, np.int64), 0
    first_child, sibling, weight = np.full(n, NONE), np.full(eliminated, NONE), np.zeros(eliminated, np.int64)
    seen, absorbed = np.full(n, NONE), np.zeros(eliminated, np.bool_)
    pivots, zeros = np.zeros(eliminated, np.int64), np.zeros(eliminated, np.int64)
    for j in range(eliminated):
        neighbours = indices[indptr[sequence[j]] : indptr[sequence[j] + 1]]
        beyond = _with_room(beyond, count, len(neighbours) + _length_of_children(start, first_child[j], sibling))
        seen[j] = j
        for g in neighbours:
            count = _add(at[g], j, seen, beyond, count)
        c = first_child[j]
        while c >= 0:
            for e in range(start[c], start[c + 1]):
                count = _add(beyond[e], j, seen, beyond, count)
            c = sibling[c]
        start[j + 1], parent = count, n
        for e in range(start[j], count):
            weight[j] += size[sequence[beyond[e]]]
            parent = min(parent, beyond[e])
        own, c, best, least = size[sequence[j]], first_child[j], NONE, 0
        while c >= 0:
            rows, added = pivots[c] + own, pivots[c] * (own + weight[j] - weight[c])
            if zeros[c] + added <= ZEROS * rows * (0.5 * rows + weight[j]) and (best < 0 or added < least):
                best, least = c, added
            c = sibling[c]
        pivots[j] = own
        if best >= 0:
            before[j], absorbed[best] = best, True
            pivots[j], zeros[j] = own + pivots[best], zeros[best] + least
        if parent < n:
            sibling[j], first_child[parent] = first_child[parent], j
    return start, beyond, first_child, sibling, before, absorbed


@njit(cache=True)
def _length_of_children(start: np.ndarray, child: int, sibling: np.ndarray) -> int:
    """Number of groups beyond the children, from the first `child` on."""
    length = 0
    while child >= 0:
        length += start[child + 1] - start[child]
        child = sibling[child]
    return length


@njit(cache=True)
def _with_room(values: np.ndarray, count: int, more: int) -> np.ndarray:
    """The array, or a longer one with its first `count` numbers, if it has no room for `more`."""
    if count + more <= len(values):
        return values
    longer = np.empty(2 * (count + more), values.dtype)
    longer[:count] = values[:count]
    return longer


@njit(cache=True)
def _add(k: int, j: int, seen: np.ndarray, beyond: np.ndarray, count: int) -> int:
    """Write the group k once if it comes later than j; the number of those written."""
    if k <= j or seen[k] == j:
        return count
    seen[k], beyond[count] = j, k
    return count + 1


@njit(cache=True)
def _depth_first(
    start: np.ndarray,
    beyond: np.ndarray,
    first_child: np.ndarray,
    sibling: np.ndarray,
    before: np.ndarray,
    absorbed: np.ndarray,
) -> np.ndarray:
    """The last group of each front, in an order in which pending updates form a stack; arguments as of `_forest`."""
    eliminated, height, number = len(before), 0, 0
    stack, met = np.empty(len(first_child) + 1, np.int64), np.zeros(len(before), np.bool_)
    last = np.empty(eliminated - np.sum(absorbed), np.int64)
    for root in range(eliminated - 1, -1, -1):
        above = beyond[start[root] : start[root + 1]]
        if not (absorbed[root] or (len(above) and np.min(above) < eliminated)):
            stack[height] = root
            height += 1
    while height:
        j = stack[height - 1]
        if met[j]:  # for the second time, after all below it
            height -= 1
            last[number] = j
            number += 1
            continue
        met[j], g = True, j
        while g >= 0:
            c = first_child[g]
            while c >= 0:
                if not absorbed[c]:
                    stack[height] = c
                    height += 1
                c = sibling[c]
            g = before[g]
    return last
