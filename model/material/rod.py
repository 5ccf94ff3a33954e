"""The constitutive law of the rod: σ11, τ12, τ13 from ε11, γ12, γ13, with σ22 = σ33 = τ23 = 0 (5.2.32).

A point's history row is σ11, τ12, τ13, B11, B12, B13 (N/mm²), b* (N/mm²) and, with adiabatic heating, the temperature (K).
The active deviator is n11 = ⅔σ11 − B11, n1j = τ1j − B1j, and n:n = 3/2 n11² + 2 n12² + 2 n13² (5.2.28).
"""

from collections import namedtuple

from numba import njit

from coilset.model.material.functions import HEATING, SPIN, TEMPERATURE, elasticity, functions
from coilset.model.material.local import Start, solve, yield_crossing

# Tuples of three are the components 11, 12, 13.
Point = namedtuple("Point", "stress back spin_stress spin_back")
# The plastic part of an increment: elastic fraction before it, n₀:e where it starts, e of the whole increment, n at its end, p; u = 1/(1 + sΛ), m = 1/(c + ζ) and db = ∂n/∂b*, dl = ∂n/∂Λ (neutral: ∂n/∂κ) by component.
Plastic = namedtuple("Plastic", "local beta crossing n0 whole n p u m x db dl heating dea")


@njit(cache=True, error_model="numpy")
def _inner(a, b):
    """n:m of two deviators (5.2.28)."""
    return 1.5 * a[0] * b[0] + 2.0 * (a[1] * b[1] + a[2] * b[2])


@njit(cache=True, error_model="numpy")
def spin_rates(s, b):
    """Changes of σ (or, for B, of B) per γ12 and per γ13 by the spin w1j = −½γ1j, (5.2.33).

    Args:
        s: components 11, 12, 13.
        b: what stands for σ11 in the shear rows: σ11 itself, or B11 − B22 = 3/2 B11.
    """
    return (-s[1], 0.5 * b, 0.0), (-s[2], 0.0, 0.5 * b)


@njit(cache=True, error_model="numpy")
def _turned(p, old, dg12, dg13):
    """Stress and back stress of `old` after the increment's spin, and what the spin adds per unit of γ12, γ13."""
    s = (old[0], old[1], old[2])
    b = (old[3], old[4], old[5])
    nothing = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    if p[SPIN] == 0.0:
        return Point(s, b, nothing, nothing)
    ds = spin_rates(s, s[0])
    db = spin_rates(b, 1.5 * b[0])
    return Point(
        (s[0] + dg12 * ds[0][0] + dg13 * ds[1][0], s[1] + dg12 * ds[0][1], s[2] + dg13 * ds[1][2]),
        (b[0] + dg12 * db[0][0] + dg13 * db[1][0], b[1] + dg12 * db[0][1], b[2] + dg13 * db[1][2]),
        ds,
        db,
    )


@njit(cache=True, error_model="numpy")
def _active(s, b):
    return (s[0] / 1.5 - b[0], s[1] - b[1], s[2] - b[2])


@njit(cache=True, error_model="numpy")
def return_map(p, old, de11, dg12, dg13, new, C):
    """Backward Euler step of the rod's law with its consistent tangent.

    Args:
        p: parameter array of the law, `Law.parameters()`.
        old: history row at the start, shape (7,) or, with adiabatic heating, (8,); not written.
        de11, dg12, dg13: increments of ε11, γ12 = 2ε12, γ13.
        new: history row at the end; always fully written.
        C: d(σ11, τ12, τ13)/d(ε11, γ12, γ13), shape (3, 3), N/mm²; written.

    Returns:
        Number of local iterations, 0 for an elastic increment, -1 if there was no convergence (then `new` is `old`, C elastic).
    """
    temperature = old[7] if old.shape[0] > 7 else p[TEMPERATURE]
    heating = p[HEATING] if old.shape[0] > 7 else 0.0
    E, G, alpha = elasticity(p, temperature)
    point = _turned(p, old, dg12, dg13)
    s = (point.stress[0] + E * de11, point.stress[1] + G * dg12, point.stress[2] + G * dg13)
    _elastic(old, s, point, E, G, new, C)
    n0 = _active(point.stress, point.back)
    trial = _active(s, point.back)
    values = functions(p, old[6], temperature)
    if _inner(trial, trial) <= values[0] * (1.0 + 1e-12):
        return 0

    e = (E * de11 / 1.5, G * dg12, G * dg13)
    plastic = _plastic(p, old[6], temperature, heating, alpha, E, G, n0, e, values)
    local = plastic.local
    if local.iterations < 0:
        for i in range(new.shape[0]):
            new[i] = old[i]
        return -1
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


@njit(cache=True, error_model="numpy")
def _elastic(old, s, point, E, G, new, C):
    for i in range(3):
        new[i] = s[i]
        new[3 + i] = point.back[i]
    for i in range(6, old.shape[0]):
        new[i] = old[i]
    for i in range(3):
        C[i, 0] = 0.0
        C[i, 1] = point.spin_stress[0][i]
        C[i, 2] = point.spin_stress[1][i]
    C[0, 0] += E
    C[1, 1] += G
    C[2, 2] += G


@njit(cache=True, error_model="numpy")
def _plastic(p, b, temperature, heating, alpha, E, G, n0, e, values):
    """Solve the plastic part: n and p at its end, from n₀ where it starts (n0 + β e) with e reduced to it."""
    ne = _inner(n0, e)
    ee = _inner(e, e)
    beta = yield_crossing(_inner(n0, n0), ne, ee, values[0])
    n0 = (n0[0] + beta * e[0], n0[1] + beta * e[1], n0[2] + beta * e[2])
    crossing = _inner(n0, e)
    rest = 1.0 - beta
    ca = E / 1.5
    cc = 2.0 * G
    dea = -ca * alpha * heating
    local = solve(p, Start(
        b, temperature, heating, ca, n0[0], rest * e[0], dea, cc,
        2.0 * (n0[1] * n0[1] + n0[2] * n0[2]),
        2.0 * rest * (n0[1] * e[1] + n0[2] * e[2]),
        2.0 * rest * rest * (e[1] * e[1] + e[2] * e[2]),
    ), values)  # fmt: skip
    if local.neutral:
        heating, dea = 0.0, 0.0
    whole = e
    e = (rest * e[0] + dea * (local.b - b), rest * e[1], rest * e[2])
    a, c, multiplier = local.a, local.c, local.multiplier
    x = (a.x, c.x, c.x)
    ua, uc = 1.0 / (1.0 + a.s * multiplier), 1.0 / (1.0 + c.s * multiplier)
    u = (ua, uc, uc)
    ma, mc = 1.0 / (ca + local.zeta), 1.0 / (cc + local.zeta)
    m = (ma, mc, mc)
    n = _times(u, _add(n0, _times(x, e)))
    pl = _times(m, (n0[0] + e[0] - n[0], n0[1] + e[1] - n[1], n0[2] + e[2] - n[2]))
    db = (ua * (a.dx * e[0] + a.x * dea - n[0] * a.ds * multiplier),
          uc * (c.dx * e[1] - n[1] * c.ds * multiplier), uc * (c.dx * e[2] - n[2] * c.ds * multiplier))  # fmt: skip
    if local.neutral:  # ∂n/∂κ
        dxa, dxc = -a.x * a.s, -c.x * c.s
        dl = (dxa * e[0], dxc * e[1], dxc * e[2])
    else:
        dl = (-ua * a.s * n[0], -uc * c.s * n[1], -uc * c.s * n[2])
    return Plastic(local, beta, crossing, n0, whole, n, pl, u, m, x, db, dl, heating, dea)


@njit(cache=True, error_model="numpy")
def _add(a, b):
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


@njit(cache=True, error_model="numpy")
def _times(a, b):
    return (a[0] * b[0], a[1] * b[1], a[2] * b[2])


@njit(cache=True, error_model="numpy")
def _scaled(a, f):
    return (f * a[0], f * a[1], f * a[2])


@njit(cache=True, error_model="numpy")
def _sensitivity(plastic, dn, de):
    """Change of the plastic strain increment and of b* with the start n₀ (by `dn`) and with e (by `de`)."""
    local, beta, n, m = plastic.local, plastic.beta, plastic.n, plastic.m
    start = _add(dn, _scaled(de, beta))
    rest = _scaled(de, 1.0 - beta)
    if beta > 0.0 and plastic.crossing > 0.0:
        dbeta = -_inner(plastic.n0, start) / plastic.crossing  # of |n₀ + β e|² = k²
        start = _add(start, _scaled(plastic.whole, dbeta))
        rest = _add(rest, _scaled(plastic.whole, -dbeta))
    # First at fixed b* and Λ, then with the change of both that keeps the two local equations.
    a = _times(plastic.u, _add(start, _times(plastic.x, rest)))
    trial = _add(start, rest)
    r1 = 2.0 * _inner(n, a)
    r2 = -_inner(a, plastic.p) - _inner(n, _times(m, _add(trial, _scaled(a, -1.0))))
    det = local.r1b * local.r2l - local.r1l * local.r2b
    b = (local.r1l * r2 - local.r2l * r1) / det
    multiplier = (local.r2b * r1 - local.r1b * r2) / det
    end = _add(a, _add(_scaled(plastic.db, b), _scaled(plastic.dl, multiplier)))
    p = _add(trial, _scaled(end, -1.0))
    p = _add(p, _scaled(plastic.p, -local.dzeta * b))
    return _times(m, (p[0] + plastic.dea * b, p[1], p[2])), b


@njit(cache=True, error_model="numpy")
def _tangent(plastic, point, E, G, expansion, C):
    """Subtract from the elastic tangent in C what the plastic strain takes; `expansion` is thermal strain per b*."""
    zero = (0.0, 0.0, 0.0)
    _subtract(_sensitivity(plastic, zero, (E / 1.5, 0.0, 0.0)), 0, E, G, expansion, C)
    start = _active(point.spin_stress[0], point.spin_back[0])
    _subtract(_sensitivity(plastic, start, (0.0, G, 0.0)), 1, E, G, expansion, C)
    start = _active(point.spin_stress[1], point.spin_back[1])
    _subtract(_sensitivity(plastic, start, (0.0, 0.0, G)), 2, E, G, expansion, C)


@njit(cache=True, error_model="numpy")
def _subtract(change, j, E, G, expansion, C):
    p, b = change
    C[0, j] -= E * (p[0] + expansion * b)
    C[1, j] -= 2.0 * G * p[1]
    C[2, j] -= 2.0 * G * p[2]
