"""The rod's law at many points, several at a time: the functions of `rod.return_map` in loops without branches.

Points are processed in groups. All points of a group get an elastic trial; those that flow are collected, and their
local problems are solved together. A row holds one quantity of all points of a group, so that vector registers take
neighbouring points. The loops are short: a processor works ahead in those that follow, while the terms of one wait for
each other, only as far as its registers reach. They have no branches: points that do not load plastically, or do not
converge, are marked and left to `return_map`, point by point, as are temperature tables and hardening by a curve.
"""

import numpy as np

from coilset.model.material.law.functions import N_ROWS, NODES, ROWS_START, elasticity, hardening, with_deviation
from coilset.model.material.point.local import (
    Group,
    Local,
    Start,
    Turn,
    axial_products,
    corrected,
    correction,
    equations,
    estimate,
    group,
    halved,
    is_last,
    nearer,
    rough_turn,
    turn,
)
from coilset.model.material.point.rod import (
    Beginning,
    Plastic,
    active,
    begin,
    end,
    inner,
    return_map,
    softening,
)
from coilset.model.runtime.kernels import INLINE, KERNEL, njit

GROUP = 64  # points processed together
NEWTON = 8  # iterations at most
STATE = 7  # columns of a point's state
RUNNING, CONVERGED, LEFT_OUT = 0.0, 1.0, 2.0  # how far a point has come

# Rows, each name where its quantity begins. What is given: the state, the strain increment, k² and its slope.
START = 0
STRAIN = START + STATE
K2 = STRAIN + 3
GIVEN = K2 + 2  # number of rows that are given
# Where the plastic part begins: n₀, the inner products of n₀ and e, β and σ (`rod.Beginning`).
NORMAL = GIVEN
PRODUCTS = NORMAL + 3
BETA = PRODUCTS + 5
SLOPE = BETA + 1
# Newton's method: b* and Λ, b* half way, how far the point has come; k² and its slope at b* and half way, and there ζ
# and κ with their slopes in the end's b*; s, x of both groups with theirs, and how both groups turn.
B = SLOPE + 1
MULTIPLIER = B + 1
HALF = MULTIPLIER + 1
ENDED = HALF + 1
END = ENDED + 1
MIDDLE = END + 2
ZETA = MIDDLE + 2
KAPPA = ZETA + 2
GROUP_A = KAPPA + 2
GROUP_C = GROUP_A + 4
TURN_A = GROUP_C + 4
TURN_C = TURN_A + 6
ROWS = TURN_C + 6
# In rows whose quantity is not needed at the same time: the elastic trial and whether it leaves the surface; ζ at the
# end and the Jacobian over its determinant; the tangent.
TRIAL, FLOWS = NORMAL, NORMAL + 3
LAST_ZETA, JACOBIAN = KAPPA, GROUP_A
TANGENT = NORMAL


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
    alone = p[N_ROWS] != 1.0 or p[ROWS_START + NODES] > 0.0
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


@njit(**INLINE)
def solve_rows(p: np.ndarray, size: int, with_tangent: bool, w: np.ndarray) -> int:
    """Replace the initial states by the final ones, and write the tangent.

    Args:
        p: parameter array of the law.
        size: number of points.
        with_tangent: whether the tangent is wanted.
        w: the rows; up to GIVEN they are given.

    Returns:
        Number of local iterations; `ENDED` is CONVERGED for the points that it is valid for.
    """
    _begin(p, size, w)
    _estimate(p, size, w)
    iterations = _newton(p, size, w)
    _end(p, size, with_tangent, w)
    return iterations


@njit(**INLINE)
def harden(p: np.ndarray, size: int, work: int, at: int, w: np.ndarray) -> None:
    """Write k² and its slope into the rows from `at` on, at the b* of the row `work`."""
    for j in range(size):
        w[at, j], w[at + 1, j] = hardening(p, ROWS_START, w[work, j])


@njit(**INLINE)
def _vector(w: np.ndarray, row: int, j: int) -> tuple[float, float, float]:
    return (w[row, j], w[row + 1, j], w[row + 2, j])


@njit(**INLINE)
def _start(E: float, G: float, w: np.ndarray, j: int) -> Start:
    na, ea, nn, ne, ee = w[PRODUCTS, j], w[PRODUCTS + 1, j], w[PRODUCTS + 2, j], w[PRODUCTS + 3, j], w[PRODUCTS + 4, j]
    return Start(w[START + 6, j], 0.0, E / 1.5, na, ea, 2.0 * G, nn, ne, ee)


@njit(**INLINE)
def _begin(p: np.ndarray, size: int, w: np.ndarray) -> None:
    """Where the plastic part of the increment begins."""
    E, G, _ = elasticity(p, 0.0)
    for j in range(size):
        n = active(_vector(w, START, j), _vector(w, START + 3, j))
        e = (E / 1.5 * w[STRAIN, j], G * w[STRAIN + 1, j], G * w[STRAIN + 2, j])
        beginning = begin(w[START + 6, j], 0.0, E, G, n, e, w[K2, j])
        start = beginning.start
        w[BETA, j], w[SLOPE, j] = beginning.beta, beginning.slope
        w[NORMAL, j], w[NORMAL + 1, j], w[NORMAL + 2, j] = beginning.n0[0], beginning.n0[1], beginning.n0[2]
        w[PRODUCTS, j], w[PRODUCTS + 1, j] = start.na, start.ea
        w[PRODUCTS + 2, j], w[PRODUCTS + 3, j], w[PRODUCTS + 4, j] = start.nn, start.ne, start.ee


@njit(**INLINE)
def _estimate(p: np.ndarray, size: int, w: np.ndarray) -> None:
    """Where Newton's method starts; points that do not load plastically are left out."""
    E, G, _ = elasticity(p, 0.0)
    for j in range(size):
        values = with_deviation(p, ROWS_START, w[START + 6, j], w[K2, j], w[K2 + 1, j])
        w[ZETA, j], w[KAPPA, j] = values[2], values[4]
    for j in range(size):
        guess = estimate(_start(E, G, w, j), w[K2, j], w[K2 + 1, j], w[ZETA, j], w[KAPPA, j])
        w[B, j], w[MULTIPLIER, j] = guess.b, guess.multiplier
        w[ENDED, j] = RUNNING if guess.loads else LEFT_OUT


@njit(**INLINE)
def _newton(p: np.ndarray, size: int, w: np.ndarray) -> int:
    """Newton's method until all have converged."""
    iteration, running = 0, 1
    while running > 0 and iteration < NEWTON:
        iteration += 1
        _functions(p, size, w)
        _groups(p, size, w)
        if iteration == 1:
            _approach(p, size, w)
        _turns(size, GROUP_A, TURN_A, w)
        _turns(size, GROUP_C, TURN_C, w)
        _correct(p, size, w)
        running = 0
        for j in range(size):
            running += 1 if w[ENDED, j] == RUNNING else 0
    return iteration


@njit(**INLINE)
def _functions(p: np.ndarray, size: int, w: np.ndarray) -> None:
    """The material functions at b* and half way."""
    for j in range(size):
        w[HALF, j] = 0.5 * (w[START + 6, j] + w[B, j])
    harden(p, size, B, END, w)
    harden(p, size, HALF, MIDDLE, w)
    for j in range(size):
        values = halved(with_deviation(p, ROWS_START, w[HALF, j], w[MIDDLE, j], w[MIDDLE + 1, j]))
        w[ZETA, j], w[ZETA + 1, j], w[KAPPA, j], w[KAPPA + 1, j] = values[2], values[3], values[4], values[5]


@njit(**INLINE)
def _groups(p: np.ndarray, size: int, w: np.ndarray) -> None:
    E, G, _ = elasticity(p, 0.0)
    for j in range(size):
        zeta, dzeta, kappa, dkappa = w[ZETA, j], w[ZETA + 1, j], w[KAPPA, j], w[KAPPA + 1, j]
        a, c = group(E / 1.5, zeta, dzeta, kappa, dkappa), group(2.0 * G, zeta, dzeta, kappa, dkappa)
        w[GROUP_A, j], w[GROUP_A + 1, j], w[GROUP_A + 2, j], w[GROUP_A + 3, j] = a.s, a.ds, a.x, a.dx
        w[GROUP_C, j], w[GROUP_C + 1, j], w[GROUP_C + 2, j], w[GROUP_C + 3, j] = c.s, c.ds, c.x, c.dx


@njit(**INLINE)
def _group(w: np.ndarray, row: int, j: int) -> Group:
    return Group(w[row, j], w[row + 1, j], w[row + 2, j], w[row + 3, j])


@njit(**INLINE)
def _approach(p: np.ndarray, size: int, w: np.ndarray) -> None:
    """Bring Λ nearer to n:n = k², whose error is larger than that of b*."""
    E, G, _ = elasticity(p, 0.0)
    for j in range(size):
        a, c, start, multiplier = _group(w, GROUP_A, j), _group(w, GROUP_C, j), _start(E, G, w, j), w[MULTIPLIER, j]
        products, others = axial_products(start), (start.nn, start.ne, start.ee)
        turns = rough_turn(a, multiplier), rough_turn(c, multiplier)
        w[MULTIPLIER, j] = nearer(a, c, turns[0], turns[1], products, others, w[END, j], multiplier)[1]


@njit(**INLINE)
def _turns(size: int, group: int, row: int, w: np.ndarray) -> None:
    for j in range(size):
        t = turn(_group(w, group, j), w[MULTIPLIER, j])
        w[row, j], w[row + 1, j], w[row + 2, j] = t.phi, t.y, t.phi_b
        w[row + 3, j], w[row + 4, j], w[row + 5, j] = t.y_b, t.phi_l, t.y_l


@njit(**INLINE)
def _turn(w: np.ndarray, row: int, j: int) -> Turn:
    return Turn(w[row, j], w[row + 1, j], w[row + 2, j], w[row + 3, j], w[row + 4, j], w[row + 5, j])


@njit(**INLINE)
def _correct(p: np.ndarray, size: int, w: np.ndarray) -> None:
    """One correction by Newton's method; keeps what the solution is made of, if it is the last."""
    E, G, _ = elasticity(p, 0.0)
    for j in range(size):
        b, k2, zeta, dzeta = w[B, j], w[END, j], w[ZETA, j], w[ZETA + 1, j]
        a, c, start = _turn(w, TURN_A, j), _turn(w, TURN_C, j), _start(E, G, w, j)
        values, middle = (k2, w[END + 1, j], 0.0, 0.0, 0.0, 0.0), (0.0, 0.0, zeta, dzeta, 0.0, 0.0)
        at = equations(start, values, middle, a, c, b)
        newton = correction(at)
        last = is_last(start, k2, at, newton, b) & (b > start.b) & (w[ENDED, j] == RUNNING)
        w[ENDED, j] = CONVERGED if last else w[ENDED, j]
        a, c = corrected(a, newton), corrected(c, newton)
        w[TURN_A, j], w[TURN_A + 1, j], w[TURN_C, j], w[TURN_C + 1, j] = a.phi, a.y, c.phi, c.y
        w[B, j], w[MULTIPLIER, j] = b + newton.b, w[MULTIPLIER, j] + newton.multiplier
        w[LAST_ZETA, j] = zeta + dzeta * newton.b
        w[JACOBIAN, j], w[JACOBIAN + 1, j] = at.r1b * newton.inverse, at.r1l * newton.inverse
        w[JACOBIAN + 2, j], w[JACOBIAN + 3, j] = at.r2b * newton.inverse, at.r2l * newton.inverse


@njit(**INLINE)
def _end(p: np.ndarray, size: int, with_tangent: bool, w: np.ndarray) -> None:
    E, G, _ = elasticity(p, 0.0)
    if not with_tangent:
        for j in range(size):
            _end_state(E, G, w, j)
        return
    for j in range(size):
        plastic = _end_state(E, G, w, j)
        first, second, third = softening(plastic, E, G)
        Ea = E / 1.5
        w[TANGENT, j], w[TANGENT + 1, j], w[TANGENT + 2, j] = E - Ea * first[0], -G * second[0], -G * third[0]
        w[TANGENT + 3, j], w[TANGENT + 4, j], w[TANGENT + 5, j] = -Ea * first[1], G - G * second[1], -G * third[1]
        w[TANGENT + 6, j], w[TANGENT + 7, j], w[TANGENT + 8, j] = -Ea * first[2], -G * second[2], G - G * third[2]


@njit(**INLINE)
def _end_state(E: float, G: float, w: np.ndarray, j: int) -> Plastic:
    """Replace the initial state of a point by the final one; returns its plastic part."""
    b, zeta = w[B, j], w[LAST_ZETA, j]
    local = Local(
        1,
        False,
        b,
        zeta,
        w[ZETA + 1, j],
        _turn(w, TURN_A, j),
        _turn(w, TURN_C, j),
        w[JACOBIAN, j],
        w[JACOBIAN + 1, j],
        w[JACOBIAN + 2, j],
        w[JACOBIAN + 3, j],
    )
    e = (E / 1.5 * w[STRAIN, j], G * w[STRAIN + 1, j], G * w[STRAIN + 2, j])
    n0, start = _vector(w, NORMAL, j), _start(E, G, w, j)
    plastic = end(Beginning(w[BETA, j], w[SLOPE, j], n0, e, start), local)
    pl = plastic.p
    w[START, j] += E * (w[STRAIN, j] - pl[0])
    w[START + 1, j] += G * (w[STRAIN + 1, j] - 2.0 * pl[1])
    w[START + 2, j] += G * (w[STRAIN + 2, j] - 2.0 * pl[2])
    for i in range(3):
        w[START + 3 + i, j] += zeta * pl[i]  # (3.1.8)
    w[START + 6, j] = b
    return plastic
