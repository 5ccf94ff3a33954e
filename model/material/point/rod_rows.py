"""The rod's law at many points, several at a time; `local_rows` says how."""

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
from coilset.model.material.point.rod import Beginning, Plastic, active, begin, end, inner, return_map, softening
from coilset.model.runtime.kernels import INLINE, KERNEL, njit

STATE = 7  # columns of a point's state
# Rows of the rod: stress, back stress and strain increment, which are given; σ of `rod.Beginning`; n₀.
STRESS, BACK, STRAIN = FORM, FORM + 3, FORM + 6
GIVEN = 9
SLOPE = FORM + GIVEN
NORMAL = SLOPE + 1
TRIAL = TANGENT = NORMAL  # the stress of the elastic trial; the tangent: not needed at the same time
ROWS = TANGENT + 9


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
    points, good = old.shape[0], True
    if alone(p) or old.shape[1] != STATE:
        for k in range(points):
            count[k] = one_point(p, old, de, k, new, tangent)
            good = good and count[k] >= 0
        return good
    E, G, _ = elasticity(p, 0.0)
    w, place = np.empty((ROWS, GROUP)), np.empty(GROUP, np.uint64)  # without sign, which numba would test
    for first in range(0, points, GROUP):
        size = min(GROUP, points - first)
        _trial(p, old, de, first, size, w)
        _elastic(E, G, first, size, with_tangent, w, new, tangent)
        flow, whole = gather(size, GIVEN, place, w)
        count[first : first + size] = 0
        if flow == 0:
            continue
        _begin(E, G, whole, w)
        iterations = solve_rows(p, E / 1.5, 2.0 * G, whole, w)
        _end(E, G, whole, with_tangent, w)
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
        for i in range(STATE - 1):
            w[STRESS + i, k] = old[first + k, i]
        w[WORK, k] = old[first + k, STATE - 1]
    harden(p, size, WORK, K2, w)
    for k in range(size):
        e1, e2, e3 = de[0, first + k], de[1, first + k], de[2, first + k]
        s1, s2, s3 = w[STRESS, k] + E * e1, w[STRESS + 1, k] + G * e2, w[STRESS + 2, k] + G * e3
        n = active((s1, s2, s3), _vector(w, BACK, k))
        w[STRAIN, k], w[STRAIN + 1, k], w[STRAIN + 2, k] = e1, e2, e3
        w[TRIAL, k], w[TRIAL + 1, k], w[TRIAL + 2, k] = s1, s2, s3
        w[FLOWS, k] = 0.0 if inner(n, n) <= w[K2, k] * (1.0 + 1e-12) else 1.0


@njit(**INLINE)
def _elastic(
    E: float,
    G: float,
    first: int,
    size: int,
    with_tangent: bool,
    w: np.ndarray,
    new: np.ndarray,
    tangent: np.ndarray,
) -> None:
    """Write the elastic response of a group."""
    if with_tangent:
        for i in range(9):
            modulus = 0.0 if i % 4 else E if i == 0 else G
            for k in range(size):
                tangent[i, first + k] = modulus
    for k in range(size):
        for i in range(3):
            new[first + k, i], new[first + k, 3 + i] = w[TRIAL + i, k], w[BACK + i, k]
        new[first + k, 6] = w[WORK, k]


@njit(**INLINE)
def _scatter(
    first: int, flow: int, with_tangent: bool, w: np.ndarray, place: np.ndarray, new: np.ndarray, tangent: np.ndarray
) -> None:
    """Write the results of the points that flow to their places."""
    for j in range(flow):
        k = np.uint64(first) + place[j]
        for i in range(STATE - 1):
            new[k, i] = w[STRESS + i, j]
        new[k, STATE - 1] = w[WORK, j]
        if with_tangent:
            for i in range(9):
                tangent[i, k] = w[TANGENT + i, j]


@njit(**INLINE)
def _vector(w: np.ndarray, row: int, j: int) -> tuple[float, float, float]:
    return (w[row, j], w[row + 1, j], w[row + 2, j])


@njit(**INLINE)
def _begin(E: float, G: float, size: int, w: np.ndarray) -> None:
    """Where the plastic part of the increment begins."""
    for j in range(size):
        n = active(_vector(w, STRESS, j), _vector(w, BACK, j))
        e = (E / 1.5 * w[STRAIN, j], G * w[STRAIN + 1, j], G * w[STRAIN + 2, j])
        beginning = begin(w[WORK, j], 0.0, E, G, n, e, w[K2, j])
        w[BETA, j], w[SLOPE, j] = beginning.beta, beginning.slope
        w[NORMAL, j], w[NORMAL + 1, j], w[NORMAL + 2, j] = beginning.n0[0], beginning.n0[1], beginning.n0[2]
        keep_start(beginning.start, w, j)


@njit(**INLINE)
def _end(E: float, G: float, size: int, with_tangent: bool, w: np.ndarray) -> None:
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
    local = local_of(w, j)
    e = (E / 1.5 * w[STRAIN, j], G * w[STRAIN + 1, j], G * w[STRAIN + 2, j])
    n0, start = _vector(w, NORMAL, j), start_of(E / 1.5, 2.0 * G, w, j)
    plastic = end(Beginning(w[BETA, j], w[SLOPE, j], n0, e, start), local)
    pl = plastic.p
    w[STRESS, j] += E * (w[STRAIN, j] - pl[0])
    w[STRESS + 1, j] += G * (w[STRAIN + 1, j] - 2.0 * pl[1])
    w[STRESS + 2, j] += G * (w[STRAIN + 2, j] - 2.0 * pl[2])
    for i in range(3):
        w[BACK + i, j] += local.zeta * pl[i]  # (3.1.8)
    w[WORK, j] = local.b
    return plastic
