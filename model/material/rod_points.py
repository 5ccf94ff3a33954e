"""The rod's law at many points, several at a time: the same functions as `rod.return_map`, in loops without branches.

Points are processed in groups. All points of a group get an elastic trial; those that flow are collected, and Newton's
method of `local` runs on all of them until each has converged; then the tangent is built. Cases that would make a loop
branch are left to `return_map` itself, point by point: neutral loading, Newton steps that leave the bracket or do not
converge, spin, temperature tables, heating, yield that depends on the rate, and hardening by a curve. Arrays hold a
quantity of all points in a row, so that vector registers can take neighbouring points at once.
"""

import numpy as np
from numba import njit

from coilset.model.material.functions import (
    CHANGE,
    EXPONENT,
    N_ROWS,
    NODES,
    ROWS_START,
    SPIN,
    elasticity,
    row_constants,
)
from coilset.model.material.kernel import INLINE, KERNEL
from coilset.model.material.local import (
    Group,
    Local,
    Start,
    axial_products,
    corrected,
    correction,
    equations,
    group,
    halved,
    is_last,
    nearer,
    turn,
    turn_at_rest,
)
from coilset.model.material.rod import Beginning, active, begin, end, inner, return_map, softening

GROUP = 64  # points processed together; their rows fill half of a processor's first-level cache
NEWTON = 8  # iterations at most, before a point is left to `return_map`
STATE = 7  # columns of a point's state

# Rows of the work space: state and strain increments at the start, and whether the point flows,
OLD, STRAIN, FLOWS = 0, 7, 10
# of those that flow the same, then n₀, β, n₀:e, and the solution as in `local.Local`.
START, DE, NORMAL, PRODUCTS, BETA, CROSSING, ENDED, B, MULTIPLIER, ZETA, DZETA, A, C, JACOBIAN = (
    11, 18, 21, 24, 29, 30, 31, 32, 33, 34, 35, 36, 40, 44,
)  # fmt: skip
ROWS = 48


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
    w, place = np.empty((ROWS, GROUP)), np.empty(GROUP, np.int64)
    good = True
    for first in range(0, points, GROUP):
        size = min(GROUP, points - first)
        flow = _elastic(p, old, de, new, tangent, count, first, size, w, place)
        if flow == 0:
            continue
        padded = min((flow + 7) // 8 * 8, GROUP)
        for j in range(flow, padded):
            place[j] = place[flow - 1]
        for j in range(padded):
            for i in range(STATE):
                w[START + i, j] = w[OLD + i, place[j]]
            for i in range(3):
                w[DE + i, j] = w[STRAIN + i, place[j]]
        _begin(p, padded, w)
        _first(p, padded, w)
        iterations = _newton(p, padded, w)
        _end(p, padded, with_tangent, w)
        for j in range(flow):
            k = first + place[j]
            if w[ENDED, j] != 1.0:
                count[k] = one_point(p, old, de, k, new, tangent)
                good = good and count[k] >= 0
                continue
            count[k] = iterations
            for i in range(STATE):
                new[k, i] = w[START + i, j]
            if with_tangent:
                for i in range(9):
                    tangent[i, k] -= w[A + i, j]
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
def _elastic(
    p: np.ndarray,
    old: np.ndarray,
    de: np.ndarray,
    new: np.ndarray,
    tangent: np.ndarray,
    count: np.ndarray,
    first: int,
    size: int,
    w: np.ndarray,
    place: np.ndarray,
) -> int:
    """Write the elastic response of a group and the indices of the points that flow; returns their number."""
    E, G, _ = elasticity(p, 0.0)
    for k in range(size):
        for i in range(STATE):
            w[OLD + i, k] = old[first + k, i]
        for i in range(3):
            w[STRAIN + i, k] = de[i, first + k]
    for k in range(size):
        s1 = w[OLD, k] + E * w[STRAIN, k]
        s2, s3 = w[OLD + 1, k] + G * w[STRAIN + 1, k], w[OLD + 2, k] + G * w[STRAIN + 2, k]
        n = active((s1, s2, s3), (w[OLD + 3, k], w[OLD + 4, k], w[OLD + 5, k]))
        k2 = row_constants(p, ROWS_START, w[OLD + 6, k])[0]
        w[FLOWS, k] = 0.0 if inner(n, n) <= k2 * (1.0 + 1e-12) else 1.0
        w[START, k], w[START + 1, k], w[START + 2, k] = s1, s2, s3
    flow = 0
    for k in range(size):
        for i in range(3):
            new[first + k, i] = w[START + i, k]
        for i in range(3, STATE):
            new[first + k, i] = w[OLD + i, k]
        count[first + k] = 0
        if w[FLOWS, k] != 0.0:
            place[flow] = k
            flow += 1
    for i in range(9):
        modulus = 0.0 if i % 4 else E if i == 0 else G
        for k in range(size):
            tangent[i, first + k] = modulus
    return flow


@njit(**INLINE)
def _start(E: float, G: float, w: np.ndarray, j: int) -> Start:
    na, ea, nn, ne, ee = w[PRODUCTS, j], w[PRODUCTS + 1, j], w[PRODUCTS + 2, j], w[PRODUCTS + 3, j], w[PRODUCTS + 4, j]
    return Start(w[START + 6, j], 0.0, 0.0, E / 1.5, na, ea, 0.0, 2.0 * G, nn, ne, ee)


@njit(**INLINE)
def _begin(p: np.ndarray, size: int, w: np.ndarray) -> None:
    """Where the plastic part of the increment begins."""
    E, G, _ = elasticity(p, 0.0)
    for j in range(size):
        b = w[START + 6, j]
        stress, back = (
            (w[START, j], w[START + 1, j], w[START + 2, j]),
            (w[START + 3, j], w[START + 4, j], w[START + 5, j]),
        )
        e = (E * w[DE, j] / 1.5, G * w[DE + 1, j], G * w[DE + 2, j])
        k2 = row_constants(p, ROWS_START, b)[0]
        beginning = begin(b, 0.0, 0.0, 0.0, E, G, active(stress, back), e, k2, 0.0, False)
        start = beginning.start
        w[BETA, j], w[CROSSING, j] = beginning.beta, beginning.crossing
        w[NORMAL, j], w[NORMAL + 1, j], w[NORMAL + 2, j] = beginning.n0[0], beginning.n0[1], beginning.n0[2]
        w[PRODUCTS, j], w[PRODUCTS + 1, j] = start.na, start.ea
        w[PRODUCTS + 2, j], w[PRODUCTS + 3, j], w[PRODUCTS + 4, j] = start.nn, start.ne, start.ee


@njit(**INLINE)
def _first(p: np.ndarray, size: int, w: np.ndarray) -> None:
    """Newton's first step, from b*₀ and Λ = 0; neutrally loaded points are marked for `return_map`."""
    E, G, _ = elasticity(p, 0.0)
    for j in range(size):
        b = w[START + 6, j]
        values = row_constants(p, ROWS_START, b)
        start, middle = _start(E, G, w, j), halved(values)
        ga = group(start.ca, middle[2], middle[3], middle[4], middle[5])
        gc = group(start.cc, middle[2], middle[3], middle[4], middle[5])
        ta, tc = turn_at_rest(ga), turn_at_rest(gc)
        at = equations(start, values, middle, ta, tc, b)
        newton = correction(at)
        w[ENDED, j] = 0.0 if (at.r1 >= 0.0) & (newton.g <= 0.0) else 2.0
        a, c = axial_products(start, b), (start.nn, start.ne, start.ee)
        w[B, j] = b + (newton.b if newton.b > 0.0 else 0.0)
        w[MULTIPLIER, j] = nearer(ga, gc, ta, tc, a, c, values[0], 0.0)[1]


@njit(**INLINE)
def _newton(p: np.ndarray, size: int, w: np.ndarray) -> int:
    """Newton's method until all have converged; `ENDED` is 1 for these, 2 for points not in this loop."""
    E, G, _ = elasticity(p, 0.0)
    iteration, left = 0, 1
    while left > 0 and iteration < NEWTON:
        iteration += 1
        for j in range(size):
            b, b0 = w[B, j], w[START + 6, j]
            values = row_constants(p, ROWS_START, b)
            middle = halved(row_constants(p, ROWS_START, 0.5 * (b0 + b)))
            start = _start(E, G, w, j)
            ga = group(start.ca, middle[2], middle[3], middle[4], middle[5])
            gc = group(start.cc, middle[2], middle[3], middle[4], middle[5])
            a, c, multiplier = axial_products(start, b), (start.nn, start.ne, start.ee), w[MULTIPLIER, j]
            multiplier = nearer(ga, gc, turn(ga, multiplier), turn(gc, multiplier), a, c, values[0], multiplier)[1]
            at = equations(start, values, middle, turn(ga, multiplier), turn(gc, multiplier), b)
            newton = correction(at)
            last = is_last(start, values[0], at, newton, b) & (b > b0)
            w[ENDED, j] = 1.0 if last & (w[ENDED, j] < 2.0) else w[ENDED, j]
            ga, gc = corrected(ga, newton.b), corrected(gc, newton.b)
            w[B, j] = b + newton.b
            w[MULTIPLIER, j] = multiplier + newton.multiplier
            w[ZETA, j], w[DZETA, j] = middle[2] + middle[3] * newton.b, middle[3]
            w[A, j], w[A + 1, j], w[A + 2, j], w[A + 3, j] = ga.s, ga.ds, ga.x, ga.dx
            w[C, j], w[C + 1, j], w[C + 2, j], w[C + 3, j] = gc.s, gc.ds, gc.x, gc.dx
            w[JACOBIAN, j], w[JACOBIAN + 1, j] = at.r1b * newton.inverse, at.r1l * newton.inverse
            w[JACOBIAN + 2, j], w[JACOBIAN + 3, j] = at.r2b * newton.inverse, at.r2l * newton.inverse
        left = 0
        for j in range(size):
            left += 1 if w[ENDED, j] == 0.0 else 0
    return iteration


@njit(**INLINE)
def _end(p: np.ndarray, size: int, with_tangent: bool, w: np.ndarray) -> None:
    """Replace the initial states by the final ones, and write the reduction of the elastic tangent, from A on."""
    E, G, _ = elasticity(p, 0.0)
    still = (0.0, 0.0, 0.0)
    for j in range(size):
        ga, gc = (
            Group(w[A, j], w[A + 1, j], w[A + 2, j], w[A + 3, j]),
            Group(w[C, j], w[C + 1, j], w[C + 2, j], w[C + 3, j]),
        )
        local = Local(
            1, False, w[B, j], w[MULTIPLIER, j], w[ZETA, j], w[DZETA, j], ga, gc,
            w[JACOBIAN, j], w[JACOBIAN + 1, j], w[JACOBIAN + 2, j], w[JACOBIAN + 3, j],
        )  # fmt: skip
        n0 = (w[NORMAL, j], w[NORMAL + 1, j], w[NORMAL + 2, j])
        e = (E * w[DE, j] / 1.5, G * w[DE + 1, j], G * w[DE + 2, j])
        beginning = Beginning(w[BETA, j], w[CROSSING, j], n0, e, _start(E, G, w, j))
        plastic = end(beginning, local, 0.0, 0.0)
        taken = softening(plastic, still, still, still, E, G, 0.0)
        pl = plastic.p
        w[START, j] += E * (w[DE, j] - pl[0])
        w[START + 1, j] += G * (w[DE + 1, j] - 2.0 * pl[1])
        w[START + 2, j] += G * (w[DE + 2, j] - 2.0 * pl[2])
        for i in range(3):
            w[START + 3 + i, j] += local.zeta * pl[i]  # (3.1.8)
        w[START + 6, j] = local.b
        for i in range(3):
            for k in range(3):
                w[A + 3 * i + k, j] = taken[k][i]
