"""The law for the full stress state at many points, several at a time; `local_rows` says how."""

import numpy as np

from coilset.model.material.law.functions import elasticity
from coilset.model.material.point.local_rows import (
    BETA,
    CONVERGED,
    ENDED,
    FLOWS,
    FORM,
    GROUP,
    K2,
    WORK,
    alone,
    gather,
    harden,
    keep_start,
    local_of,
    solve_rows,
    start_of,
)
from coilset.model.material.point.solid import (
    Beginning,
    Loss,
    Six,
    active,
    begin,
    combined,
    elastic,
    elastic_deviator,
    hooke,
    inner,
    loss,
    plastic_strain,
    return_map,
    soften,
)
from coilset.model.runtime.kernels import INLINE, KERNEL, njit

STATE = 13  # columns of a point's state
# Rows of the full stress state: stress, back stress and strain increment, which are given; n₀; the `Loss`.
STRESS, BACK, STRAIN = FORM, FORM + 6, FORM + 12
GIVEN = 18
NORMAL = FORM + GIVEN
LOSS = NORMAL + 6
ROWS = LOSS + 5


@njit(**KERNEL)
def return_map_points(
    p: np.ndarray, old: np.ndarray, de: np.ndarray, new: np.ndarray, C: np.ndarray, count: np.ndarray
) -> bool:
    """One increment of the law for the full stress state at many points.

    Args:
        p: parameter array of the law.
        old: states at the start, shape (points, 13 or 14); not written.
        de: strain increments, engineering shear strains, shape (points, 6).
        new: states at the end; written.
        C: dσ/dε, shape (points, 6, 6), N/mm²; written.
        count: local iterations of each point as `solid.return_map` gives them, shape (points,); written.

    Returns:
        Whether the law found a solution at all points.
    """
    points, good = old.shape[0], True
    if alone(p) or old.shape[1] != STATE:
        for k in range(points):
            count[k] = one_point(p, old, de, k, new, C)
            good = good and count[k] >= 0
        return good
    E, G, _ = elasticity(p, 0.0)
    w, place = np.empty((ROWS, GROUP)), np.empty(GROUP, np.uint64)  # without sign, which numba would test
    for first in range(0, points, GROUP):
        size = min(GROUP, points - first)
        _trial(p, old, de, first, size, w, new)
        for k in range(first, first + size):
            hooke(E, G, C[k])
        flow, whole = gather(size, GIVEN, place, w)
        count[first : first + size] = 0
        if flow == 0:
            continue
        _begin(G, whole, w)
        iterations = solve_rows(p, 2.0 * G, 2.0 * G, whole, w)
        _end(E, G, whole, w)
        for j in range(flow):
            k = first + int(place[j])
            count[k] = iterations
            if w[ENDED, j] == CONVERGED:
                _write(G, w, j, new[k], C[k])
                continue
            count[k] = one_point(p, old, de, k, new, C)
            good = good and count[k] >= 0
    return good


@njit(**KERNEL)
def one_point(p: np.ndarray, old: np.ndarray, de: np.ndarray, k: int, new: np.ndarray, C: np.ndarray) -> int:
    """`return_map` at the point k; arguments as in `return_map_points`."""
    return return_map(p, old[k], de[k], new[k], C[k])


@njit(**INLINE)
def _six(w: np.ndarray, row: int, j: int) -> Six:
    return (w[row, j], w[row + 1, j], w[row + 2, j], w[row + 3, j], w[row + 4, j], w[row + 5, j])


@njit(**INLINE)
def _set(values: Six, w: np.ndarray, row: int, j: int) -> None:
    for i in range(6):
        w[row + i, j] = values[i]


@njit(**INLINE)
def _trial(
    p: np.ndarray, old: np.ndarray, de: np.ndarray, first: int, size: int, w: np.ndarray, new: np.ndarray
) -> None:
    """The elastic response of a group, written as if it were the state at the end, and which of its points flow."""
    E, G, _ = elasticity(p, 0.0)
    for k in range(size):
        for i in range(STATE - 1):
            w[STRESS + i, k] = old[first + k, i]
        w[WORK, k] = old[first + k, STATE - 1]
        for i in range(6):
            w[STRAIN + i, k] = de[first + k, i]
    harden(p, size, WORK, K2, w)
    for k in range(size):
        trial, B = elastic(_six(w, STRESS, k), _six(w, STRAIN, k), E, G), _six(w, BACK, k)
        n = active(trial, B)
        _set(trial, w, NORMAL, k)
        w[FLOWS, k] = 0.0 if inner(n, n) <= w[K2, k] * (1.0 + 1e-12) else 1.0
    for k in range(size):
        for i in range(6):
            new[first + k, i], new[first + k, 6 + i] = w[NORMAL + i, k], w[BACK + i, k]
        new[first + k, STATE - 1] = w[WORK, k]


@njit(**INLINE)
def _begin(G: float, size: int, w: np.ndarray) -> None:
    """Where the plastic part of the increment begins."""
    for j in range(size):
        n, e = active(_six(w, STRESS, j), _six(w, BACK, j)), elastic_deviator(_six(w, STRAIN, j), G)
        beginning = begin(w[WORK, j], 0.0, G, n, e, w[K2, j])
        w[BETA, j] = beginning.beta
        _set(beginning.n0, w, NORMAL, j)
        keep_start(beginning.start, w, j)


@njit(**INLINE)
def _end(E: float, G: float, size: int, w: np.ndarray) -> None:
    """Replace the initial states by the final ones, and write what the tangent loses."""
    for j in range(size):
        local, strain = local_of(w, j), _six(w, STRAIN, j)
        start = start_of(2.0 * G, 2.0 * G, w, j)
        beginning = Beginning(w[BETA, j], _six(w, NORMAL, j), elastic_deviator(strain, G), start)
        pl = plastic_strain(beginning, local)
        taken = loss(beginning, local)
        trial = elastic(_six(w, STRESS, j), strain, E, G)
        _set(combined(1.0, trial, -2.0 * G, pl), w, STRESS, j)
        _set(combined(1.0, _six(w, BACK, j), local.zeta, pl), w, BACK, j)  # (3.1.8)
        w[WORK, j] = local.b
        w[LOSS, j], w[LOSS + 1, j], w[LOSS + 2, j], w[LOSS + 3, j] = taken.identity, taken.nn, taken.ne, taken.en
        w[LOSS + 4, j] = taken.ee


@njit(**INLINE)
def _write(G: float, w: np.ndarray, j: int, new: np.ndarray, C: np.ndarray) -> None:
    """Write the state of a point that flows, and take off its tangent what it loses."""
    for i in range(STATE - 1):
        new[i] = w[STRESS + i, j]
    new[STATE - 1] = w[WORK, j]
    taken = Loss(w[LOSS, j], w[LOSS + 1, j], w[LOSS + 2, j], w[LOSS + 3, j], w[LOSS + 4, j])
    soften(taken, _six(w, NORMAL, j), elastic_deviator(_six(w, STRAIN, j), G), C)
