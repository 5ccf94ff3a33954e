"""One implicit stage of the point problem: all that a point can do beyond the exponential return map (`local`).

T is the deviator of stress, Bᵢ are the back stresses, n = T − Σ Bᵢ, ē the elastic strain with T = c ē (c = 2G, in the
rod's axial component ⅔E). A stage of backward Euler starts from ē*, Bᵢ*, b*, u* and ends, after the strain e, with

    T = c (ē* + e − α ΔT − P − χ T),     Bᵢ = θᵢ (Bᵢ* + ζᵢ P),   θᵢ = 1/(1 + γᵢ q),     P = a n − κ n_β .

P is the plastic strain by (3.1.6), a = 2λ + κ, n_β the n at which flow sets in; q = √⅔ |P|; χ T is the creep strain.
In the scalars (b, a, q, χ) all this is linear and diagonal: with s = 1/(1 + c χ), Z = Σ θᵢ ζᵢ, H = s c + Z,

    n (1 + H a) = A + H κ n_β,    A = s T_trial − Σ θᵢ Bᵢ*,

so that the residual consists of the parts' scalar equations alone:

    yield        |n| = v k(b)                     overstress   q = ρ (v − 1)^m, or v = 1     (`overstress`)
    (3.1.7)      b − b* = n:P                     creep        χ σ = 1.5 Δc(σ, u*), σ = √1.5 |T|     (`creep.flow`)
    length       q = √⅔ |P|

With κ = 0 the second and third give a = D/(v k)² and q = √⅔ D/(v k), D = b − b*, and b alone is left. Temperature
follows b where plastic work heats the point; k², ζ, κ (`functions`) and γᵢ follow both.

With κ ≠ 0 flow has four kinds (`Active`). Where |n| < k at λ = 0, loading is neutral: a smaller κ is unknown in the
place of λ (`local`). And n_β, which spin turns off the yield surface and the second stage extrapolates, may lie beyond
it: the work n:P of a little flow is then slightly negative. b does not decrease, so that D = 0 takes the place of
(3.1.7).

`differential` has the derivatives of all of it, once: towards unknowns it gives Newton's matrix J, towards strains the
tangent −J⁻¹ ∂R/∂ε and, with it, what the next stage starts from.
"""

import math
from collections import namedtuple
from typing import Any

import numpy as np

from coilset.model.core.material.law.functions import EXPONENT, functions
from coilset.model.core.material.law.parts import MOST_TERMS, saturation
from coilset.model.core.runtime.kernels import INLINE, KERNEL, njit
from coilset.model.physics.time.creep.flow import Creep, creep_strain, crept
from coilset.model.physics.time.overstress import ROOT, of_work

# A stage's data. law: Parts; h: time of creep; reference: ρ, 0 without overstress; temperature, at b = work; heating:
# of the temperature by b; expansion: of the rod's axial strain by b; deviates: κ ≠ 0.
Stage = namedtuple("Stage", "law h reference temperature work heating expansion deviates")
# The unknowns, with D in the place of b, and which of them there are: those of flow, and that of creep;
# neutral: κ is one, in the place of λ = 0; frozen: D = 0.
Unknowns = namedtuple("Unknowns", "gain l q chi")
Active = namedtuple("Active", "flow creep neutral frozen")
STILL, CREEPING = Active(False, False, False, False), Active(False, True, False, False)
FLOWING, NEUTRAL = Active(True, False, False, False), Active(True, False, True, False)
# Values at the unknowns: v, k and slopes in b; κ; |n|, n:P, |P|, σ and the creep strain; b, a, q, χ as they are used.
Values = namedtuple("Values", "v dv k dk kappa dkappa norm work length sigma creep gain b l a q chi")
# What a direction changes: strain number `strain` (none: −1) and the unknowns; and by how much the residuals change.
Change = namedtuple("Change", "strain gain l q chi")
Residual = namedtuple("Residual", "flow work length creep")
NO_CREEP = Creep(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

MOST = 4  # unknowns
# Rows of a point's numbers, and of their slopes by the strains: ē; the stage's creep strain χ T; b and u, in the places
# WORK and CREPT; the Bᵢ from BACK on.
ELASTIC, CREEP, SCALARS, BACK = range(4)
WORK, CREPT = 0, 1
ROWS = BACK + MOST_TERMS
OFF, CORRECTION, STEP = MOST, MOST + 1, MOST + 2  # columns of r behind J⁻¹: residuals, J⁻¹ times them, the last step
COMPONENT, TERM = (np.float64, (6,)), (np.float64, (MOST_TERMS,))
BY_STRAIN = (np.float64, (6, 6))  # component, strain
# All that is written on the way, in one piece of memory, which functions get by its address.
ROOM = np.dtype(
    [("components", np.int64), ("terms", np.int64)]
    # weights of the inner product and moduli of T; strain of the increment, slopes of its part before the yield surface
    # by the strains, and of its strain over c
    + [(name, *COMPONENT) for name in ("metric", "modulus", "strain", "before")]
    + [("unit", *BY_STRAIN)]
    # T_trial and n_β, their slopes, and those of the logarithm of the stage's time
    + [("trial", *COMPONENT), ("onset", *COMPONENT), ("d_trial", *BY_STRAIN), ("d_onset", *BY_STRAIN)]
    + [("d_time", *COMPONENT)]
    # at the unknowns: n − n_β, s, T, n, P, and their changes
    + [(name, *COMPONENT) for name in ("turned", "share", "stress", "active", "flow", "d_stress", "d_active", "d_flow")]
    # θᵢ, ζᵢ, γᵢ, their slopes in b and the change of θᵢ
    + [(name, *TERM) for name in ("theta", "zeta", "fading", "d_zeta", "d_fading", "d_theta")]
    # Newton's matrix and residuals; d_stress, d_flow and d_theta of each unknown and, behind MOST, of each strain
    + [("J", np.float64, (MOST, MOST)), ("r", np.float64, (MOST, MOST + 3))]
    + [(f"kept_{name}", np.float64, (MOST + 6, 6)) for name in ("stress", "flow")]
    + [("kept_theta", np.float64, (MOST + 6, MOST_TERMS))]
    # the point where a stage starts, then where it ends; where a piece and a part of the increment start
    + [(f"rows{at}", np.float64, (ROWS, 6)) for at in ("", "_of_piece", "_of_part")]
    + [(f"slopes{at}", np.float64, (ROWS, 6, 6)) for at in ("", "_of_piece", "_of_part")]
)
Room = Any  # a record of ROOM

MAX_ITERATIONS = 60
PRECISION, LAST = 1e-13, 1e-8  # of |n| over k; of the relative correction after which no other follows
SMALL = 1e-7  # plastic work or creep strain, over that of elasticity, which needs no relative accuracy
SHORTEST = 1e-4  # part of a correction
CLOSE, LEAST = 1e-10, 1e-6  # of |n| over k, and of κ; of n:P over |n| |P|, from where D is sought
SLIGHT = 1e-8  # of n:P over |n| |P|, and of κ, that is none


@njit(**INLINE)
def inner(w: Room, a: np.ndarray, b: np.ndarray) -> float:
    """a:b of two deviators."""
    total = 0.0
    for j in range(w.components):
        total += w.metric[j] * a[j] * b[j]
    return total


@njit(**KERNEL)
def evaluate(of: Stage, at: Unknowns, active: Active, w: Room) -> Values:
    """T, n and P at the unknowns, and what the residuals consist of."""
    law, gain, chi = of.law, at.gain, at.chi
    b = w.rows[SCALARS, WORK] + gain
    temperature = of.temperature + of.heating * (b - of.work)
    k2, dk2, zeta, d_zeta, kappa, dkappa = functions(law.plastic, b, temperature)
    k = math.sqrt(k2)
    dk = 0.5 * dk2 / k
    if not of.deviates:
        kappa = dkappa = 0.0
    if active.neutral:
        kappa, dkappa = at.l, 0.0
    v, dv, l, q = 1.0, 0.0, at.l, at.q
    a = l if active.neutral else l + kappa
    if active.flow and not of.deviates:
        if of.reference > 0.0:
            v, dv = of_work(of.reference, law.plastic[EXPONENT], gain, k)
        l, q = gain / (v * v * k2), ROOT * gain / (v * k)
        a = l
    if not active.flow:
        a = l = q = kappa = dkappa = 0.0
    total = 0.0
    for i in range(w.terms):
        if law.terms.shape[1] > 0:
            zeta, w.fading[i], d_zeta, w.d_fading[i] = saturation(law, i, temperature)
        w.zeta[i], w.d_zeta[i] = zeta, d_zeta
        w.theta[i] = 1.0 / (1.0 + w.fading[i] * q)
        total += w.theta[i] * zeta
    for j in range(w.components):
        c = w.modulus[j]
        s = w.share[j] = 1.0 / (1.0 + c * chi)
        elastic = w.trial[j]
        if j == 0:
            elastic -= c * of.expansion * gain
        n, H = s * elastic, s * c + total
        for i in range(w.terms):
            n -= w.theta[i] * w.rows[BACK + i, j]
        turned = (n - (1.0 + H * (a - kappa)) * w.onset[j]) / (1.0 + H * a)  # n − n_β, without its rounding
        n = (n + H * kappa * w.onset[j]) / (1.0 + H * a)
        P = (a - kappa) * n + kappa * turned
        w.turned[j], w.active[j], w.flow[j] = turned, n, P
        w.stress[j] = s * (elastic - c * P)
    norm, length = math.sqrt(inner(w, w.active, w.active)), math.sqrt(inner(w, w.flow, w.flow))
    sigma, creep = 0.0, NO_CREEP
    if active.creep:
        sigma = math.sqrt(1.5 * inner(w, w.stress, w.stress))
        creep = creep_strain(law.viscous, sigma, w.rows[SCALARS, CREPT], of.h)
    work = inner(w, w.active, w.flow)
    return Values(v, dv, k, dk, kappa, dkappa, norm, work, length, sigma, creep, gain, b, l, a, q, chi)


@njit(**KERNEL)
def differential(of: Stage, x: Values, active: Active, change: Change, w: Room) -> Residual:
    """How n, P, T, θᵢ and the residuals change in a direction from x; see `Change`."""
    k, way, db0, du0, d_time = x.k, change.strain, 0.0, 0.0, 0.0
    if way >= 0:
        db0, du0, d_time = w.slopes[SCALARS, WORK, way], w.slopes[SCALARS, CREPT, way], w.d_time[way]
    gain, d_gain, db = x.gain, change.gain, db0 + change.gain
    dk, dq, dv = x.dk * db, change.q, 0.0
    dkappa = change.l if active.neutral else x.dkappa * db
    da = change.l if active.neutral else change.l + dkappa
    if active.flow and not of.deviates:
        dw = d_gain / gain
        if of.reference > 0.0:
            dv = x.v * x.dv * (dw - dk / k - d_time)
        dq = x.q * (dw - dv / x.v - dk / k)
        da = x.a * (dw - 2.0 * dv / x.v - 2.0 * dk / k)
    if not active.flow:
        d_gain = 0.0
    total = d_total = 0.0
    for i in range(w.terms):
        theta, zeta = w.theta[i], w.zeta[i]
        w.d_theta[i] = -theta * theta * (w.fading[i] * dq + x.q * w.d_fading[i] * db)
        total += theta * zeta
        d_total += w.d_theta[i] * zeta + theta * w.d_zeta[i] * db
    nn = pp = np_ = tt = 0.0
    for j in range(w.components):
        c, s = w.modulus[j], w.share[j]
        ds, elastic, d_elastic, d_onset = -c * s * s * change.chi, w.trial[j], 0.0, 0.0
        if way >= 0:
            d_elastic, d_onset = w.d_trial[j, way], w.d_onset[j, way]
        if j == 0:
            elastic -= c * of.expansion * gain
            d_elastic -= c * of.expansion * d_gain
        dn, H, dH = s * d_elastic + ds * elastic, s * c + total, c * ds + d_total
        for i in range(w.terms):
            dn -= w.d_theta[i] * w.rows[BACK + i, j]
            if way >= 0:
                dn -= w.theta[i] * w.slopes[BACK + i, j, way]
        n, P, turned = w.active[j], w.flow[j], w.turned[j]
        rest = n * (da - dkappa) + turned * dkappa - x.kappa * d_onset
        dn = (dn - P * dH - H * rest) / (1.0 + H * x.a)
        dP = rest + x.a * dn
        dT = s * (d_elastic - c * dP) + ds * (elastic - c * P)
        w.d_active[j], w.d_flow[j], w.d_stress[j] = dn, dP, dT
        m = w.metric[j]
        nn += m * n * dn
        np_ += m * (n * dP + P * dn)
        pp += m * P * dP
        tt += m * w.stress[j] * dT
    creep = 0.0
    if active.creep:
        d_sigma = 1.5 * tt / x.sigma
        grown = x.creep.by_stress * d_sigma + x.creep.by_start * du0 + x.creep.by_time * d_time
        creep = change.chi / x.chi + d_sigma / x.sigma - grown / x.creep.strain
    length = dq - 2.0 / 3.0 * pp / x.q if x.q > 0.0 else dq
    return Residual(nn / x.norm - dv * k - x.v * dk, d_gain - np_, length, creep)


@njit(**INLINE)
def residual(x: Values) -> Residual:
    """The equations, each as it is differentiated in `differential`."""
    creep = math.log(x.chi * x.sigma / (1.5 * x.creep.strain)) if x.chi > 0.0 and x.creep.strain > 0.0 else 0.0
    return Residual(x.norm - x.v * x.k, x.gain - x.work, x.q - ROOT * x.length, creep)


@njit(**INLINE)
def creep_alone(of: Stage, w: Room) -> tuple[float, int]:
    """χ of a stage that does not flow, and iterations, −1 if there is none."""
    first, other = 1.5 * w.metric[0] * w.trial[0] * w.trial[0], 0.0
    for j in range(1, w.components):
        other += 1.5 * w.metric[j] * w.trial[j] * w.trial[j]
    return crept(of.law.viscous, (first, other), (w.modulus[0], w.modulus[1]), w.rows[SCALARS, CREPT], of.h)


@njit(**INLINE)
def _normal(of: Stage, reference: float) -> Stage:
    """Without deviation from normality, and with another overstress."""
    return Stage(of.law, of.h, reference, of.temperature, of.work, of.heating, of.expansion, False)


@njit(**KERNEL)
def flow_alone(of: Stage, chi: float, w: Room) -> tuple[float, int]:
    """D of a stage that flows without deviation from normality, at a given χ; iterations, −1 if there is none.

    |n| − v k falls with D. Newton's method is kept in a bracket. With overstress it starts anew from the static law's D
    and goes over r, D = D_static r^m, since v − 1 is nearly linear in r.
    """
    m = of.law.plastic[EXPONENT]
    reference, of = of.reference, _normal(of, 0.0)
    static, r, low, high, count, beyond, to = 0.0, 0.0, 0.0, math.inf, 0, 0.0, 0.0
    for _ in range(2 * MAX_ITERATIONS):
        gain = r if static == 0.0 else static * r**m
        at = evaluate(of, Unknowns(gain, 0.0, 0.0, chi), FLOWING if gain > 0.0 else STILL, w)
        off = at.norm - at.v * at.k
        found = gain > 0.0 and abs(off) <= PRECISION * at.v * at.k
        if gain == 0.0:
            stiffness = w.share[1] * w.modulus[1] + at.k * at.dk
            for i in range(w.terms):
                stiffness += w.zeta[i]
            beyond, to = at.norm / at.k - 1.0, off * at.k / stiffness
        elif not found:
            slope = differential(of, at, FLOWING, Change(-1, 1.0, 0.0, 0.0, 0.0), w).flow
            slope *= 1.0 if static == 0.0 else m * gain / r
            low, high = (r, high) if off > 0.0 else (low, r)
            to = r - off / slope if slope < 0.0 else math.inf
        if not found and not low < to < high:
            to = 0.5 * (low + high) if high < math.inf else 2.0 * r + 1e-3 * at.k
        if found or to == r or high - low <= 1e-15 * r:
            if reference == 0.0 or static > 0.0:
                return gain, count
            # r = 1 is the static law; v − 1 there, and over that of the elastic response, were v linear in r
            static, of, low, high = gain, _normal(of, reference), 0.0, 1.0
            to = beyond / (beyond + of_work(reference, m, gain, at.k)[0] - 1.0)
        r, count = to, count + 1
    return 0.0, -1


@njit(**INLINE)
def _unknowns(active: Active, deviates: bool) -> int:
    """Their number: D, unless frozen, then λ or κ and q if flow deviates from normality, then log χ."""
    flow = (0 if active.frozen else 1) + (2 if deviates else 0)
    return (flow if active.flow else 0) + (1 if active.creep else 0)


@njit(**INLINE)
def _direction(x: Values, active: Active, deviates: bool, number: int) -> Change:
    """Of an unknown, in its own size."""
    if active.creep and number == _unknowns(active, deviates) - 1:
        return Change(-1, 0.0, 0.0, 0.0, x.chi)
    number += 1 if active.frozen else 0
    if number == 0:
        return Change(-1, x.gain, 0.0, 0.0, 0.0)
    return Change(-1, 0.0, x.l, 0.0, 0.0) if number == 1 else Change(-1, 0.0, 0.0, x.q, 0.0)


@njit(**INLINE)
def _write(x: Values, r: Residual, active: Active, deviates: bool, into: np.ndarray, column: int) -> None:
    """The residuals that there are, in the order of the unknowns and without units."""
    i = 0
    if active.flow:
        into[0, column], i = r.flow / x.k, 1
        if not active.frozen and deviates:
            into[1, column], i = r.work / x.gain, 2
        if deviates:
            into[i, column] = r.length / x.q
            i += 1
    if active.creep:
        into[i, column] = r.creep


@njit(**INLINE)
def _grown(step: float) -> float:
    """Factor of a positive unknown."""
    return 1.0 + step if step > 0.0 else 1.0 / (1.0 - step)


@njit(**INLINE)
def _moved(x: Values, r: np.ndarray, part: float, active: Active, deviates: bool) -> Unknowns:
    """The unknowns after part of Newton's correction r; all stay positive."""
    gain, l, q, chi, i = x.gain, x.l, x.q, x.chi, 0
    if active.flow and not active.frozen:
        gain, i = gain * _grown(-part * r[0, STEP]), 1
    if active.flow and deviates:
        l, q = l * _grown(-part * r[i, STEP]), q * _grown(-part * r[i + 1, STEP])
        i += 2
    if active.creep:
        chi *= _grown(-part * r[i, STEP])
    return Unknowns(gain, l, q, chi)


@njit(**INLINE)
def _error(x: Values, r: np.ndarray, active: Active, deviates: bool, modulus: float) -> float:
    """Largest relative correction, of what is small beside the elastic strain times its share of that."""
    length = x.length + SMALL * x.k / modulus
    flow = x.length / length
    creep = x.creep.strain / (x.creep.strain + SMALL * x.sigma / modulus)
    largest, i = 0.0, 0
    if active.flow and not active.frozen:
        largest, i = abs(r[0, CORRECTION]) * x.gain / (x.v * x.k * length), 1  # n:P may be less than |n| |P|
    if active.flow and deviates:
        share = flow if active.neutral else x.l * x.v * x.k / length  # of λ n in P
        largest = max(largest, share * abs(r[i, CORRECTION]), flow * abs(r[i + 1, CORRECTION]))
        i += 2
    return max(largest, creep * abs(r[i, CORRECTION])) if active.creep else largest


@njit(**INLINE)
def _keep(w: Room, i: int) -> None:
    for j in range(w.components):
        w.kept_stress[i, j], w.kept_flow[i, j] = w.d_stress[j], w.d_flow[j]
    for j in range(w.terms):
        w.kept_theta[i, j] = w.d_theta[j]


@njit(**KERNEL)
def _matrix(of: Stage, x: Values, active: Active, w: Room) -> None:
    """Write J, the residuals' derivatives in the unknowns."""
    for i in range(_unknowns(active, of.deviates)):
        change = differential(of, x, active, _direction(x, active, of.deviates, i), w)
        _write(x, change, active, of.deviates, w.J, i)
        _keep(w, i)


@njit(**KERNEL)
def _eliminate(J: np.ndarray, r: np.ndarray, n: int, columns: int) -> None:
    """Replace r by J⁻¹ r; J is overwritten."""
    for i in range(n):
        top = i
        for k in range(i + 1, n):
            if abs(J[k, i]) > abs(J[top, i]):
                top = k
        if top != i:
            for j in range(n):
                J[i, j], J[top, j] = J[top, j], J[i, j]
            for j in range(columns):
                r[i, j], r[top, j] = r[top, j], r[i, j]
        for k in range(i + 1, n):
            f = J[k, i] / J[i, i]
            for j in range(i, n):
                J[k, j] -= f * J[i, j]
            for j in range(columns):
                r[k, j] -= f * r[i, j]
    for j in range(columns):
        for i in range(n - 1, -1, -1):
            for k in range(i + 1, n):
                r[i, j] -= J[i, k] * r[k, j]
            r[i, j] /= J[i, i]


@njit(**INLINE)
def _invert(w: Room, n: int) -> None:
    """Write J⁻¹ to the first columns of `Room.r`."""
    for i in range(n):
        for j in range(n):
            w.r[i, j] = 1.0 if i == j else 0.0
    _eliminate(w.J, w.r, n, n)


@njit(**INLINE)
def _correct(w: Room, n: int) -> float:
    """Write J⁻¹ times the residuals; its square."""
    size = 0.0
    for i in range(n):
        w.r[i, CORRECTION] = 0.0
        for j in range(n):
            w.r[i, CORRECTION] += w.r[i, j] * w.r[j, OFF]
        size += w.r[i, CORRECTION] * w.r[i, CORRECTION]
    return size


@njit(**KERNEL)
def _together(of: Stage, at: Unknowns, active: Active, w: Room) -> tuple[Values, int]:
    """Newton's method for all unknowns of a stage that flows; iterations, −1 if it fails.

    A correction is halved until one by the same matrix after it is smaller, which no scaling of the equations changes
    (P. Deuflhard, Newton Methods for Nonlinear Problems, 2004, 3.3).
    """
    n = _unknowns(active, of.deviates)
    x = evaluate(of, at, active, w)
    _write(x, residual(x), active, of.deviates, w.r, OFF)
    for iteration in range(1, MAX_ITERATIONS):
        _matrix(of, x, active, w)
        _invert(w, n)
        size = _correct(w, n)
        largest = _error(x, w.r, active, of.deviates, w.modulus[0])
        if not math.isfinite(largest):
            return x, -1
        part = 1.0
        for i in range(n):
            w.r[i, STEP] = w.r[i, CORRECTION]
        while True:
            new = evaluate(of, _moved(x, w.r, part, active, of.deviates), active, w)
            if largest <= LAST:
                return new, iteration
            _write(new, residual(new), active, of.deviates, w.r, OFF)
            if _correct(w, n) < size:
                break
            part *= 0.5
            if part < SHORTEST:
                return x, -1
        x = new
    return x, -1


@njit(**KERNEL)
def _neutral_alone(of: Stage, chi: float, w: Room) -> Unknowns:
    """κ of neutral loading, with its D ≥ 0 and q, at a given χ, near enough for Newton's method.

    |n| > k at κ = 0, which is elastic, and |n| < k at the material's κ: false position with halved weights (Illinois).
    """
    low, high = 0.0, functions(of.law.plastic, w.rows[SCALARS, WORK], of.temperature)[4]
    above, below, kappa = math.nan, math.nan, 0.5 * high
    at = Unknowns(0.0, kappa, 0.0, chi)
    for _ in range(MAX_ITERATIONS):
        x = evaluate(of, Unknowns(at.gain, kappa, at.q, chi), NEUTRAL, w)
        at = Unknowns(max(x.work, 0.0), kappa, ROOT * x.length, chi)
        x = evaluate(of, at, NEUTRAL, w)
        off = x.norm - x.k
        if abs(off) <= CLOSE * x.k or high - low <= CLOSE * high:
            return at
        if off > 0.0:
            low, above, below = kappa, off, 0.5 * below
        else:
            high, below, above = kappa, off, 0.5 * above
        kappa = (low * below - high * above) / (below - above)
        if not low < kappa < high:  # not both ends are known yet
            kappa = 0.5 * (low + high)
    return at


@njit(**KERNEL)
def _deviating(of: Stage, at: Unknowns, active: Active, w: Room) -> tuple[Values, Active, int]:
    """The end of a stage that flows with κ ≠ 0, from the unknowns of one that flows without.

    The kind of flow is that of λ = 0, or else, at the border of two kinds, another one.
    """
    x = evaluate(of, Unknowns(0.0, 0.0, 0.0, at.chi), FLOWING, w)
    x = evaluate(of, Unknowns(max(x.work, 0.0), 0.0, ROOT * x.length, at.chi), FLOWING, w)
    neutral, total = x.norm < x.k, 0
    for _ in range(2):
        first, frozen = at, False
        if neutral:
            first = _neutral_alone(of, at.chi, w)
            frozen = first.gain == 0.0
        for _ in range(2):
            active = Active(True, active.creep, neutral, frozen)
            gain = 0.0 if frozen else max(first.gain, LEAST * x.k * first.q)
            x, count = _together(of, Unknowns(gain, first.l, first.q, at.chi), active, w)
            total += max(count, 0)
            kappa = functions(of.law.plastic, x.b, of.temperature)[4]
            falls = not frozen or x.work <= SLIGHT * x.k * x.length
            if count >= 0 and falls and (not neutral or x.l <= kappa * (1.0 + SLIGHT)):
                return x, active, total
            frozen = not frozen
        neutral = not neutral
    return x, active, -1


@njit(**INLINE)
def solve(of: Stage, w: Room) -> tuple[Values, Active, int]:
    """The end of a stage, and iterations, −1 if there is none."""
    chi, count = 0.0, 0
    if of.h > 0.0:
        chi, count = creep_alone(of, w)
    x = evaluate(of, Unknowns(0.0, 0.0, 0.0, chi), CREEPING if chi > 0.0 else STILL, w)
    if count < 0 or x.norm <= x.k * (1.0 + 1e-12):
        return x, CREEPING if chi > 0.0 else STILL, count
    active = Active(True, chi > 0.0, False, False)
    gain, more = flow_alone(of, chi, w)
    if more < 0:
        return x, active, -1
    x = evaluate(_normal(of, of.reference), Unknowns(gain, 0.0, 0.0, chi), FLOWING, w)
    if active.creep or of.deviates:
        at = Unknowns(x.gain, x.l, x.q, x.chi)
        if of.deviates:
            x, active, last = _deviating(of, at, active, w)
        else:
            x, last = _together(of, at, active, w)
        if last < 0:
            return x, active, -1
        more += last
    return x, active, count + more


@njit(**INLINE)
def finish(of: Stage, x: Values, active: Active, w: Room) -> None:
    """Replace the start of a stage and its slopes by those of its end."""
    n, count = w.components, _unknowns(active, of.deviates)
    rows, slopes = w.rows, w.slopes
    _matrix(of, x, active, w)
    for k in range(n):
        change = differential(of, x, active, Change(k, 0.0, 0.0, 0.0, 0.0), w)
        _write(x, change, active, of.deviates, w.r, k)
        _keep(w, MOST + k)
    _eliminate(w.J, w.r, count, n)
    for k in range(n):
        stress, flow, theta = w.kept_stress[MOST + k], w.kept_flow[MOST + k], w.kept_theta[MOST + k]
        for i in range(count):
            by = -w.r[i, k]
            for j in range(n):
                stress[j] += by * w.kept_stress[i, j]
                flow[j] += by * w.kept_flow[i, j]
            for j in range(w.terms):
                theta[j] += by * w.kept_theta[i, j]
        d_work = slopes[SCALARS, WORK, k] - (x.gain * w.r[0, k] if active.flow and not active.frozen else 0.0)
        d_chi = -x.chi * w.r[count - 1, k] if active.creep else 0.0
        d_sigma = 0.0
        for j in range(n):
            slopes[ELASTIC, j, k] = stress[j] / w.modulus[j]
            slopes[CREEP, j, k] = d_chi * w.stress[j] + x.chi * stress[j]
            d_sigma += w.metric[j] * w.stress[j] * stress[j]
            for i in range(w.terms):
                P = w.flow[j]
                grown = slopes[BACK + i, j, k] + w.d_zeta[i] * d_work * P + w.zeta[i] * flow[j]
                slopes[BACK + i, j, k] = w.theta[i] * grown + theta[i] * (rows[BACK + i, j] + w.zeta[i] * P)
        slopes[SCALARS, WORK, k] = d_work
        if active.creep:
            d_sigma *= 1.5 / x.sigma
            slopes[SCALARS, CREPT, k] += x.creep.u_by_stress * d_sigma + x.creep.u_by_time * w.d_time[k]
    for j in range(n):
        rows[ELASTIC, j], rows[CREEP, j] = w.stress[j] / w.modulus[j], x.chi * w.stress[j]
        for i in range(w.terms):
            rows[BACK + i, j] = w.theta[i] * (rows[BACK + i, j] + w.zeta[i] * w.flow[j])
    rows[SCALARS, WORK] = x.b
    if active.creep:
        rows[SCALARS, CREPT] = x.creep.u
