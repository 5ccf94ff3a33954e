"""The plastic part of an increment of the rod's law: where it begins and ends, and its effect on the tangent.

Deviators are vectors of their components 11, 12, 13, and n:m = 3/2 n11 m11 + 2 n12 m12 + 2 n13 m13 (5.2.28).
"""

from collections import namedtuple

from numba import njit

from coilset.model.base.kernel import INLINE
from coilset.model.material.point.local import Local, Start, yield_crossing
from coilset.model.material.point.spin import Vector

# Where the plastic part of an increment starts: elastic fraction β before it, σ = 1/(n₀:e − ½Δk²) there, by which β
# follows n₀ and e (0 if it does not), n₀, e of the whole increment, and the Start.
Beginning = namedtuple("Beginning", "beta slope n0 whole start")
# The plastic part of an increment: β, σ, n₀ and e of the whole increment, e of the plastic part, n at its end, p, and
# m = 1/(c + ζ) by component.
Plastic = namedtuple("Plastic", "local beta slope n0 whole e n p m heating dea")


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
def begin(
    b: float,
    temperature: float,
    heating: float,
    alpha: float,
    E: float,
    G: float,
    n0: Vector,
    e: Vector,
    k2: float,
    growth: float,
    outside: bool,
) -> Beginning:
    """Where the plastic part starts: n₀ there (n0 + β e), with e reduced to it; at once if n0 is `outside` of k²."""
    ne = inner(n0, e) - 0.5 * growth
    ee = inner(e, e)
    beta = 0.0 if outside else yield_crossing(inner(n0, n0), ne, ee, k2)
    n0 = (n0[0] + beta * e[0], n0[1] + beta * e[1], n0[2] + beta * e[2])
    crossing = inner(n0, e) - 0.5 * growth
    slope = 1.0 / crossing if (beta > 0.0) & (crossing > 0.0) else 0.0
    rest = 1.0 - beta
    ca = E / 1.5
    start = Start(
        b,
        temperature,
        heating,
        ca,
        n0[0],
        rest * e[0],
        -ca * alpha * heating,
        2.0 * G,
        2.0 * (n0[1] * n0[1] + n0[2] * n0[2]),
        2.0 * rest * (n0[1] * e[1] + n0[2] * e[2]),
        2.0 * rest * rest * (e[1] * e[1] + e[2] * e[2]),
    )
    return Beginning(beta, slope, n0, e, start)


@njit(**INLINE)
def end(beginning: Beginning, local: Local, heating: float, expansion: float) -> Plastic:
    """n and p at the end of the plastic part; `expansion` is thermal strain per b*."""
    n0, e, start, a, c = beginning.n0, beginning.whole, beginning.start, local.a, local.c
    rest, dea = 1.0 - beginning.beta, -start.ca * expansion
    e = scaled(e, rest)
    if dea != 0.0:
        e = (e[0] + dea * (local.b - start.b), e[1], e[2])
    ma, mc = 1.0 / (start.ca + local.zeta), 1.0 / (start.cc + local.zeta)
    m = (ma, mc, mc)
    n = add(_times((a.phi, c.phi, c.phi), n0), _times((a.y, c.y, c.y), e))
    pl = _times(m, (n0[0] + e[0] - n[0], n0[1] + e[1] - n[1], n0[2] + e[2] - n[2]))
    return Plastic(local, beginning.beta, beginning.slope, n0, beginning.whole, e, n, pl, m, heating, dea)


@njit(**INLINE)
def softening(plastic: Plastic, share: float, E: float, G: float, expansion: float) -> tuple[Vector, Vector, Vector]:
    """Reduction of the stresses by the plastic strain, for each change of the three components of n₀ + e, by columns.

    Where a change v of the trial n₀ + e changes n₀ by sv before the crossing of the yield surface is sought, n₀ at the
    crossing changes by dn = s (v − σ (n₀:v) e), e of the whole increment and σ = 1/(n₀:e − ½Δk²). The two local
    equations stay true, and with d = φ − y the plastic strain follows by

        dp = m [(1 − y) v − d dn − (∂n/∂b* + p ∂ζ/∂b*) db* − ∂n/∂Λ dΛ],   db* = b:v + b′:dn,   dΛ = l:v + l′:dn,

    which is a diagonal and three dyads. Under neutral loading κ is in the place of Λ; thermal strain adds to what goes
    with db*.

    Args:
        plastic: the plastic part.
        share: s; β for a change of the increment, 1 for one of the stress and back stress from which it starts.
        E, G: moduli.
        expansion: thermal strain per b*.
    """
    local, a, c = plastic.local, plastic.local.a, plastic.local.c
    n0, n, e, p, m = plastic.n0, plastic.n, plastic.e, plastic.p, plastic.m
    y = _by_component(a.y, c.y)
    d = _by_component(a.phi - a.y, c.phi - c.y)
    both = _times(m, add(n0, n))
    q = _combined(1.0, p, -1.0, both)
    # n:n and ½ (n₀ + n):p by v and by dn
    square, square_0 = scaled(_times(y, n), 2.0), scaled(_times(d, n), 2.0)
    work, work_0 = scaled(add(both, _times(y, q)), 0.5), scaled(add(p, _times(d, q)), 0.5)
    b = _with_start(
        plastic,
        share,
        _combined(-local.r2l, square, -local.r1l, work),
        _combined(-local.r2l, square_0, -local.r1l, work_0),
    )
    l = _with_start(
        plastic, share, _combined(local.r2b, square, local.r1b, work), _combined(local.r2b, square_0, local.r1b, work_0)
    )
    by_b = add(_times(_by_component(a.phi_b, c.phi_b), n0), _times(_by_component(a.y_b, c.y_b), e))
    by_b = _combined(1.0, by_b, local.dzeta, p)
    if expansion != 0.0:
        by_b = (by_b[0] + (a.y - 1.0) * plastic.dea - expansion / m[0], by_b[1], by_b[2])
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
def _with_start(plastic: Plastic, share: float, trial: Vector, start: Vector) -> Vector:
    """g of g:v = `trial`:v + `start`:dn."""
    along = plastic.slope * inner(start, plastic.whole)
    return _combined(1.0, trial, share, _combined(1.0, start, -along, plastic.n0))


@njit(**INLINE)
def _dyads(weight: float, n: float, b: float, l: float, by_n: Vector, by_b: Vector, by_l: Vector) -> Vector:
    """A column of three dyads: their left vectors, each times the right one's component and its weight in n:m."""
    return add(scaled(by_n, weight * n), _combined(weight * b, by_b, weight * l, by_l))
