"""The local problem of `local` at several points at a time, in loops without branches.

Points are processed in groups. All points of a group get an elastic trial; those that flow are collected, and their
local problems are solved together. A row holds one quantity of all points of a group, so that vector registers take
neighbouring points. The loops are short: a processor works ahead in those that follow, while the terms of one wait for
each other, only as far as its registers reach. They have no branches: points that do not load plastically, or do not
converge, are marked and solved one by one by `local.solve`, as are all if a curve gives the hardening.
"""

import math
from collections import namedtuple

import numpy as np

from coilset.model.core.material.law.functions import (
    N_ROWS,
    NODES,
    ROW_LENGTH,
    ROWS_START,
    TEMPERATURE,
    Functions,
    elasticity,
    functions,
    hardening,
    table_place,
    with_deviation,
)
from coilset.model.core.material.point.local import (
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
    is_last,
    nearer,
    rough_turn,
    solve,
    turn,
)
from coilset.model.core.runtime.kernels import INLINE, KERNEL, njit

# Points that are processed together: number of the first and how many; their temperature, E and G, and the row of `p`
# below it with the weight of the one above, 0 without.
Points = namedtuple("Points", "first size temperature E G row weight")

GROUP = 96
NEWTON = 8  # iterations at most
RUNNING, CONVERGED, LEFT_OUT = 0.0, 1.0, 2.0  # how far a point has come in Newton's method

# Rows, each name where its quantity begins. b*, k² and its slope at the start; the inner products of n₀ and e where the
# plastic part begins, and β.
WORK = 0
K2 = WORK + 1
PRODUCTS = K2 + 2
BETA = PRODUCTS + 5
# Newton's method: b* and Λ, b* half way, how far the point has come; k² and its slope at b* and half way, and there ζ
# and κ with their slopes in the end's b*; s, x of both groups with theirs, and how both groups turn.
B = BETA + 1
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
FORM = TURN_C + 6  # rows by component, see `groups`
# In rows whose quantity is not needed at the same time: whether the elastic trial leaves the surface; ζ at the end and
# the Jacobian over its determinant.
FLOWS = B
LAST_ZETA, JACOBIAN = KAPPA, GROUP_A


@njit(**INLINE)
def group_from(p: np.ndarray, old: np.ndarray, first: int, columns: int) -> Points:
    """As many points as are processed together, from the first on: those with a temperature of their own share it.

    Args:
        p: parameter array of the law.
        old: states of all points at the start, shape (points, columns) or wider.
        first: number of the first of them.
        columns: of a point's state without temperature.
    """
    first = max(first, 0)  # so that numba tests no index for its sign
    most, temperature = min(GROUP, old.shape[0] - first), p[TEMPERATURE]
    if p[N_ROWS] == 1.0:
        E, G, _ = elasticity(p, temperature)
        return Points(first, most, temperature, E, G, ROWS_START, 0.0)
    size = most
    if old.shape[1] > columns:
        temperature, size = old[first, columns], 1
        while size < most and old[first + size, columns] == temperature:
            size += 1
    E, G, _ = elasticity(p, temperature)
    row, weight = table_place(p, temperature)
    return Points(first, size, temperature, E, G, row, weight)


@njit(**INLINE)
def alone(p: np.ndarray, of: Points) -> bool:
    """Whether each point's local problem is solved alone: k² by a curve."""
    return p[of.row + NODES] > 0.0 or (p[N_ROWS] != 1.0 and p[of.row + ROW_LENGTH + NODES] > 0.0)


@njit(**INLINE)
def solve_rows(p: np.ndarray, of: Points, ca: float, flow: int, whole: int, w: np.ndarray) -> None:
    """Solve the local problem of points with given rows up to BETA.

    `ENDED` is the number of each point's local iterations, -1 if there was no convergence.

    Args:
        p: parameter array of the law.
        of: the group of points.
        ca: modulus of the components of group a; that of group c is 2G.
        flow, whole: as `groups.next_group` returns them.
        w: the rows.
    """
    left_out, cc = alone(p, of), 2.0 * of.G
    if not left_out:
        _estimate(p, of, ca, cc, whole, w)
        iterations = _newton(p, of, ca, cc, whole, w)
        for j in range(whole):
            converged = w[ENDED, j] == CONVERGED
            w[ENDED, j] = iterations if converged else RUNNING
            left_out |= not converged
    if left_out:
        _solve_alone(p, of, ca, cc, flow, w)


@njit(**KERNEL)
def _solve_alone(p: np.ndarray, of: Points, ca: float, cc: float, flow: int, w: np.ndarray) -> None:
    """Solve the local problems of points that Newton's method in rows leaves out."""
    for j in range(flow):
        if alone(p, of) or w[ENDED, j] == RUNNING:
            values = functions(p, w[WORK, j], of.temperature)
            _keep(solve(p, of.temperature, start_of(ca, cc, w, j), values), w, j)


@njit(**INLINE)
def _keep(local: Local, w: np.ndarray, j: int) -> None:
    """Write the solution of a point, and the number of iterations."""
    w[ENDED, j], w[B, j], w[LAST_ZETA, j], w[ZETA + 1, j] = local.iterations, local.b, local.zeta, local.dzeta
    _keep_turn(local.a, w, TURN_A, j)
    _keep_turn(local.c, w, TURN_C, j)
    w[JACOBIAN, j], w[JACOBIAN + 1, j] = local.r1b, local.r1l
    w[JACOBIAN + 2, j], w[JACOBIAN + 3, j] = local.r2b, local.r2l


@njit(**INLINE)
def harden(p: np.ndarray, of: Points, size: int, work: int, at: int, w: np.ndarray) -> None:
    """Write k² and its slope into the rows from `at` on, at the b* of the row `work`."""
    if alone(p, of):
        _harden_alone(p, of.temperature, size, work, at, w)
    else:
        _harden(p, of, size, work, at, w)


@njit(**INLINE)
def _harden(p: np.ndarray, of: Points, size: int, work: int, at: int, w: np.ndarray) -> None:
    """By the constants of (6.2.2)."""
    for j in range(size):
        w[at, j], w[at + 1, j] = hardening(p, of.row, w[work, j])
    if of.weight != 0.0:
        for j in range(size):
            low, slope = w[at, j], w[at + 1, j]
            k2, dk2 = hardening(p, of.row + ROW_LENGTH, w[work, j])
            w[at, j] = low + of.weight * (k2 - low) if low < math.inf else low
            w[at + 1, j] = slope + of.weight * (dk2 - slope)


@njit(**KERNEL)
def _harden_alone(p: np.ndarray, temperature: float, size: int, work: int, at: int, w: np.ndarray) -> None:
    """By a curve, which branches."""
    for j in range(size):
        values = functions(p, w[work, j], temperature)
        w[at, j], w[at + 1, j] = values[0], values[1]


@njit(**INLINE)
def _deviate(p: np.ndarray, of: Points, size: int, work: int, at: int, part: float, w: np.ndarray) -> None:
    """Write ζ and κ at the b* of the row `work`, where k² is in the rows `at`, and a part of their slopes, if any."""
    for j in range(size):
        values = with_deviation(p, of.row, w[work, j], w[at, j], w[at + 1, j])
        w[ZETA, j], w[KAPPA, j] = values[2], values[4]
        if part > 0.0:
            w[ZETA + 1, j], w[KAPPA + 1, j] = part * values[3], part * values[5]


@njit(**KERNEL)
def _deviate_between(p: np.ndarray, of: Points, size: int, work: int, part: float, w: np.ndarray) -> None:
    """`_deviate` between two temperatures, of each of which k² is needed."""
    for j in range(size):
        low, up = _row(p, of.row, w[work, j]), _row(p, of.row + ROW_LENGTH, w[work, j])
        w[ZETA, j], w[KAPPA, j] = low[2] + of.weight * (up[2] - low[2]), low[4] + of.weight * (up[4] - low[4])
        w[ZETA + 1, j] = part * (low[3] + of.weight * (up[3] - low[3]))
        w[KAPPA + 1, j] = part * (low[5] + of.weight * (up[5] - low[5]))


@njit(**INLINE)
def _row(p: np.ndarray, o: int, b: float) -> Functions:
    """All material functions of a row that has no curve."""
    k2, dk2 = hardening(p, o, b)
    return with_deviation(p, o, b, k2, dk2)


@njit(**INLINE)
def start_of(ca: float, cc: float, w: np.ndarray, j: int) -> Start:
    """What a point's increment starts from."""
    na, ea, nn, ne, ee = w[PRODUCTS, j], w[PRODUCTS + 1, j], w[PRODUCTS + 2, j], w[PRODUCTS + 3, j], w[PRODUCTS + 4, j]
    return Start(w[WORK, j], ca, na, ea, cc, nn, ne, ee)


@njit(**INLINE)
def keep_start(start: Start, w: np.ndarray, j: int) -> None:
    """Write what `start_of` reads, but b*."""
    w[PRODUCTS, j], w[PRODUCTS + 1, j] = start.na, start.ea
    w[PRODUCTS + 2, j], w[PRODUCTS + 3, j], w[PRODUCTS + 4, j] = start.nn, start.ne, start.ee


@njit(**INLINE)
def _estimate(p: np.ndarray, of: Points, ca: float, cc: float, size: int, w: np.ndarray) -> None:
    """Where Newton's method starts; points that do not load plastically are left out."""
    if of.weight == 0.0:
        _deviate(p, of, size, WORK, K2, 0.0, w)
    else:
        _deviate_between(p, of, size, WORK, 0.0, w)
    for j in range(size):
        guess = estimate(start_of(ca, cc, w, j), w[K2, j], w[K2 + 1, j], w[ZETA, j], w[KAPPA, j])
        w[B, j], w[MULTIPLIER, j] = guess.b, guess.multiplier
        w[ENDED, j] = RUNNING if guess.loads else LEFT_OUT


@njit(**INLINE)
def _newton(p: np.ndarray, of: Points, ca: float, cc: float, size: int, w: np.ndarray) -> int:
    """Newton's method until all have converged."""
    iteration, running = 0, 1
    while running > 0 and iteration < NEWTON:
        iteration += 1
        _functions(p, of, size, w)
        _groups(ca, cc, size, w)
        if iteration == 1:
            _approach(ca, cc, size, w)
        _turns(size, GROUP_A, TURN_A, w)
        _turns(size, GROUP_C, TURN_C, w)
        _correct(ca, cc, size, w)
        running = 0
        for j in range(size):
            running += 1 if w[ENDED, j] == RUNNING else 0
    return iteration


@njit(**INLINE)
def _functions(p: np.ndarray, of: Points, size: int, w: np.ndarray) -> None:
    """The material functions at b* and half way."""
    for j in range(size):
        w[HALF, j] = 0.5 * (w[WORK, j] + w[B, j])
    _harden(p, of, size, B, END, w)
    _harden(p, of, size, HALF, MIDDLE, w)
    if of.weight == 0.0:
        _deviate(p, of, size, HALF, MIDDLE, 0.5, w)
    else:
        _deviate_between(p, of, size, HALF, 0.5, w)


@njit(**INLINE)
def _groups(ca: float, cc: float, size: int, w: np.ndarray) -> None:
    for j in range(size):
        zeta, dzeta, kappa, dkappa = w[ZETA, j], w[ZETA + 1, j], w[KAPPA, j], w[KAPPA + 1, j]
        a, c = group(ca, zeta, dzeta, kappa, dkappa), group(cc, zeta, dzeta, kappa, dkappa)
        w[GROUP_A, j], w[GROUP_A + 1, j], w[GROUP_A + 2, j], w[GROUP_A + 3, j] = a.s, a.ds, a.x, a.dx
        w[GROUP_C, j], w[GROUP_C + 1, j], w[GROUP_C + 2, j], w[GROUP_C + 3, j] = c.s, c.ds, c.x, c.dx


@njit(**INLINE)
def _group(w: np.ndarray, row: int, j: int) -> Group:
    return Group(w[row, j], w[row + 1, j], w[row + 2, j], w[row + 3, j])


@njit(**INLINE)
def _approach(ca: float, cc: float, size: int, w: np.ndarray) -> None:
    """Bring Λ nearer to n:n = k², whose error is larger than that of b*."""
    for j in range(size):
        a, c, start, multiplier = _group(w, GROUP_A, j), _group(w, GROUP_C, j), start_of(ca, cc, w, j), w[MULTIPLIER, j]
        products, others = axial_products(start), (start.nn, start.ne, start.ee)
        turns = rough_turn(a, multiplier), rough_turn(c, multiplier)
        w[MULTIPLIER, j] = nearer(a, c, turns[0], turns[1], products, others, w[END, j], multiplier)[1]


@njit(**INLINE)
def _turns(size: int, group: int, row: int, w: np.ndarray) -> None:
    for j in range(size):
        _keep_turn(turn(_group(w, group, j), w[MULTIPLIER, j]), w, row, j)


@njit(**INLINE)
def _keep_turn(t: Turn, w: np.ndarray, row: int, j: int) -> None:
    w[row, j], w[row + 1, j], w[row + 2, j] = t.phi, t.y, t.phi_b
    w[row + 3, j], w[row + 4, j], w[row + 5, j] = t.y_b, t.phi_l, t.y_l


@njit(**INLINE)
def turn_of(w: np.ndarray, row: int, j: int) -> Turn:
    """How a group turns, from the rows that begin at one."""
    return Turn(w[row, j], w[row + 1, j], w[row + 2, j], w[row + 3, j], w[row + 4, j], w[row + 5, j])


@njit(**INLINE)
def _correct(ca: float, cc: float, size: int, w: np.ndarray) -> None:
    """One correction by Newton's method; keeps what the solution is made of, if it is the last."""
    for j in range(size):
        b, k2, zeta, dzeta = w[B, j], w[END, j], w[ZETA, j], w[ZETA + 1, j]
        a, c, start = turn_of(w, TURN_A, j), turn_of(w, TURN_C, j), start_of(ca, cc, w, j)
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
