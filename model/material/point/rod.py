"""The constitutive law of the rod: σ11, τ12, τ13 from ε11, γ12, γ13, with σ22 = σ33 = τ23 = 0 (5.2.32).

A point's state is a row of σ11, τ12, τ13, B11, B12, B13 (N/mm²), b* (N/mm²) and, where each point has its own, the
temperature (K); what stands behind stays. The active deviator is n11 = ⅔σ11 − B11, n1j = τ1j − B1j, and n:m = 3/2
n11 m11 + 2 n12 m12 + 2 n13 m13 (5.2.28).
"""

from collections import namedtuple

import numpy as np

from coilset.model.material.point.local import Local, Start, yield_crossing
from coilset.model.material.point.local_rows import (
    BETA,
    ENDED,
    FLOWS,
    FORM,
    GROUP,
    K2,
    WORK,
    Points,
    gather,
    group_from,
    harden,
    keep_start,
    local_of,
    solve_rows,
    start_of,
)
from coilset.model.runtime.kernels import INLINE, KERNEL, njit

Vector = tuple[float, float, float]  # components 11, 12, 13
# Where the plastic part of an increment starts: elastic fraction β before it, σ = 1/n₀:e there, by which β
# follows n₀ and e (0 if it does not), n₀, e of the whole increment, and the Start.
Beginning = namedtuple("Beginning", "beta slope n0 whole start")
# The plastic part of an increment: β, σ, n₀ and e of the whole increment, e of the plastic part, n at its end, p, and
# m = 1/(c + ζ) by component.
Plastic = namedtuple("Plastic", "local beta slope n0 whole e n p m")

STATE = 7  # columns of a point's state
# Rows of the rod: stress, back stress and strain increment, which are given; σ of `rod.Beginning`; n₀.
STRESS, BACK, STRAIN = FORM, FORM + 3, FORM + 6
GIVEN = 9
SLOPE = FORM + GIVEN
NORMAL = SLOPE + 1
TRIAL = TANGENT = NORMAL  # the stress of the elastic trial; the tangent: not needed at the same time
ROWS = TANGENT + 9


@njit(**INLINE)
def inner(a: Vector, b: Vector) -> float:
    """n:m of two deviators (5.2.28)."""
    return 1.5 * a[0] * b[0] + 2.0 * (a[1] * b[1] + a[2] * b[2])


@njit(**INLINE)
def active(s: Vector, b: Vector) -> Vector:
    """n of a stress and a back stress."""
    return (s[0] / 1.5 - b[0], s[1] - b[1], s[2] - b[2])


@njit(**INLINE)
def add(a: Vector, b: Vector) -> Vector:
    """a + b."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


@njit(**INLINE)
def _times(a: Vector, b: Vector) -> Vector:
    return (a[0] * b[0], a[1] * b[1], a[2] * b[2])


@njit(**INLINE)
def scaled(a: Vector, f: float) -> Vector:
    """f a."""
    return (f * a[0], f * a[1], f * a[2])


@njit(**INLINE)
def _combined(f: float, a: Vector, g: float, b: Vector) -> Vector:
    """f a + g b."""
    return (f * a[0] + g * b[0], f * a[1] + g * b[1], f * a[2] + g * b[2])


@njit(**INLINE)
def begin(b: float, E: float, G: float, n0: Vector, e: Vector, k2: float) -> Beginning:
    """Where the plastic part starts: n₀ there (n0 + β e), with e reduced to it."""
    beta = yield_crossing(inner(n0, n0), inner(n0, e), inner(e, e), k2)
    n0 = (n0[0] + beta * e[0], n0[1] + beta * e[1], n0[2] + beta * e[2])
    crossing = inner(n0, e)
    slope = 1.0 / crossing if (beta > 0.0) & (crossing > 0.0) else 0.0
    rest = 1.0 - beta
    start = Start(
        b,
        E / 1.5,
        n0[0],
        rest * e[0],
        2.0 * G,
        2.0 * (n0[1] * n0[1] + n0[2] * n0[2]),
        2.0 * rest * (n0[1] * e[1] + n0[2] * e[2]),
        2.0 * rest * rest * (e[1] * e[1] + e[2] * e[2]),
    )
    return Beginning(beta, slope, n0, e, start)


@njit(**INLINE)
def end(beginning: Beginning, local: Local) -> Plastic:
    """n and p at the end of the plastic part."""
    n0, start, a, c = beginning.n0, beginning.start, local.a, local.c
    e = scaled(beginning.whole, 1.0 - beginning.beta)
    ma, mc = 1.0 / (start.ca + local.zeta), 1.0 / (start.cc + local.zeta)
    m = (ma, mc, mc)
    n = add(_times((a.phi, c.phi, c.phi), n0), _times((a.y, c.y, c.y), e))
    pl = _times(m, (n0[0] + e[0] - n[0], n0[1] + e[1] - n[1], n0[2] + e[2] - n[2]))
    return Plastic(local, beginning.beta, beginning.slope, n0, beginning.whole, e, n, pl, m)


@njit(**INLINE)
def softening(plastic: Plastic, E: float, G: float) -> tuple[Vector, Vector, Vector]:
    """Reduction of the stresses by the plastic strain, for each change of the three components of e, by columns.

    With a change v of e, n₀ at the crossing of the yield surface changes by dn = β (v − σ (n₀:v) e), e of the whole
    increment and σ = 1/n₀:e. The two local equations stay true, and with d = φ − y the plastic strain follows by

        dp = m [(1 − y) v − d dn − (∂n/∂b* + p ∂ζ/∂b*) db* − ∂n/∂Λ dΛ],   db* = b:v + b′:dn,   dΛ = l:v + l′:dn,

    which is a diagonal and three dyads. Under neutral loading κ is in the place of Λ.
    """
    local, a, c = plastic.local, plastic.local.a, plastic.local.c
    n0, n, e, p, m, share = plastic.n0, plastic.n, plastic.e, plastic.p, plastic.m, plastic.beta
    y = _by_component(a.y, c.y)
    d = _by_component(a.phi - a.y, c.phi - c.y)
    both = _times(m, add(n0, n))
    q = _combined(1.0, p, -1.0, both)
    # n:n and ½ (n₀ + n):p by v and by dn
    square, square_0 = scaled(_times(y, n), 2.0), scaled(_times(d, n), 2.0)
    work, work_0 = scaled(add(both, _times(y, q)), 0.5), scaled(add(p, _times(d, q)), 0.5)
    b = _with_start(
        plastic,
        _combined(-local.r2l, square, -local.r1l, work),
        _combined(-local.r2l, square_0, -local.r1l, work_0),
    )
    l = _with_start(
        plastic, _combined(local.r2b, square, local.r1b, work), _combined(local.r2b, square_0, local.r1b, work_0)
    )
    by_b = add(_times(_by_component(a.phi_b, c.phi_b), n0), _times(_by_component(a.y_b, c.y_b), e))
    by_b = _combined(1.0, by_b, local.dzeta, p)
    by_l = add(_times(_by_component(a.phi_l, c.phi_l), n0), _times(_by_component(a.y_l, c.y_l), e))
    by_n0 = scaled(_times(d, plastic.whole), -share * plastic.slope)
    modulus = (E * m[0], 2.0 * G * m[1], 2.0 * G * m[2])
    by_n0, by_b, by_l = _times(modulus, by_n0), _times(modulus, by_b), _times(modulus, by_l)
    same = _times(modulus, (1.0 - y[0] - share * d[0], 1.0 - y[1] - share * d[1], 1.0 - y[2] - share * d[2]))
    dyads = _dyads(1.5, n0[0], b[0], l[0], by_n0, by_b, by_l)
    first = (same[0] - dyads[0], -dyads[1], -dyads[2])
    dyads = _dyads(2.0, n0[1], b[1], l[1], by_n0, by_b, by_l)
    second = (-dyads[0], same[1] - dyads[1], -dyads[2])
    dyads = _dyads(2.0, n0[2], b[2], l[2], by_n0, by_b, by_l)
    return first, second, (-dyads[0], -dyads[1], same[2] - dyads[2])


@njit(**INLINE)
def _by_component(a: float, c: float) -> Vector:
    """The factors of both groups at the components 11, 12, 13."""
    return (a, c, c)


@njit(**INLINE)
def _with_start(plastic: Plastic, trial: Vector, start: Vector) -> Vector:
    """g of g:v = `trial`:v + `start`:dn."""
    along = plastic.slope * inner(start, plastic.whole)
    return _combined(1.0, trial, plastic.beta, _combined(1.0, start, -along, plastic.n0))


@njit(**INLINE)
def _dyads(weight: float, n: float, b: float, l: float, by_n: Vector, by_b: Vector, by_l: Vector) -> Vector:
    """A column of three dyads: their left vectors, each times the right one's component and its weight in n:m."""
    return add(scaled(by_n, weight * n), _combined(weight * b, by_b, weight * l, by_l))


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
        old: states at the start, shape (points, 7), or wider if each point has a temperature of its own; not written.
        de: increments of ε11, γ12, γ13, shape (3, points).
        new: states at the end; written.
        tangent: d(σ11, τ12, τ13)/d(ε11, γ12, γ13) by rows, shape (9, points), N/mm²; written if `with_tangent`.
        count: local iterations of each point, 0 if it stayed elastic, -1 if there was no convergence (then the state is
            that at the start), shape (points,); written.

    Returns:
        Whether the law found a solution at all points.
    """
    good, first = True, 0
    w, place = np.empty((ROWS, GROUP)), np.empty(GROUP, np.uint64)  # without sign, which numba would test
    new[:, STATE:] = old[:, STATE:]
    while first < old.shape[0]:
        of = group_from(p, old, first, STATE)
        _trial(p, of, old, de, w)
        _elastic(of, with_tangent, w, new, tangent)
        flow, whole = gather(of.size, GIVEN, place, w)
        first += of.size
        count[of.first : first] = 0
        if flow == 0:
            continue
        _begin(of.E, of.G, whole, w)
        solve_rows(p, of, of.E / 1.5, flow, whole, w)
        _end(of.E, of.G, whole, with_tangent, w)
        if not _scatter(of.first, flow, with_tangent, w, place, new, tangent, count):
            good = False
            for k in range(of.first, first):
                if count[k] < 0:
                    new[k] = old[k]
    return good


@njit(**INLINE)
def _trial(p: np.ndarray, of: Points, old: np.ndarray, de: np.ndarray, w: np.ndarray) -> None:
    """The elastic response of a group, and which of its points flow."""
    first, size, E, G = of.first, of.size, of.E, of.G
    for k in range(size):
        for i in range(STATE - 1):
            w[STRESS + i, k] = old[first + k, i]
        w[WORK, k] = old[first + k, STATE - 1]
    harden(p, of, size, WORK, K2, w)
    for k in range(size):
        e1, e2, e3 = de[0, first + k], de[1, first + k], de[2, first + k]
        s1, s2, s3 = w[STRESS, k] + E * e1, w[STRESS + 1, k] + G * e2, w[STRESS + 2, k] + G * e3
        n = active((s1, s2, s3), _vector(w, BACK, k))
        w[STRAIN, k], w[STRAIN + 1, k], w[STRAIN + 2, k] = e1, e2, e3
        w[TRIAL, k], w[TRIAL + 1, k], w[TRIAL + 2, k] = s1, s2, s3
        w[FLOWS, k] = 0.0 if inner(n, n) <= w[K2, k] * (1.0 + 1e-12) else 1.0


@njit(**INLINE)
def _elastic(of: Points, with_tangent: bool, w: np.ndarray, new: np.ndarray, tangent: np.ndarray) -> None:
    """Write the elastic response of a group."""
    first, size = of.first, of.size
    if with_tangent:
        for i in range(9):
            modulus = 0.0 if i % 4 else of.E if i == 0 else of.G
            for k in range(size):
                tangent[i, first + k] = modulus
    for k in range(size):
        for i in range(3):
            new[first + k, i], new[first + k, 3 + i] = w[TRIAL + i, k], w[BACK + i, k]
        new[first + k, 6] = w[WORK, k]


@njit(**INLINE)
def _scatter(
    first: int,
    flow: int,
    with_tangent: bool,
    w: np.ndarray,
    place: np.ndarray,
    new: np.ndarray,
    tangent: np.ndarray,
    count: np.ndarray,
) -> bool:
    """Write the results of the points that flow to their places; whether all have converged."""
    good = True
    for j in range(flow):
        k = np.uint64(first) + place[j]
        count[k] = int(w[ENDED, j])
        for i in range(STATE - 1):
            new[k, i] = w[STRESS + i, j]
        new[k, STATE - 1] = w[WORK, j]
        if with_tangent:
            for i in range(9):
                tangent[i, k] = w[TANGENT + i, j]
        good = good and w[ENDED, j] > 0.0
    return good


@njit(**INLINE)
def _vector(w: np.ndarray, row: int, j: int) -> Vector:
    return (w[row, j], w[row + 1, j], w[row + 2, j])


@njit(**INLINE)
def _begin(E: float, G: float, size: int, w: np.ndarray) -> None:
    """Where the plastic part of the increment begins."""
    for j in range(size):
        n = active(_vector(w, STRESS, j), _vector(w, BACK, j))
        e = (E / 1.5 * w[STRAIN, j], G * w[STRAIN + 1, j], G * w[STRAIN + 2, j])
        beginning = begin(w[WORK, j], E, G, n, e, w[K2, j])
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
