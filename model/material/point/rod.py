"""The constitutive law of the rod: σ11, τ12, τ13 from ε11, γ12, γ13, with σ22 = σ33 = τ23 = 0 (5.2.32).

A point's state is a row of σ11, τ12, τ13, B11, B12, B13 (N/mm²), b* (N/mm²) and, where each point has its own, the
temperature (K); what stands behind stays. The active deviator is n11 = ⅔σ11 − B11, n1j = τ1j − B1j, and n:m = 3/2
n11 m11 + 2 n12 m12 + 2 n13 m13 (5.2.28).
"""

from collections import namedtuple

import numpy as np

from coilset.model.material.law.functions import TEMPERATURE, elasticity, functions
from coilset.model.material.point.local import Local, Start, solve, yield_crossing
from coilset.model.runtime.kernels import INLINE, KERNEL, njit

Vector = tuple[float, float, float]  # components 11, 12, 13
# Where the plastic part of an increment starts: elastic fraction β before it, σ = 1/n₀:e there, by which β
# follows n₀ and e (0 if it does not), n₀, e of the whole increment, and the Start.
Beginning = namedtuple("Beginning", "beta slope n0 whole start")
# The plastic part of an increment: β, σ, n₀ and e of the whole increment, e of the plastic part, n at its end, p, and
# m = 1/(c + ζ) by component.
Plastic = namedtuple("Plastic", "local beta slope n0 whole e n p m")


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
def begin(b: float, temperature: float, E: float, G: float, n0: Vector, e: Vector, k2: float) -> Beginning:
    """Where the plastic part starts: n₀ there (n0 + β e), with e reduced to it."""
    beta = yield_crossing(inner(n0, n0), inner(n0, e), inner(e, e), k2)
    n0 = (n0[0] + beta * e[0], n0[1] + beta * e[1], n0[2] + beta * e[2])
    crossing = inner(n0, e)
    slope = 1.0 / crossing if (beta > 0.0) & (crossing > 0.0) else 0.0
    rest = 1.0 - beta
    start = Start(
        b,
        temperature,
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
def return_map(
    p: np.ndarray, old: np.ndarray, de11: float, dg12: float, dg13: float, new: np.ndarray, C: np.ndarray
) -> int:
    """One increment of the rod's law, of second order (see `local`), with its consistent tangent.

    Args:
        p: parameter array of the law, `Law.parameters()`.
        old: the point's state at the start, shape (7,), or longer if the point has a temperature of its own; not
            written.
        de11, dg12, dg13: increments of ε11, γ12 = 2ε12, γ13.
        new: the state at the end; always fully written.
        C: d(σ11, τ12, τ13)/d(ε11, γ12, γ13), shape (3, 3), N/mm²; written.

    Returns:
        Number of local iterations, 0 for an elastic increment, -1 if there was no convergence (then `new` is `old`, C
        elastic).
    """
    temperature = old[7] if old.shape[0] > 7 else p[TEMPERATURE]
    E, G, _ = elasticity(p, temperature)
    s = (old[0] + E * de11, old[1] + G * dg12, old[2] + G * dg13)
    B = (old[3], old[4], old[5])
    for i in range(3):
        new[i] = s[i]
    for i in range(3, old.shape[0]):
        new[i] = old[i]
    C[:] = 0.0
    C[0, 0], C[1, 1], C[2, 2] = E, G, G
    values = functions(p, old[6], temperature)
    trial = active(s, B)
    if inner(trial, trial) <= values[0] * (1.0 + 1e-12):
        return 0
    e = (E * de11 / 1.5, G * dg12, G * dg13)
    beginning = begin(old[6], temperature, E, G, active((old[0], old[1], old[2]), B), e, values[0])
    local = solve(p, beginning.start, values)
    if local.iterations < 0:
        for i in range(3):
            new[i] = old[i]
        return local.iterations
    plastic = end(beginning, local)
    pl = plastic.p
    new[0] = s[0] - E * pl[0]
    new[1] = s[1] - 2.0 * G * pl[1]
    new[2] = s[2] - 2.0 * G * pl[2]
    for i in range(3):
        new[3 + i] = B[i] + local.zeta * pl[i]  # (3.1.8)
    new[6] = local.b
    taken = softening(plastic, E, G)
    for i in range(3):
        C[i, 0] -= taken[0][i] * (E / 1.5)
        C[i, 1] -= taken[1][i] * G
        C[i, 2] -= taken[2][i] * G
    return local.iterations
