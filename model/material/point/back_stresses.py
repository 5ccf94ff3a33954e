"""Several back stresses that saturate, after Chaboche: one increment at a point, with its consistent tangent.

With n = T − Σ Bᵢ on the yield surface n:n = k²(b*), flow along n, D_pl = λ n, and the plastic strain's length
ṗ = √(⅔ D_pl:D_pl) = √⅔ λ k,

    Ḃᵢ = ⅔ Cᵢ D_pl − γᵢ Bᵢ ṗ          (J. L. Chaboche, Int. J. Plasticity 5 (1989) 247, after Armstrong and Frederick).

In tension a back stress tends to the uniaxial Cᵢ/γᵢ; with γᵢ = 0 it is Prager's, ζ = ⅔ Cᵢ. Several of them with
different γᵢ give the roundness of a reversed curve from first yield to its far end.

In time the two stages of an L-stable diagonally implicit Runge-Kutta method of second order follow each other
(Alexander, SIAM J. Numer. Anal. 14, 1977), as for creep; each is a step of backward Euler from a start T*, B*, b* with
a part e of the elastic increment of T, on the yield surface at its end:

    n (1 + (c + Σ θᵢ ⅔Cᵢ) Λ) = T* + e − Σ θᵢ Bᵢ*,   θᵢ = 1/(1 + γᵢ q),   Λ = (b − b*)/k²,   q = √⅔ (b − b*)/k,

since b − b* = Λ n:n. So there is one equation, |n| = k(b), for the plastic work b at the end. c is the modulus of T's
component: 2G, and ⅔E of the rod's axial one.

A point's state is that of `rod` or `solid` with the sum of all back stresses in the place of B; behind it stand all of
them but the last.
"""

import math
from collections import namedtuple

import numpy as np
from numba import njit

from coilset.model.base.kernel import INLINE, KERNEL
from coilset.model.material.law.functions import TEMPERATURE, elasticity, functions
from coilset.model.material.law.terms import BackStresses
from coilset.model.material.point.local import FAILED, MAX_ITERATIONS, yield_crossing

# The stage's answer at b: |n| − k and its slope, Λ and q with their slopes in b.
Stage = namedtuple("Stage", "off slope multiplier d_multiplier length d_length k2")

GAMMA = 1.0 - math.sqrt(0.5)
PRECISION = 1e-13  # of |n| − k, over k
TWO_THIRDS = math.sqrt(2.0 / 3.0)
ROD = 3  # components


@njit(**KERNEL)
def back_stress_map(law: BackStresses, old: np.ndarray, de: np.ndarray, new: np.ndarray, C: np.ndarray) -> int:
    """One increment of strain.

    Args:
        law: BackStresses.
        old: the point's state at the start; not written.
        de: strain increment, shape (3,) as in `rod` or (6,) as in `solid`, engineering shear strains.
        new: the state at the end; written.
        C: dσ/dε, shape (3, 3) or (6, 6), N/mm²; written.

    Returns:
        Number of local iterations, 0 for an elastic increment, -1 if there was no convergence (then `new` is `old`).
    """
    p, terms, n = law.plastic, law.terms, de.shape[0]
    size = terms.shape[0]
    w, c, e, unit = np.empty(n), np.empty(n), np.empty(n), np.zeros((n, n))
    _elastic(p, old, de, new, C, w, c, e, unit)
    # rows: T, the Bᵢ, and b in the last one's first place; behind them their slopes by the strains
    start, slopes = np.zeros((size + 2, n)), np.zeros((size + 2, n, n))
    _unpack(old, start)
    active = np.empty(n)
    for j in range(n):
        active[j] = start[0, j]
        for i in range(size):
            active[j] -= start[1 + i, j]
    nn, ne, ee = _inner(w, active, active), _inner(w, active, e), _inner(w, e, e)
    k2 = functions(p, old[2 * n], p[TEMPERATURE])[0]
    if nn + 2.0 * ne + ee <= k2 * (1.0 + 1e-12):
        return 0
    beta = yield_crossing(nn, ne, ee, k2)
    for j in range(n):
        active[j] += beta * e[j]
    crossing = _inner(w, active, e)
    rest, d_rest = np.empty(n), np.empty((n, n))
    for j in range(n):
        start[0, j] += beta * e[j]
        rest[j] = (1.0 - beta) * e[j]
        d_beta = -beta * _inner(w, active, unit[j]) / crossing if beta > 0.0 and crossing > 0.0 else 0.0
        for i in range(n):
            slopes[0, i, j] = beta * unit[i, j] + d_beta * e[i]
            d_rest[i, j] = unit[i, j] - slopes[0, i, j]
    end, d_end = start.copy(), slopes.copy()
    active, change = np.empty((2, n)), np.empty((2, n))
    count = _stage(p, terms, w, c, GAMMA, rest, d_rest, end, d_end, active, change)
    if count > 0:
        _lead(start, end)
        _lead(slopes, d_end)
        more = _stage(p, terms, w, c, GAMMA, rest, d_rest, end, d_end, active, change)
        if more <= 0:  # the second stage's start lies within the surface: one step of backward Euler
            end[:], d_end[:] = start, slopes
            more = _stage(p, terms, w, c, 1.0, rest, d_rest, end, d_end, active, change)
        count = count + more if more > 0 else FAILED
    if count <= 0:
        new[:] = old
        return FAILED
    for j in range(n):
        rest[j] += start[0, j]
    _pack(rest, end, d_end, unit, new, C)
    return count


@njit(**INLINE)
def _lead(start: np.ndarray, end: np.ndarray) -> None:
    """Where the rates of the first stage's end lead in the time before the second one, in the place of that end."""
    a, b = start.reshape(-1), end.reshape(-1)
    for i in range(a.shape[0]):
        b[i] = a[i] + (1.0 - GAMMA) / GAMMA * (b[i] - a[i])


@njit(**INLINE)
def _inner(w: np.ndarray, a: np.ndarray, b: np.ndarray) -> float:
    """a:b of two deviators; w are the metric's weights."""
    total = 0.0
    for i in range(w.shape[0]):
        total += w[i] * a[i] * b[i]
    return total


@njit(**KERNEL)
def _elastic(
    p: np.ndarray,
    old: np.ndarray,
    de: np.ndarray,
    new: np.ndarray,
    C: np.ndarray,
    w: np.ndarray,
    c: np.ndarray,
    e: np.ndarray,
    unit: np.ndarray,
) -> None:
    """Write the elastic answer, the metric w, the moduli c, the increment e of T, and its slopes by the strains."""
    E, G, _ = elasticity(p, p[TEMPERATURE])
    n = de.shape[0]
    new[:] = old
    C[:] = 0.0
    w[:], c[:] = 2.0, 2.0 * G
    if n == ROD:
        w[0], c[0] = 1.5, E / 1.5
        unit[0, 0], C[0, 0] = E / 1.5, E
    else:
        w[:3] = 1.0
        bulk = E * G / (3.0 * (3.0 * G - E))
        for i in range(3):
            for j in range(3):
                unit[i, j] = -2.0 * G / 3.0
                C[i, j] = bulk - 2.0 * G / 3.0
            unit[i, i] += 2.0 * G
            C[i, i] += 2.0 * G
    for i in range(n - (2 if n == ROD else 3), n):
        unit[i, i] = C[i, i] = G
    for i in range(n):
        e[i] = 0.0
        for j in range(n):
            e[i] += unit[i, j] * de[j]
            new[i] += C[i, j] * de[j]


@njit(**KERNEL)
def _unpack(state: np.ndarray, rows: np.ndarray) -> None:
    """Write T, the Bᵢ and b of a point's state."""
    n, last = rows.shape[1], rows.shape[0] - 2
    mean = state[0] / 3.0 if n == ROD else (state[0] + state[1] + state[2]) / 3.0
    for j in range(n):
        rows[0, j] = state[j] - (mean if j < (1 if n == ROD else 3) else 0.0)
        rows[last, j] = state[n + j]
        for i in range(last - 1):
            rows[1 + i, j] = state[2 * n + 1 + n * i + j]
            rows[last, j] -= rows[1 + i, j]
    rows[last + 1, 0] = state[2 * n]


@njit(**KERNEL)
def _pack(
    trial: np.ndarray,
    rows: np.ndarray,
    slopes: np.ndarray,
    unit: np.ndarray,
    new: np.ndarray,
    C: np.ndarray,
) -> None:
    """Put T, the Bᵢ and b into the point's state, whose stress is the elastic answer, and their slopes into C."""
    n, last = rows.shape[1], rows.shape[0] - 2
    for j in range(n):
        scale = 1.5 if n == ROD and j == 0 else 1.0
        new[j] += scale * (rows[0, j] - trial[j])
        for k in range(n):
            C[j, k] += scale * (slopes[0, j, k] - unit[j, k])
        new[n + j] = 0.0
        for i in range(last):
            new[n + j] += rows[1 + i, j]
            if i < last - 1:
                new[2 * n + 1 + n * i + j] = rows[1 + i, j]
    new[2 * n] = rows[last + 1, 0]


@njit(**KERNEL)
def _stage(
    p: np.ndarray,
    terms: np.ndarray,
    w: np.ndarray,
    c: np.ndarray,
    part: float,
    e: np.ndarray,
    d_e: np.ndarray,
    rows: np.ndarray,
    slopes: np.ndarray,
    active: np.ndarray,
    change: np.ndarray,
) -> int:
    """One step of backward Euler with a part of the elastic increment e.

    Args:
        rows: T*, Bᵢ*, b* at the start, overwritten by those at the end.
        slopes: by the strains, likewise; d_e: those of e.
        active, change: room for n and its slope in b, and more, shape (2, n).

    Returns:
        Number of iterations; 0 if the trial state lies within the surface, -1 if there is no solution.
    """
    n, size = w.shape[0], terms.shape[0]
    b0, b = rows[size + 1, 0], rows[size + 1, 0]
    for j in range(n):
        rows[0, j] += part * e[j]
        for k in range(n):
            slopes[0, j, k] += part * d_e[j, k]
    at = _equation(p, terms, w, c, rows, b0, b, active)
    if at.off <= 0.0:
        return 0
    low, high, iteration = b0, math.inf, 0
    while abs(at.off) > PRECISION * math.sqrt(at.k2):
        iteration += 1
        if iteration > MAX_ITERATIONS:
            return FAILED
        low, high = (b, high) if at.off > 0.0 else (low, b)
        to = b - at.off / at.slope if at.slope < 0.0 else math.inf
        if not low < to < high:
            to = 0.5 * (low + high) if high < math.inf else 2.0 * b - b0 + 1e-3 * math.sqrt(at.k2)
        if to == b:
            break
        b = to
        at = _equation(p, terms, w, c, rows, b0, b, active)
    _slopes(terms, w, c, rows, at, active, change, slopes)
    for j in range(n):
        flow = at.multiplier * active[0, j]
        rows[0, j] -= c[j] * flow
        for i in range(size):
            rows[1 + i, j] = (rows[1 + i, j] + terms[i, 0] * flow) / (1.0 + terms[i, 1] * at.length)
    rows[size + 1, 0] = b
    return max(iteration, 1)


@njit(**KERNEL)
def _equation(
    p: np.ndarray,
    terms: np.ndarray,
    w: np.ndarray,
    c: np.ndarray,
    rows: np.ndarray,
    b0: float,
    b: float,
    active: np.ndarray,
) -> Stage:
    """|n| − k at the plastic work b; n and its slope in b are written into `active`."""
    k2, dk2 = functions(p, b, p[TEMPERATURE])[:2]
    k = math.sqrt(k2)
    multiplier, length = (b - b0) / k2, TWO_THIRDS * (b - b0) / k
    d_multiplier, d_length = (1.0 - multiplier * dk2) / k2, TWO_THIRDS / k - 0.5 * length * dk2 / k2
    n, zeta, d_zeta = w.shape[0], 0.0, 0.0
    for j in range(n):
        active[0, j], active[1, j] = rows[0, j], 0.0
    for i in range(terms.shape[0]):
        theta = 1.0 / (1.0 + terms[i, 1] * length)
        d_theta = -terms[i, 1] * theta * theta * d_length
        zeta += terms[i, 0] * theta
        d_zeta += terms[i, 0] * d_theta
        for j in range(n):
            active[0, j] -= theta * rows[1 + i, j]
            active[1, j] -= d_theta * rows[1 + i, j]
    nn = nd = 0.0
    for j in range(n):
        inverse = 1.0 / (1.0 + (c[j] + zeta) * multiplier)
        value = active[0, j] * inverse
        slope = (active[1, j] - value * ((c[j] + zeta) * d_multiplier + d_zeta * multiplier)) * inverse
        nn += w[j] * value * value
        nd += w[j] * value * slope
        active[0, j], active[1, j] = value, slope
    size = math.sqrt(nn)
    return Stage(size - k, nd / size - 0.5 * dk2 / k, multiplier, d_multiplier, length, d_length, k2)


@njit(**KERNEL)
def _slopes(
    terms: np.ndarray,
    w: np.ndarray,
    c: np.ndarray,
    rows: np.ndarray,
    at: Stage,
    active: np.ndarray,
    change: np.ndarray,
    slopes: np.ndarray,
) -> None:
    """Bring the slopes of the start, T + e among them, to the end of a stage; `rows` are still those of the start."""
    n, size, k = w.shape[0], terms.shape[0], math.sqrt(at.k2)
    # Λ, q and the θ change with b* at fixed b, too: by change[1] n does
    multiplier0, length0 = -1.0 / at.k2, -TWO_THIRDS / k
    zeta, zeta0 = 0.0, 0.0
    for j in range(n):
        change[1, j] = 0.0
    for i in range(size):
        theta = 1.0 / (1.0 + terms[i, 1] * at.length)
        theta0 = -terms[i, 1] * theta * theta * length0
        zeta += terms[i, 0] * theta
        zeta0 += terms[i, 0] * theta0
        for j in range(n):
            change[1, j] -= theta0 * rows[1 + i, j]
    for j in range(n):
        change[1, j] -= active[0, j] * ((c[j] + zeta) * multiplier0 + zeta0 * at.multiplier)
    for j in range(n):
        db0, along = slopes[size + 1, 0, j], 0.0
        for a in range(n):
            change[0, a] = slopes[0, a, j] + db0 * change[1, a]
        for i in range(size):
            theta = 1.0 / (1.0 + terms[i, 1] * at.length)
            for a in range(n):
                change[0, a] -= theta * slopes[1 + i, a, j]
        for a in range(n):
            change[0, a] /= 1.0 + (c[a] + zeta) * at.multiplier
            along += w[a] * active[0, a] * change[0, a]
        db = -along / (k * at.slope)
        d_multiplier, d_length = at.d_multiplier * db + multiplier0 * db0, at.d_length * db + length0 * db0
        for a in range(n):  # of Λ n
            change[0, a] = d_multiplier * active[0, a] + at.multiplier * (change[0, a] + active[1, a] * db)
            slopes[0, a, j] -= c[a] * change[0, a]
        for i in range(size):
            theta = 1.0 / (1.0 + terms[i, 1] * at.length)
            for a in range(n):
                end = theta * (rows[1 + i, a] + terms[i, 0] * at.multiplier * active[0, a])
                rest = terms[i, 0] * change[0, a] - terms[i, 1] * d_length * end
                slopes[1 + i, a, j] = theta * (slopes[1 + i, a, j] + rest)
        slopes[size + 1, 0, j] = db
