"""The local problem of the rod's law at many points at once, in loops over rows of numbers.

A row holds one quantity of all points of a group, so that vector registers take neighbouring points. The loops are
short: a processor works ahead in those that follow, while the terms of one wait for each other, only as far as its
registers reach. They have no branches: points that do not load plastically, or do not converge, are marked.
"""

import numpy as np
from numba import njit

from coilset.model.base.kernel import INLINE
from coilset.model.material.law.functions import ROWS_START, elasticity, hardening, with_deviation
from coilset.model.material.point.local import (
    Group,
    Local,
    Start,
    Turn,
    axial_products,
    corrected,
    correction,
    equations,
    group,
    halved,
    is_last,
    nearer,
    rough_turn,
    turn,
)
from coilset.model.material.point.local_estimate import estimate
from coilset.model.material.point.rod_plastic import Beginning, Plastic, active, begin, end, softening

NEWTON = 8  # iterations at most
STATE = 7  # columns of a point's state
RUNNING, CONVERGED, LEFT_OUT = 0.0, 1.0, 2.0

# Rows: state and strain increments at the start, k² and its slope there;
START, STRAIN, K2, GIVEN = 0, 7, 10, 12
# n₀, the inner products of n₀ and e, β and σ (`rod_plastic.Beginning`); b* and Λ as they approach the solution, b* half
# way, and how far the point has come;
NORMAL, PRODUCTS, BETA, SLOPE, B, MULTIPLIER, HALF, ENDED = 12, 15, 20, 21, 22, 23, 24, 25
# k² and its slope at b*, the same half way, and there ζ, κ and their slopes in the end's b*;
END, MIDDLE, ZETA, KAPPA = 26, 28, 30, 32
# the groups and how they turn; ζ at the end, the Jacobian, and the tangent take rows that are no longer needed.
GROUPS, A, C = 34, 42, 48
LAST_ZETA, JACOBIAN, TANGENT, ROWS = 32, 34, 12, 54


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
    return Start(w[START + 6, j], 0.0, 0.0, E / 1.5, na, ea, 0.0, 2.0 * G, nn, ne, ee)


@njit(**INLINE)
def _begin(p: np.ndarray, size: int, w: np.ndarray) -> None:
    """Where the plastic part of the increment begins."""
    E, G, _ = elasticity(p, 0.0)
    for j in range(size):
        n = active(_vector(w, START, j), _vector(w, START + 3, j))
        e = (E / 1.5 * w[STRAIN, j], G * w[STRAIN + 1, j], G * w[STRAIN + 2, j])
        beginning = begin(w[START + 6, j], 0.0, 0.0, 0.0, E, G, n, e, w[K2, j], 0.0, False)
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
        _turns(size, GROUPS, A, w)
        _turns(size, GROUPS + 4, C, w)
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
        w[GROUPS, j], w[GROUPS + 1, j], w[GROUPS + 2, j], w[GROUPS + 3, j] = a.s, a.ds, a.x, a.dx
        w[GROUPS + 4, j], w[GROUPS + 5, j], w[GROUPS + 6, j], w[GROUPS + 7, j] = c.s, c.ds, c.x, c.dx


@njit(**INLINE)
def _group(w: np.ndarray, row: int, j: int) -> Group:
    return Group(w[row, j], w[row + 1, j], w[row + 2, j], w[row + 3, j])


@njit(**INLINE)
def _approach(p: np.ndarray, size: int, w: np.ndarray) -> None:
    """Bring Λ nearer to n:n = k², whose error is larger than that of b*."""
    E, G, _ = elasticity(p, 0.0)
    for j in range(size):
        a, c, start, multiplier = _group(w, GROUPS, j), _group(w, GROUPS + 4, j), _start(E, G, w, j), w[MULTIPLIER, j]
        products, others = axial_products(start, w[B, j]), (start.nn, start.ne, start.ee)
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
        a, c, start = _turn(w, A, j), _turn(w, C, j), _start(E, G, w, j)
        values, middle = (k2, w[END + 1, j], 0.0, 0.0, 0.0, 0.0), (0.0, 0.0, zeta, dzeta, 0.0, 0.0)
        at = equations(start, values, middle, a, c, b)
        newton = correction(at)
        last = is_last(start, k2, at, newton, b) & (b > start.b) & (w[ENDED, j] == RUNNING)
        w[ENDED, j] = CONVERGED if last else w[ENDED, j]
        a, c = corrected(a, newton), corrected(c, newton)
        w[A, j], w[A + 1, j], w[C, j], w[C + 1, j] = a.phi, a.y, c.phi, c.y
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
        first, second, third = softening(plastic, plastic.beta, E, G, 0.0)
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
        _turn(w, A, j),
        _turn(w, C, j),
        w[JACOBIAN, j],
        w[JACOBIAN + 1, j],
        w[JACOBIAN + 2, j],
        w[JACOBIAN + 3, j],
    )
    e = (E / 1.5 * w[STRAIN, j], G * w[STRAIN + 1, j], G * w[STRAIN + 2, j])
    n0, start = _vector(w, NORMAL, j), _start(E, G, w, j)
    plastic = end(Beginning(w[BETA, j], w[SLOPE, j], n0, e, start), local, 0.0, 0.0)
    pl = plastic.p
    w[START, j] += E * (w[STRAIN, j] - pl[0])
    w[START + 1, j] += G * (w[STRAIN + 1, j] - 2.0 * pl[1])
    w[START + 2, j] += G * (w[STRAIN + 2, j] - 2.0 * pl[2])
    for i in range(3):
        w[START + 3 + i, j] += zeta * pl[i]  # (3.1.8)
    w[START + 6, j] = b
    return plastic
