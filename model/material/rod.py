"""The constitutive law of the rod: σ11, τ12, τ13 from ε11, γ12, γ13, with σ22 = σ33 = τ23 = 0 (5.2.32).

A point's state is a row of σ11, τ12, τ13, B11, B12, B13 (N/mm²), b* (N/mm²) and, with adiabatic heating, the
temperature (K). The active deviator is n11 = ⅔σ11 − B11, n1j = τ1j − B1j, and n:n = 3/2 n11² + 2 n12² + 2 n13²
(5.2.28).
"""

from collections import namedtuple

import numpy as np
from numba import njit

from coilset.model.material.functions import (
    CHANGE,
    EXPONENT,
    HEATING,
    SPIN,
    TEMPERATURE,
    Functions,
    elasticity,
    functions,
)
from coilset.model.material.kernel import INLINE, KERNEL
from coilset.model.material.local import Local, Start, surface, turn, yield_crossing
from coilset.model.material.perzyna import solve_at_rate
from coilset.model.material.spin import WHOLE, Crossing, Vector, spun

# Where the increment starts, and by columns how its spin changes that with ε11, γ12, γ13.
Point = namedtuple("Point", "stress back spin_stress spin_back")
NOTHING = (0.0, 0.0, 0.0)
# Where the plastic part of an increment starts: elastic fraction before it, n₀:e − ½Δk² there, n₀, e of the whole
# increment, and the Start.
Beginning = namedtuple("Beginning", "beta crossing n0 whole start")
# The plastic part of an increment: elastic fraction before it, n₀:e − ½Δk² where it starts, e of the whole increment
# and of the plastic part, n at its end, p, m = 1/(c + ζ) by component, and the Turns of both groups.
Plastic = namedtuple("Plastic", "local beta crossing n0 whole e n p m a c heating dea")
# Derivatives of b* (bn, be) and of Λ (ln, le) by n₀ and e, as factors of the inner product, and ∂n/∂b*, ∂n/∂Λ.
Gradients = namedtuple("Gradients", "bn be ln le db dl")


@njit(**INLINE)
def inner(a: Vector, b: Vector) -> float:
    """n:m of two deviators (5.2.28)."""
    return 1.5 * a[0] * b[0] + 2.0 * (a[1] * b[1] + a[2] * b[2])


@njit(**INLINE)
def active(s: Vector, b: Vector) -> Vector:
    """n of a stress and a back stress."""
    return (s[0] / 1.5 - b[0], s[1] - b[1], s[2] - b[2])


@njit(**INLINE)
def _crossing(s: Vector, B: Vector, k2: float, E: float, G: float, e: Vector) -> Crossing:
    """Where the elastic path leaves the yield surface; e is the increment of the active deviator."""
    n = active(s, B)
    nn, ne, ee = inner(n, n), inner(n, e), inner(e, e)
    if nn + 2.0 * ne + ee <= k2 * (1.0 + 1e-12):
        return WHOLE
    beta = yield_crossing(nn, ne, ee, k2)
    at = _add(n, _scaled(e, beta))
    slope = inner(at, e)
    if beta <= 0.0 or beta >= 1.0 or slope <= 0.0:
        return Crossing(beta, NOTHING)
    f = -beta / slope
    return Crossing(beta, (f * E * at[0], 2.0 * f * G * at[1], 2.0 * f * G * at[2]))


@njit(**INLINE)
def _start(
    p: np.ndarray, old: np.ndarray, k2: float, E: float, G: float, de11: float, dg12: float, dg13: float
) -> Point:
    """Stress and back stress from which Hooke's law gives the elastic response: those of `old`, or with its spin."""
    s, B = (old[0], old[1], old[2]), (old[3], old[4], old[5])
    if p[SPIN] == 0.0:
        nothing = (NOTHING, NOTHING, NOTHING)
        return Point(s, B, nothing, nothing)
    crossing = _crossing(s, B, k2, E, G, (E * de11 / 1.5, G * dg12, G * dg13))
    turned = spun(s, B, E, G, de11, dg12, dg13, crossing)
    return Point(turned.stress, turned.back, turned.d_stress, turned.d_back)


@njit(**KERNEL)
def return_map(
    p: np.ndarray, old: np.ndarray, de11: float, dg12: float, dg13: float, new: np.ndarray, C: np.ndarray
) -> int:
    """One increment of the rod's law, of second order (see `local`), with its consistent tangent.

    Args:
        p: parameter array of the law, `Law.parameters()`.
        old: the point's state at the start, shape (7,) or, with adiabatic heating, (8,); not written.
        de11, dg12, dg13: increments of ε11, γ12 = 2ε12, γ13.
        new: the state at the end; always fully written.
        C: d(σ11, τ12, τ13)/d(ε11, γ12, γ13), shape (3, 3), N/mm²; written.

    Returns:
        Number of local iterations, 0 for an elastic increment, -1 if there was no convergence, -2 if the point heated
        itself out of the material's table (then `new` is `old`, C elastic).
    """
    temperature = old[7] if old.shape[0] > 7 else p[TEMPERATURE]
    heating = p[HEATING] if old.shape[0] > 7 else 0.0
    E, G, alpha = elasticity(p, temperature - 0.5 * p[CHANGE])
    values = functions(p, old[6], temperature)
    point = _start(p, old, values[0], E, G, de11, dg12, dg13)
    s = (point.stress[0] + E * de11, point.stress[1] + G * dg12, point.stress[2] + G * dg13)
    _elastic(old, s, point, E, G, new, C)
    n0 = active(point.stress, point.back)
    trial = active(s, point.back)
    if inner(trial, trial) <= values[0] * (1.0 + 1e-12):
        return 0

    e = (E * de11 / 1.5, G * dg12, G * dg13)
    plastic = _plastic(p, old[6], temperature, heating, alpha, E, G, n0, e, values)
    local = plastic.local
    if local.iterations < 0:
        for i in range(new.shape[0]):
            new[i] = old[i]
        return local.iterations
    pl = plastic.p
    rise = plastic.heating * (local.b - old[6])
    new[0] = s[0] - E * (pl[0] + alpha * rise)
    new[1] = s[1] - 2.0 * G * pl[1]
    new[2] = s[2] - 2.0 * G * pl[2]
    for i in range(3):
        new[3 + i] = point.back[i] + local.zeta * pl[i]  # (3.1.8)
    new[6] = local.b
    if old.shape[0] > 7:
        new[7] = temperature + rise
    _tangent(plastic, point, E, G, alpha * plastic.heating, C)
    return local.iterations


@njit(**INLINE)
def _elastic(old: np.ndarray, s: Vector, point: Point, E: float, G: float, new: np.ndarray, C: np.ndarray) -> None:
    for i in range(3):
        new[i] = s[i]
        new[3 + i] = point.back[i]
    for i in range(6, old.shape[0]):
        new[i] = old[i]
    for i in range(3):
        C[i, 0] = point.spin_stress[0][i]
        C[i, 1] = point.spin_stress[1][i]
        C[i, 2] = point.spin_stress[2][i]
    C[0, 0] += E
    C[1, 1] += G
    C[2, 2] += G


@njit(**INLINE)
def _plastic(
    p: np.ndarray,
    b: float,
    temperature: float,
    heating: float,
    alpha: float,
    E: float,
    G: float,
    n0: Vector,
    e: Vector,
    values: Functions,
) -> Plastic:
    """Solve the plastic part: n and p at its end."""
    k2, growth = surface(p, b, temperature, values[0])
    outside = p[EXPONENT] > 0.0 and inner(n0, n0) > k2
    beginning = begin(b, temperature, heating, alpha, E, G, n0, e, k2, growth, outside)
    local = solve_at_rate(p, beginning.start, values)
    if local.neutral:
        heating = 0.0
    return end(beginning, local, heating, alpha * heating)


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
    rest = 1.0 - beta
    ca = E / 1.5
    start = Start(
        b, temperature, heating, ca, n0[0], rest * e[0], -ca * alpha * heating, 2.0 * G,
        2.0 * (n0[1] * n0[1] + n0[2] * n0[2]),
        2.0 * rest * (n0[1] * e[1] + n0[2] * e[2]),
        2.0 * rest * rest * (e[1] * e[1] + e[2] * e[2]),
    )  # fmt: skip
    return Beginning(beta, crossing, n0, e, start)


@njit(**INLINE)
def end(beginning: Beginning, local: Local, heating: float, expansion: float) -> Plastic:
    """n and p at the end of the plastic part; `expansion` is thermal strain per b*."""
    n0, e, start = beginning.n0, beginning.whole, beginning.start
    rest, dea = 1.0 - beginning.beta, -start.ca * expansion
    e = (rest * e[0] + dea * (local.b - start.b), rest * e[1], rest * e[2])
    a, c = turn(local.a, local.multiplier, local.neutral), turn(local.c, local.multiplier, local.neutral)
    ma, mc = 1.0 / (start.ca + local.zeta), 1.0 / (start.cc + local.zeta)
    m = (ma, mc, mc)
    n = _add(_times((a.phi, c.phi, c.phi), n0), _times((a.y, c.y, c.y), e))
    pl = _times(m, (n0[0] + e[0] - n[0], n0[1] + e[1] - n[1], n0[2] + e[2] - n[2]))
    return Plastic(local, beginning.beta, beginning.crossing, n0, beginning.whole, e, n, pl, m, a, c, heating, dea)


@njit(**INLINE)
def _add(a: Vector, b: Vector) -> Vector:
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


@njit(**INLINE)
def _times(a: Vector, b: Vector) -> Vector:
    return (a[0] * b[0], a[1] * b[1], a[2] * b[2])


@njit(**INLINE)
def _scaled(a: Vector, f: float) -> Vector:
    return (f * a[0], f * a[1], f * a[2])


@njit(**INLINE)
def _tangent(plastic: Plastic, point: Point, E: float, G: float, expansion: float, C: np.ndarray) -> None:
    """Subtract the effect of the plastic strain from the elastic tangent in C; `expansion` is thermal strain per b*."""
    axial = active(point.spin_stress[0], point.spin_back[0])
    first = active(point.spin_stress[1], point.spin_back[1])
    second = active(point.spin_stress[2], point.spin_back[2])
    taken = softening(plastic, axial, first, second, E, G, expansion)
    for i in range(3):
        C[i, 0] -= taken[0][i]
        C[i, 1] -= taken[1][i]
        C[i, 2] -= taken[2][i]


@njit(**INLINE)
def softening(
    plastic: Plastic, axial: Vector, first: Vector, second: Vector, E: float, G: float, expansion: float
) -> tuple[Vector, Vector, Vector]:
    """Reduction of the elastic tangent by the plastic strain, by columns.

    Args:
        plastic: the plastic part.
        axial, first, second: change of n₀ by ε11, γ12, γ13, where the material spins.
        E, G: moduli.
        expansion: thermal strain per b*.
    """
    gradients = _gradients(plastic)
    return (
        _stress(_sensitivity(plastic, gradients, axial, (E / 1.5, 0.0, 0.0)), E, G, expansion),
        _stress(_sensitivity(plastic, gradients, first, (0.0, G, 0.0)), E, G, expansion),
        _stress(_sensitivity(plastic, gradients, second, (0.0, 0.0, G)), E, G, expansion),
    )


@njit(**INLINE)
def _gradients(plastic: Plastic) -> Gradients:
    """How b* and Λ follow n₀ and e, so that the two local equations stay true, and how n follows b* and Λ."""
    local, n, p, m, e, n0 = plastic.local, plastic.n, plastic.p, plastic.m, plastic.e, plastic.n0
    a, c = plastic.a, plastic.c
    phi, y = _by_component(a.phi, c.phi), _by_component(a.y, c.y)
    db = _add(_times(_by_component(a.phi_b, c.phi_b), n0), _times(_by_component(a.y_b, c.y_b), e))
    db = (db[0] + a.y * plastic.dea, db[1], db[2])
    dl = _add(_times(_by_component(a.phi_l, c.phi_l), n0), _times(_by_component(a.y_l, c.y_l), e))
    r1n, r1e = _scaled(_times(phi, n), 2.0), _scaled(_times(y, n), 2.0)
    both = _times(m, _add(n0, n))
    # ½ (n₀ + n):p by n₀ and by e
    r2n = _add(_add(p, _times(phi, p)), _times(both, (1.0 - phi[0], 1.0 - phi[1], 1.0 - phi[2])))
    r2e = _add(_times(y, p), _times(both, (1.0 - y[0], 1.0 - y[1], 1.0 - y[2])))
    r2n, r2e = _scaled(r2n, 0.5), _scaled(r2e, 0.5)
    bn = _add(_scaled(r2n, -local.r1l), _scaled(r1n, -local.r2l))
    be = _add(_scaled(r2e, -local.r1l), _scaled(r1e, -local.r2l))
    ln = _add(_scaled(r2n, local.r1b), _scaled(r1n, local.r2b))
    le = _add(_scaled(r2e, local.r1b), _scaled(r1e, local.r2b))
    return Gradients(bn, be, ln, le, db, dl)


@njit(**INLINE)
def _by_component(a: float, c: float) -> Vector:
    """The factors of both groups at the components 11, 12, 13."""
    return (a, c, c)


@njit(**INLINE)
def _sensitivity(plastic: Plastic, g: Gradients, dn: Vector, de: Vector) -> tuple[Vector, float]:
    """Change of the plastic strain increment and of b* with the start n₀ (by `dn`) and with e (by `de`)."""
    trial = _add(dn, de)
    if plastic.beta > 0.0 and plastic.crossing > 0.0:
        dn = _add(dn, _scaled(de, plastic.beta))
        dbeta = -inner(plastic.n0, dn) / plastic.crossing  # of |n₀ + β e|² = k² + β Δk²
        dn = _add(dn, _scaled(plastic.whole, dbeta))
        de = _add(trial, _scaled(dn, -1.0))
    b = inner(g.bn, dn) + inner(g.be, de)
    multiplier = inner(g.ln, dn) + inner(g.le, de)
    phi, y = _by_component(plastic.a.phi, plastic.c.phi), _by_component(plastic.a.y, plastic.c.y)
    end = _add(_times(phi, dn), _times(y, de))
    end = _add(end, _add(_scaled(g.db, b), _scaled(g.dl, multiplier)))
    rest = _scaled(plastic.p, plastic.local.dzeta * b)
    trial = (trial[0] + plastic.dea * b, trial[1], trial[2])
    return _times(plastic.m, _add(trial, _scaled(_add(end, rest), -1.0))), b


@njit(**INLINE)
def _stress(change: tuple[Vector, float], E: float, G: float, expansion: float) -> Vector:
    """Change of the stress with the plastic strain and b*."""
    p, b = change
    return (E * (p[0] + expansion * b), 2.0 * G * p[1], 2.0 * G * p[2])
