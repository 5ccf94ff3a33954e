"""The rod's law at many points, several at a time: the same functions as `rod.return_map`, in loops without branches.

Points are processed in groups. All points of a group get an elastic trial; those that flow are collected, and
`rod_rows` solves their local problems together. Cases that would make a loop branch are left to `return_map` itself,
point by point: neutral loading, Newton's method where it does not converge quickly, spin, temperature tables, heating,
yield that depends on the rate, and hardening by a curve.
"""

import numpy as np
from numba import njit

from coilset.model.base.kernel import INLINE, KERNEL
from coilset.model.material.law.functions import CHANGE, EXPONENT, N_ROWS, NODES, ROWS_START, SPIN, elasticity
from coilset.model.material.point.rod import return_map
from coilset.model.material.point.rod_plastic import active, inner
from coilset.model.material.point.rod_rows import (
    CONVERGED,
    ENDED,
    GIVEN,
    K2,
    ROWS,
    START,
    STATE,
    STRAIN,
    TANGENT,
    harden,
    solve_rows,
)

GROUP = 64  # points processed together
TRIAL, FLOWS = 12, 15  # rows of the elastic response, and whether it leaves the surface; then those of `rod_rows`


@njit(**KERNEL)
def return_map_points(
    p: np.ndarray,
    old: np.ndarray,
    de: np.ndarray,
    new: np.ndarray,
    tangent: np.ndarray,
    with_tangent: bool,
    count: np.ndarray,
) -> bool:
    """One increment of the rod's law at many points.

    Args:
        p: parameter array of the law.
        old: states at the start, shape (points, 7 or 8); not written.
        de: increments of ε11, γ12, γ13, shape (3, points).
        new: states at the end; written.
        tangent: d(σ11, τ12, τ13)/d(ε11, γ12, γ13) by rows, shape (9, points), N/mm²; written if `with_tangent`.
        count: local iterations of each point as `rod.return_map` gives them, shape (points,); written.

    Returns:
        Whether the law found a solution at all points.
    """
    points = old.shape[0]
    alone = p[SPIN] != 0.0 or p[N_ROWS] != 1.0 or p[CHANGE] != 0.0 or p[ROWS_START + NODES] > 0.0 or p[EXPONENT] > 0.0
    if alone or old.shape[1] != STATE:
        good = True
        for k in range(points):
            count[k] = one_point(p, old, de, k, new, tangent)
            good = good and count[k] >= 0
        return good
    w, place = np.empty((ROWS, GROUP)), np.empty(GROUP, np.uint64)  # without sign, which numba would test
    good = True
    for first in range(0, points, GROUP):
        size = min(GROUP, points - first)
        _trial(p, old, de, first, size, w)
        flow = _elastic(p, first, size, with_tangent, w, place, new, tangent, count)
        if flow == 0:
            continue
        iterations = solve_rows(p, _gather(flow, size, place, w), with_tangent, w)
        _scatter(first, flow, with_tangent, w, place, new, tangent)
        for j in range(flow):
            k = first + int(place[j])
            count[k] = iterations
            if w[ENDED, j] != CONVERGED:
                count[k] = one_point(p, old, de, k, new, tangent)
                good = good and count[k] >= 0
    return good


@njit(**KERNEL)
def one_point(p: np.ndarray, old: np.ndarray, de: np.ndarray, k: int, new: np.ndarray, tangent: np.ndarray) -> int:
    """`return_map` at the point k; arguments as in `return_map_points`."""
    c = np.empty((3, 3))
    iterations = return_map(p, old[k], de[0, k], de[1, k], de[2, k], new[k], c)
    for i in range(3):
        for j in range(3):
            tangent[3 * i + j, k] = c[i, j]
    return iterations


@njit(**INLINE)
def _trial(p: np.ndarray, old: np.ndarray, de: np.ndarray, first: int, size: int, w: np.ndarray) -> None:
    """The elastic response of a group, and which of its points flow."""
    E, G, _ = elasticity(p, 0.0)
    for k in range(size):
        for i in range(STATE):
            w[START + i, k] = old[first + k, i]
    harden(p, size, START + 6, K2, w)
    for k in range(size):
        e1, e2, e3 = de[0, first + k], de[1, first + k], de[2, first + k]
        s1, s2, s3 = w[START, k] + E * e1, w[START + 1, k] + G * e2, w[START + 2, k] + G * e3
        n = active((s1, s2, s3), (w[START + 3, k], w[START + 4, k], w[START + 5, k]))
        w[STRAIN, k], w[STRAIN + 1, k], w[STRAIN + 2, k] = e1, e2, e3
        w[TRIAL, k], w[TRIAL + 1, k], w[TRIAL + 2, k] = s1, s2, s3
        w[FLOWS, k] = 0.0 if inner(n, n) <= w[K2, k] * (1.0 + 1e-12) else 1.0


@njit(**INLINE)
def _elastic(
    p: np.ndarray,
    first: int,
    size: int,
    with_tangent: bool,
    w: np.ndarray,
    place: np.ndarray,
    new: np.ndarray,
    tangent: np.ndarray,
    count: np.ndarray,
) -> int:
    """Write the response of a group's elastic points, and the places of the others; returns their number."""
    if with_tangent:
        E, G, _ = elasticity(p, 0.0)
        for i in range(9):
            modulus = 0.0 if i % 4 else E if i == 0 else G
            for k in range(size):
                tangent[i, first + k] = modulus
    flow = 0
    for k in range(size):
        if w[FLOWS, k] != 0.0:
            place[flow] = k
            flow += 1
            continue
        count[first + k] = 0
        for i in range(3):
            new[first + k, i] = w[TRIAL + i, k]
        for i in range(3, STATE):
            new[first + k, i] = w[START + i, k]
    return flow


@njit(**INLINE)
def _gather(flow: int, size: int, place: np.ndarray, w: np.ndarray) -> int:
    """Move the points that flow to the front, and repeat the last up to whole vectors; returns how many these are."""
    whole = min((flow + 7) // 8 * 8, GROUP)
    if flow < size:
        for j in range(flow):
            for i in range(GIVEN):
                w[i, j] = w[i, place[j]]
    for i in range(GIVEN):
        for j in range(flow, whole):
            w[i, j] = w[i, flow - 1]
    return whole


@njit(**INLINE)
def _scatter(
    first: int, flow: int, with_tangent: bool, w: np.ndarray, place: np.ndarray, new: np.ndarray, tangent: np.ndarray
) -> None:
    """Write the results of the points that flow to their places."""
    for j in range(flow):
        k = np.uint64(first) + place[j]
        for i in range(STATE):
            new[k, i] = w[START + i, j]
        if with_tangent:
            for i in range(9):
                tangent[i, k] = w[TANGENT + i, j]
