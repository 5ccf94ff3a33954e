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

import numpy as np

from coilset.model.base.kernel import INLINE, KERNEL
from coilset.model.material.creep.flow import creep_strain, crept
from coilset.model.material.law.functions import EXPONENT, functions
from coilset.model.material.law.parts import Parts, saturation
from coilset.model.material.point.overstress import ROOT, of_work
from coilset.model.runtime.kernels import njit

# A stage's data. h: time of creep; reference: ρ, 0 without overstress; temperature, at b = work; heating: of
# the temperature by b; expansion: of the rod's axial strain by b; deviates: κ ≠ 0.
Span = namedtuple("Span", "h reference temperature work heating expansion deviates")
# The unknowns, with D in the place of b, and which of them there are: those of flow, and that of creep;
# neutral: κ is one, in the place of λ = 0; frozen: D = 0.
Unknowns = namedtuple("Unknowns", "gain l q chi")
Active = namedtuple("Active", "flow creep neutral frozen")
STILL, FLOWING = Active(False, False, False, False), Active(True, False, False, False)
NEUTRAL = Active(True, False, True, False)
# Room for a stage. v: rows over the components, by the names below; of: rows over the back stresses; J, r: Newton's
# matrix and residuals; ways: slopes of T_trial, n_β and the logarithm of the stage's time by the strains, shape (3,
# components, strains); kept, kept_of: D_STRESS and D_FLOW, and D_THETA, of each unknown and, behind MOST of them, of
# each strain.
MOST = 4
Room = namedtuple("Room", "v of J r ways kept kept_of")
OFF, CORRECTION, STEP = MOST, MOST + 1, MOST + 2  # columns of r behind J⁻¹: residuals, J⁻¹ times them, the last step
METRIC, MODULUS, TRIAL, ONSET, TURNED, SHARE, STRESS, ACTIVE, FLOW, D_STRESS, D_ACTIVE, D_FLOW, VECTORS = range(13)
THETA, ZETA, FADING, D_ZETA, D_FADING, D_THETA, TERMS = range(7)  # FADING: γ
# Values at the unknowns: v, k and slopes in b; κ; |n|, n:P, |P|, σ and the creep strain; b, a, q, χ as they are used.
Values = namedtuple("Values", "v dv k dk kappa dkappa norm work length sigma creep gain b l a q chi")
# What a direction changes: strain number `strain` (none: −1) and the unknowns; and by how much the residuals change.
Change = namedtuple("Change", "strain gain l q chi")
Residual = namedtuple("Residual", "flow work length creep")
# Rows of a point's numbers, as of their slopes: ē, the Bᵢ from BACK on, the stage's creep strain χ T in the row before
# the last, and in the last b and u, in the places WORK and CREPT.
BACK, CREEP, WORK, CREPT = 1, -2, 0, 1

MAX_ITERATIONS = 60
PRECISION, LAST = 1e-13, 1e-8  # of |n| over k; of the relative correction after which no other follows
SMALL = 1e-7  # plastic work or creep strain, over that of elasticity, which needs no relative accuracy
SHORTEST = 1e-4  # part of a correction
CLOSE, LEAST = 1e-10, 1e-6  # of |n| over k, and of κ; of n:P over |n| |P|, from where D is sought
SLIGHT = 1e-8  # of n:P over |n| |P|, and of κ, that is none


@njit(**INLINE)
def inner(v: np.ndarray, a: int, b: int) -> float:
    """a:b of two deviators in rows of `Room.v`."""
    total = 0.0
    for j in range(v.shape[1]):
        total += v[METRIC, j] * v[a, j] * v[b, j]
    return total


@njit(**KERNEL)
def evaluate(law: Parts, span: Span, start: np.ndarray, at: Unknowns, active: Active, room: Room) -> Values:
    """T, n and P at the unknowns, and what the residuals consist of."""
    p, size = law.plastic, room.of.shape[1]
    gain, chi = at.gain, at.chi
    b = start[-1, WORK] + gain
    temperature = span.temperature + span.heating * (b - span.work)
    k2, dk2, zeta, d_zeta, kappa, dkappa = functions(p, b, temperature)
    k = math.sqrt(k2)
    dk = 0.5 * dk2 / k
    if not span.deviates:
        kappa = dkappa = 0.0
    if active.neutral:
        kappa, dkappa = at.l, 0.0
    v, dv, l, q = 1.0, 0.0, at.l, at.q
    a = l if active.neutral else l + kappa
    if active.flow and not span.deviates:
        if span.reference > 0.0:
            v, dv = of_work(span.reference, p[EXPONENT], gain, k)
        l, q = gain / (v * v * k2), ROOT * gain / (v * k)
        a = l
    if not active.flow:
        a = l = q = kappa = dkappa = 0.0
    total = 0.0
    for i in range(size):
        if law.terms.shape[1] > 0:
            zeta, room.of[FADING, i], d_zeta, room.of[D_FADING, i] = saturation(law, i, temperature)
        room.of[ZETA, i], room.of[D_ZETA, i] = zeta, d_zeta
        room.of[THETA, i] = 1.0 / (1.0 + room.of[FADING, i] * q)
        total += room.of[THETA, i] * zeta
    for j in range(room.v.shape[1]):
        c = room.v[MODULUS, j]
        s = room.v[SHARE, j] = 1.0 / (1.0 + c * chi)
        elastic = room.v[TRIAL, j]
        if j == 0:
            elastic -= c * span.expansion * gain
        n, H = s * elastic, s * c + total
        for i in range(size):
            n -= room.of[THETA, i] * start[BACK + i, j]
        turned = (n - (1.0 + H * (a - kappa)) * room.v[ONSET, j]) / (1.0 + H * a)  # n − n_β, without its rounding
        n = (n + H * kappa * room.v[ONSET, j]) / (1.0 + H * a)
        P = (a - kappa) * n + kappa * turned
        room.v[TURNED, j], room.v[ACTIVE, j], room.v[FLOW, j] = turned, n, P
        room.v[STRESS, j] = s * (elastic - c * P)
    norm, length = math.sqrt(inner(room.v, ACTIVE, ACTIVE)), math.sqrt(inner(room.v, FLOW, FLOW))
    sigma = math.sqrt(1.5 * inner(room.v, STRESS, STRESS))
    creep = creep_strain(law.viscous, sigma, start[-1, CREPT], span.h)
    work = inner(room.v, ACTIVE, FLOW)
    return Values(v, dv, k, dk, kappa, dkappa, norm, work, length, sigma, creep, gain, b, l, a, q, chi)


@njit(**KERNEL)
def differential(
    law: Parts,
    span: Span,
    start: np.ndarray,
    slopes: np.ndarray,
    values: Values,
    active: Active,
    change: Change,
    room: Room,
) -> Residual:
    """How n, P, T, θᵢ and the residuals change in a direction; see `Change`.

    Args:
        law, span, start, values, room: as in `evaluate`.
        slopes: of the start by the strains, shape (rows, components, strains).
        active: Active.
        change: the direction.
    """
    x, size, k = values, room.of.shape[1], values.k
    way, db0, du0, d_time = change.strain, 0.0, 0.0, 0.0
    if way >= 0:
        db0, du0, d_time = slopes[-1, WORK, way], slopes[-1, CREPT, way], room.ways[2, 0, way]
    gain, d_gain, db = x.gain, change.gain, db0 + change.gain
    dk, dq, dv = x.dk * db, change.q, 0.0
    dkappa = change.l if active.neutral else x.dkappa * db
    da = change.l if active.neutral else change.l + dkappa
    if active.flow and not span.deviates:
        dw = d_gain / gain
        if span.reference > 0.0:
            dv = x.v * x.dv * (dw - dk / k - d_time)
        dq = x.q * (dw - dv / x.v - dk / k)
        da = x.a * (dw - 2.0 * dv / x.v - 2.0 * dk / k)
    if not active.flow:
        d_gain = 0.0
    d_total = 0.0
    for i in range(size):
        theta = room.of[THETA, i]
        room.of[D_THETA, i] = -theta * theta * (room.of[FADING, i] * dq + x.q * room.of[D_FADING, i] * db)
        d_total += room.of[D_THETA, i] * room.of[ZETA, i] + theta * room.of[D_ZETA, i] * db
    total = 0.0
    for i in range(size):
        total += room.of[THETA, i] * room.of[ZETA, i]
    nn = pp = np_ = tt = 0.0
    for j in range(room.v.shape[1]):
        c, s = room.v[MODULUS, j], room.v[SHARE, j]
        ds, elastic, d_elastic = -c * s * s * change.chi, room.v[TRIAL, j], 0.0
        d_onset = 0.0
        if way >= 0:
            d_elastic, d_onset = room.ways[0, j, way], room.ways[1, j, way]
        if j == 0:
            elastic -= c * span.expansion * gain
            d_elastic -= c * span.expansion * d_gain
        dn, H, dH = s * d_elastic + ds * elastic, s * c + total, c * ds + d_total
        for i in range(size):
            dn -= room.of[D_THETA, i] * start[BACK + i, j]
            if way >= 0:
                dn -= room.of[THETA, i] * slopes[BACK + i, j, way]
        n, P, turned = room.v[ACTIVE, j], room.v[FLOW, j], room.v[TURNED, j]
        rest = n * (da - dkappa) + turned * dkappa - x.kappa * d_onset
        dn = (dn - P * dH - H * rest) / (1.0 + H * x.a)
        dP = rest + x.a * dn
        dT = s * (d_elastic - c * dP) + ds * (elastic - c * P)
        room.v[D_ACTIVE, j], room.v[D_FLOW, j], room.v[D_STRESS, j] = dn, dP, dT
        w = room.v[METRIC, j]
        nn += w * n * dn
        np_ += w * (n * dP + P * dn)
        pp += w * P * dP
        tt += w * room.v[STRESS, j] * dT
    of = x.creep
    d_sigma = 1.5 * tt / x.sigma if x.sigma > 0.0 else 0.0
    d_creep = of.by_stress * d_sigma + of.by_start * du0 + of.by_time * d_time
    return Residual(
        nn / x.norm - dv * k - x.v * dk,
        d_gain - np_,
        dq - 2.0 / 3.0 * pp / x.q if x.q > 0.0 else dq,
        change.chi / x.chi + d_sigma / x.sigma - d_creep / of.strain if active.creep else 0.0,
    )


@njit(**INLINE)
def residual(x: Values) -> Residual:
    """The equations, each as it is differentiated in `differential`."""
    of = x.creep
    creep = math.log(x.chi * x.sigma / (1.5 * of.strain)) if x.chi > 0.0 and of.strain > 0.0 else 0.0
    return Residual(x.norm - x.v * x.k, x.gain - x.work, x.q - ROOT * x.length, creep)


@njit(**INLINE)
def creep_alone(law: Parts, span: Span, start: np.ndarray, room: Room) -> tuple[float, int]:
    """χ of a stage that does not flow, and iterations, −1 if there is none."""
    v = room.v
    first, other = 1.5 * v[METRIC, 0] * v[TRIAL, 0] * v[TRIAL, 0], 0.0
    for j in range(1, v.shape[1]):
        other += 1.5 * v[METRIC, j] * v[TRIAL, j] * v[TRIAL, j]
    return crept(law.viscous, (first, other), (v[MODULUS, 0], v[MODULUS, 1]), start[-1, CREPT], span.h)


@njit(**INLINE)
def _normal(span: Span, reference: float) -> Span:
    """Without deviation from normality, and with another overstress."""
    return Span(span.h, reference, span.temperature, span.work, span.heating, span.expansion, False)


@njit(**KERNEL)
def flow_alone(
    law: Parts, span: Span, start: np.ndarray, slopes: np.ndarray, chi: float, room: Room
) -> tuple[float, int]:
    """D of a stage that flows without deviation from normality, at a given χ; iterations, −1 if there is none.

    |n| − v k falls with D. Newton's method is kept in a bracket. With overstress it starts anew from the static law's D
    and goes over r, D = D_static r^m, since v − 1 is nearly linear in r.
    """
    m = law.plastic[EXPONENT]
    reference, span = span.reference, _normal(span, 0.0)
    static, r, low, high, count, beyond, to = 0.0, 0.0, 0.0, math.inf, 0, 0.0, 0.0
    for _ in range(2 * MAX_ITERATIONS):
        gain = r if static == 0.0 else static * r**m
        at = evaluate(law, span, start, Unknowns(gain, 0.0, 0.0, chi), FLOWING if gain > 0.0 else STILL, room)
        off = at.norm - at.v * at.k
        found = gain > 0.0 and abs(off) <= PRECISION * at.v * at.k
        if gain == 0.0:
            stiffness = room.v[SHARE, 1] * room.v[MODULUS, 1] + at.k * at.dk
            for i in range(room.of.shape[1]):
                stiffness += room.of[ZETA, i]
            beyond, to = at.norm / at.k - 1.0, off * at.k / stiffness
        elif not found:
            slope = differential(law, span, start, slopes, at, FLOWING, Change(-1, 1.0, 0.0, 0.0, 0.0), room).flow
            slope *= 1.0 if static == 0.0 else m * gain / r
            low, high = (r, high) if off > 0.0 else (low, r)
            to = r - off / slope if slope < 0.0 else math.inf
        if not found and not low < to < high:
            to = 0.5 * (low + high) if high < math.inf else 2.0 * r + 1e-3 * at.k
        if found or to == r or high - low <= 1e-15 * r:
            if reference == 0.0 or static > 0.0:
                return gain, count
            # r = 1 is the static law; v − 1 there, and over that of the elastic response, were v linear in r
            static, span, low, high = gain, _normal(span, reference), 0.0, 1.0
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
def _write(x: Values, of: Residual, active: Active, deviates: bool, into: np.ndarray, column: int) -> None:
    """The residuals that there are, in the order of the unknowns and without units."""
    i = 0
    if active.flow:
        into[0, column], i = of.flow / x.k, 1
        if not active.frozen and deviates:
            into[1, column], i = of.work / x.gain, 2
        if deviates:
            into[i, column] = of.length / x.q
            i += 1
    if active.creep:
        into[i, column] = of.creep


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
def _keep(room: Room, i: int) -> None:
    for j in range(room.v.shape[1]):
        room.kept[i, 0, j], room.kept[i, 1, j] = room.v[D_STRESS, j], room.v[D_FLOW, j]
    for j in range(room.of.shape[1]):
        room.kept_of[i, j] = room.of[D_THETA, j]


@njit(**KERNEL)
def _matrix(
    law: Parts,
    span: Span,
    start: np.ndarray,
    slopes: np.ndarray,
    x: Values,
    active: Active,
    room: Room,
) -> None:
    """Write J, the residuals' derivatives in the unknowns."""
    for i in range(_unknowns(active, span.deviates)):
        of = differential(law, span, start, slopes, x, active, _direction(x, active, span.deviates, i), room)
        _write(x, of, active, span.deviates, room.J, i)
        _keep(room, i)


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
def _invert(room: Room, n: int) -> None:
    """Write J⁻¹ to the first columns of `Room.r`."""
    for i in range(n):
        for j in range(n):
            room.r[i, j] = 1.0 if i == j else 0.0
    _eliminate(room.J, room.r, n, n)


@njit(**INLINE)
def _correct(room: Room, n: int) -> float:
    """Write J⁻¹ times the residuals; its square."""
    size = 0.0
    for i in range(n):
        room.r[i, CORRECTION] = 0.0
        for j in range(n):
            room.r[i, CORRECTION] += room.r[i, j] * room.r[j, OFF]
        size += room.r[i, CORRECTION] * room.r[i, CORRECTION]
    return size


@njit(**KERNEL)
def _together(
    law: Parts,
    span: Span,
    start: np.ndarray,
    slopes: np.ndarray,
    at: Unknowns,
    active: Active,
    room: Room,
) -> tuple[Values, int]:
    """Newton's method for all unknowns of a stage that flows; iterations, −1 if it fails.

    A correction is halved until one by the same matrix after it is smaller, which no scaling of the equations changes
    (P. Deuflhard, Newton Methods for Nonlinear Problems, 2004, 3.3).
    """
    n = _unknowns(active, span.deviates)
    x = evaluate(law, span, start, at, active, room)
    _write(x, residual(x), active, span.deviates, room.r, OFF)
    for iteration in range(1, MAX_ITERATIONS):
        _matrix(law, span, start, slopes, x, active, room)
        _invert(room, n)
        size = _correct(room, n)
        largest = _error(x, room.r, active, span.deviates, room.v[MODULUS, 0])
        if not math.isfinite(largest):
            return x, -1
        part = 1.0
        for i in range(n):
            room.r[i, STEP] = room.r[i, CORRECTION]
        while True:
            new = evaluate(law, span, start, _moved(x, room.r, part, active, span.deviates), active, room)
            if largest <= LAST:
                return new, iteration
            _write(new, residual(new), active, span.deviates, room.r, OFF)
            if _correct(room, n) < size:
                break
            part *= 0.5
            if part < SHORTEST:
                return x, -1
        x = new
    return x, -1


@njit(**KERNEL)
def _neutral_alone(law: Parts, span: Span, start: np.ndarray, chi: float, room: Room) -> Unknowns:
    """κ of neutral loading, with its D ≥ 0 and q, at a given χ, near enough for Newton's method.

    |n| > k at κ = 0, which is elastic, and |n| < k at the material's κ: false position with halved weights (Illinois).
    """
    low, high = 0.0, functions(law.plastic, start[-1, WORK], span.temperature)[4]
    above, below, kappa = math.nan, math.nan, 0.5 * high
    at = Unknowns(0.0, kappa, 0.0, chi)
    for _ in range(MAX_ITERATIONS):
        x = evaluate(law, span, start, Unknowns(at.gain, kappa, at.q, chi), NEUTRAL, room)
        at = Unknowns(max(x.work, 0.0), kappa, ROOT * x.length, chi)
        x = evaluate(law, span, start, at, NEUTRAL, room)
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
def _deviating(
    law: Parts,
    span: Span,
    start: np.ndarray,
    slopes: np.ndarray,
    at: Unknowns,
    active: Active,
    room: Room,
) -> tuple[Values, Active, int]:
    """The end of a stage that flows with κ ≠ 0, from the unknowns of one that flows without.

    The kind of flow is that of λ = 0, or else, at the border of two kinds, another one.
    """
    x = evaluate(law, span, start, Unknowns(0.0, 0.0, 0.0, at.chi), FLOWING, room)
    x = evaluate(law, span, start, Unknowns(max(x.work, 0.0), 0.0, ROOT * x.length, at.chi), FLOWING, room)
    neutral, total = x.norm < x.k, 0
    for _ in range(2):
        first, frozen = at, False
        if neutral:
            first = _neutral_alone(law, span, start, at.chi, room)
            frozen = first.gain == 0.0
        for _ in range(2):
            active = Active(True, active.creep, neutral, frozen)
            gain = 0.0 if frozen else max(first.gain, LEAST * x.k * first.q)
            x, count = _together(law, span, start, slopes, Unknowns(gain, first.l, first.q, at.chi), active, room)
            total += max(count, 0)
            kappa = functions(law.plastic, x.b, span.temperature)[4]
            falls = not frozen or x.work <= SLIGHT * x.k * x.length
            if count >= 0 and falls and (not neutral or x.l <= kappa * (1.0 + SLIGHT)):
                return x, active, total
            frozen = not frozen
        neutral = not neutral
    return x, active, -1


@njit(**INLINE)
def solve(law: Parts, span: Span, start: np.ndarray, slopes: np.ndarray, room: Room) -> tuple[Values, Active, int]:
    """The end of a stage, and iterations, −1 if there is none."""
    chi, count = 0.0, 0
    if span.h > 0.0:
        chi, count = creep_alone(law, span, start, room)
    x = evaluate(law, span, start, Unknowns(0.0, 0.0, 0.0, chi), STILL, room)
    if count < 0 or x.norm <= x.k * (1.0 + 1e-12):
        return x, Active(False, chi > 0.0, False, False), count
    active = Active(True, chi > 0.0, False, False)
    gain, more = flow_alone(law, span, start, slopes, chi, room)
    if more < 0:
        return x, active, -1
    x = evaluate(law, _normal(span, span.reference), start, Unknowns(gain, 0.0, 0.0, chi), FLOWING, room)
    if active.creep or span.deviates:
        at = Unknowns(x.gain, x.l, x.q, x.chi)
        if span.deviates:
            x, active, last = _deviating(law, span, start, slopes, at, active, room)
        else:
            x, last = _together(law, span, start, slopes, at, active, room)
        if last < 0:
            return x, active, -1
        more += last
    return x, active, count + more


@njit(**INLINE)
def finish(
    law: Parts,
    span: Span,
    start: np.ndarray,
    slopes: np.ndarray,
    x: Values,
    active: Active,
    room: Room,
) -> None:
    """Replace the start of a stage and its slopes by those of its end."""
    n, size, count = room.v.shape[1], room.of.shape[1], _unknowns(active, span.deviates)
    _matrix(law, span, start, slopes, x, active, room)
    for k in range(n):
        of = differential(law, span, start, slopes, x, active, Change(k, 0.0, 0.0, 0.0, 0.0), room)
        _write(x, of, active, span.deviates, room.r, k)
        _keep(room, MOST + k)
    _eliminate(room.J, room.r, count, n)
    v, of_terms = room.v, room.of
    for k in range(n):
        for i in range(count):
            change = -room.r[i, k]
            for j in range(n):
                room.kept[MOST + k, 0, j] += change * room.kept[i, 0, j]
                room.kept[MOST + k, 1, j] += change * room.kept[i, 1, j]
            for j in range(size):
                room.kept_of[MOST + k, j] += change * room.kept_of[i, j]
        d_work = slopes[-1, WORK, k] - (x.gain * room.r[0, k] if active.flow and not active.frozen else 0.0)
        d_chi = -x.chi * room.r[count - 1, k] if active.creep else 0.0
        d_sigma = 0.0
        for j in range(n):
            d_stress, d_flow = room.kept[MOST + k, 0, j], room.kept[MOST + k, 1, j]
            slopes[0, j, k] = d_stress / v[MODULUS, j]
            slopes[CREEP, j, k] = d_chi * v[STRESS, j] + x.chi * d_stress
            d_sigma += v[METRIC, j] * v[STRESS, j] * d_stress
            for i in range(size):
                zeta, P = of_terms[ZETA, i], v[FLOW, j]
                grown = slopes[BACK + i, j, k] + of_terms[D_ZETA, i] * d_work * P + zeta * d_flow
                before = start[BACK + i, j] + zeta * P
                slopes[BACK + i, j, k] = of_terms[THETA, i] * grown + room.kept_of[MOST + k, i] * before
        slopes[-1, WORK, k] = d_work
        if active.creep:
            d_sigma *= 1.5 / x.sigma
            slopes[-1, CREPT, k] += x.creep.u_by_stress * d_sigma + x.creep.u_by_time * room.ways[2, 0, k]
    for j in range(n):
        start[0, j], start[CREEP, j] = room.v[STRESS, j] / room.v[MODULUS, j], x.chi * room.v[STRESS, j]
        for i in range(size):
            start[BACK + i, j] = room.of[THETA, i] * (start[BACK + i, j] + room.of[ZETA, i] * room.v[FLOW, j])
    start[-1, WORK] = x.b
    if active.creep:
        start[-1, CREPT] = x.creep.u
