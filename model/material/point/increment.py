"""An increment of the point problem: two stages of an L-stable Runge-Kutta method of second order, with the tangent.

The method is diagonally implicit, γ = 1 − 1/√2 (R. Alexander, SIAM J. Numer. Anal. 14, 1977). Its first stage ends at
the part γ of the increment; where its rates lead in the next 1 − γ, the second one starts, again of length γ. Creep
from there to the first stage's end is that of a constant stress, so that it is exact where the stress stays.

An increment that leaves the yield surface is divided where the elastic path crosses it; the part before only creeps.
Where Newton's method fails in a stage, the increment is divided in two, four and so on. Slopes by the strains of the
increment are carried along from stage to stage, which makes the tangent that of the whole.
"""

import math
from collections import namedtuple

import numpy as np

from coilset.model.base.kernel import INLINE, KERNEL
from coilset.model.material.creep.flow import POWER, creep_strain, passes
from coilset.model.material.law.functions import (
    CHANGE,
    EXPONENT,
    HEATING,
    RATE,
    SPIN,
    TEMPERATURE,
    elasticity,
    functions,
    inside_table,
)
from coilset.model.material.law.parts import Parts, saturation
from coilset.model.material.point.local import FAILED, TOO_HOT, yield_crossing
from coilset.model.material.point.rod import active
from coilset.model.material.point.rod import inner as inner_of_rod
from coilset.model.material.point.spin import Crossing, crossing_of_spin, spun
from coilset.model.material.point.stage import (
    ACTIVE,
    BACK,
    CREEP,
    CREPT,
    D_ACTIVE,
    D_STRESS,
    METRIC,
    MODULUS,
    MOST,
    ONSET,
    STRESS,
    TERMS,
    TRIAL,
    VECTORS,
    WORK,
    Active,
    Room,
    Span,
    finish,
    inner,
    solve,
)
from coilset.model.runtime.kernels import njit

# What an increment is made of. h: time of creep; reference: ṗ₀ Δt, 0 without overstress; temperature at its start, and
# its change; heating, work: as in `Span`; expansion: α of it in the rod; fading: see
# `_fading`; follows: whether the stress follows C(T) at
# once; strain: that of T, over c; unit: its slopes by the strains.
Increment = namedtuple(
    "Increment", "h reference temperature change heating work expansion fading follows deviates strain unit"
)
# A part of what lies before or beyond the yield surface: where in that it begins and ends, its length in the increment,
# and the slopes of this length by the strains.
Piece = namedtuple("Piece", "begin end length by")

GAMMA = 1.0 - math.sqrt(0.5)
AHEAD = (1.0 - GAMMA) / GAMMA
ROD = 3  # components
DIVISIONS = 6  # of an increment in halves
ROUNDING = 1e-9  # overstress, over the static surface, that is none
FADED, LONGER = 0.2, 3.0  # share of overstress, see `_fading`; how much longer the next piece ends


@njit(**KERNEL)
def advance(law: Parts, old: np.ndarray, de: np.ndarray, new: np.ndarray, C: np.ndarray) -> int:
    """One increment of strain and time.

    Args:
        law: Parts.
        old: the point's state at the start, as `rod` or `solid` have it; behind b* the temperature, K, where the point
            has its own, the equivalent creep strain, where the material creeps, and all back stresses but the last, of
            which the columns of B have the sum. Not written.
        de: strain increment, shape (3,) as in `rod` or (6,) as in `solid`, engineering shear strains, thermal strain
            included where the material creeps.
        new: the state at the end; written.
        C: dσ/dε, shape (3, 3) or (6, 6), N/mm²; written.

    Returns:
        Number of local iterations, 0 for an elastic increment, -1 if there was no convergence, -2 if the point heated
        itself out of the material's table (then `new` is `old`).
    """
    n, terms = de.shape[0], max(law.terms.shape[1], 1)
    own = old.shape[0] - (2 * n + 1) - n * (terms - 1)  # columns of temperature and creep
    p, q = law.plastic, law.viscous
    start = old[2 * n + 1] if own > 0 else p[TEMPERATURE] - p[CHANGE]
    h, end = passes(q, start) if own > 1 and q[POWER] > 0.0 else (0.0, start + p[CHANGE])
    heating, follows = p[HEATING] if own > 0 else 0.0, own > 1
    E0, G0, alpha0 = elasticity(p, start if follows else 0.5 * (start + end))
    E1, G1, alpha1 = elasticity(p, end) if follows else (E0, G0, alpha0)
    alpha = 0.5 * (alpha0 + alpha1)
    thermal = alpha * (end - start) if follows else 0.0
    room = _room(n, terms)
    _metric(n, E0, G0, room)
    rows, slopes, unit, e = np.zeros((terms + 3, n)), np.zeros((terms + 3, n, n)), np.zeros((n, n)), np.empty(n)
    _unit(n, unit)
    for j in range(n):
        e[j] = 0.0
        for k in range(n):
            e[j] += unit[j, k] * de[k]
    if n == ROD:
        e[0] -= thermal
    _unpack(old, own, q, room.v, rows)
    reference = 1.0 / p[RATE] if p[RATE] > 0.0 else 0.0
    fading = _fading(law, start, reference, rows, room)
    if p[SPIN] != 0.0 and n == ROD:
        _spin(p, old, de, E0, G0, start, rows, slopes)
    work = rows[-1, WORK]
    expansion = alpha * heating if n == ROD else 0.0
    deviates = functions(p, work, start)[4] > 0.0
    of = Increment(h, reference, start, end - start, heating, work, expansion, fading, follows, deviates, e, unit)
    count = _through(law, of, rows, slopes, room)
    new[:] = old
    if count < 0:
        return FAILED
    temperature = end + heating * (rows[-1, WORK] - work)
    if heating > 0.0 and not inside_table(p, temperature):
        return TOO_HOT
    _metric(n, E1, G1, room)
    _pack(rows, slopes, own, q, room.v, new, C)
    if n > ROD:
        bulk0, bulk = E0 * G0 / (3.0 * (3.0 * G0 - E0)), E1 * G1 / (3.0 * (3.0 * G1 - E1))
        mean = (old[0] + old[1] + old[2]) / 3.0 * (bulk / bulk0)
        grown = 3.0 * (thermal + alpha * (temperature - end))
        mean += bulk * (de[0] + de[1] + de[2] - grown)
        for i in range(3):
            new[i] += mean
            for k in range(n):
                C[i, k] += bulk * ((1.0 if k < 3 else 0.0) - 3.0 * alpha * heating * slopes[-1, WORK, k])
    if own > 0:
        new[2 * n + 1] = temperature
    return count


@njit(**INLINE)
def _room(n: int, terms: int) -> Room:
    """Arrays of a stage."""
    return Room(
        np.zeros((VECTORS, n)),
        np.zeros((TERMS, terms)),
        np.empty((MOST, MOST)),
        np.empty((MOST, MOST + 3)),
        np.zeros((3, n, n)),
        np.empty((MOST + n, 2, n)),
        np.empty((MOST + n, terms)),
    )


@njit(**INLINE)
def _copied(rows: np.ndarray, slopes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    a, b = np.empty(rows.shape), np.empty(slopes.shape)
    _copy(rows, slopes, a, b)
    return a, b


@njit(**INLINE)
def _copy(rows: np.ndarray, slopes: np.ndarray, to_rows: np.ndarray, to_slopes: np.ndarray) -> None:
    a, b = rows.reshape(-1), to_rows.reshape(-1)
    for i in range(a.shape[0]):
        b[i] = a[i]
    a, b = slopes.reshape(-1), to_slopes.reshape(-1)
    for i in range(a.shape[0]):
        b[i] = a[i]


@njit(**INLINE)
def _metric(n: int, E: float, G: float, room: Room) -> None:
    """Write weights of the inner product, and moduli of the components of T."""
    for j in range(n):
        room.v[METRIC, j] = 2.0 if n == ROD or j > 2 else 1.0
        room.v[MODULUS, j] = 2.0 * G
    if n == ROD:
        room.v[METRIC, 0], room.v[MODULUS, 0] = 1.5, E / 1.5


@njit(**INLINE)
def _unit(n: int, unit: np.ndarray) -> None:
    """Strains of T over c, by the strains."""
    if n == ROD:
        unit[0, 0] = 1.0
    else:
        for i in range(3):
            for j in range(3):
                unit[i, j] = -1.0 / 3.0
            unit[i, i] += 1.0
    for i in range(n - (2 if n == ROD else 3), n):
        unit[i, i] = 0.5


@njit(**INLINE)
def _unpack(state: np.ndarray, own: int, q: np.ndarray, v: np.ndarray, rows: np.ndarray) -> None:
    """Write ē, the Bᵢ, b and u of a point's state."""
    n, last = rows.shape[1], rows.shape[0] - 3
    further = 2 * n + 1 + own
    mean = state[0] / 3.0 if n == ROD else (state[0] + state[1] + state[2]) / 3.0
    for j in range(n):
        rows[0, j] = (state[j] - (mean if j < (1 if n == ROD else 3) else 0.0)) / v[MODULUS, j]
        rows[last, j] = state[n + j]
        for i in range(last - 1):
            rows[BACK + i, j] = state[further + n * i + j]
            rows[last, j] -= rows[BACK + i, j]
    rows[-1, WORK] = state[2 * n]
    if own > 1 and q[POWER] > 0.0:
        rows[-1, CREPT] = state[2 * n + 2] ** (1.0 / q[POWER])


@njit(**INLINE)
def _pack(
    rows: np.ndarray, slopes: np.ndarray, own: int, q: np.ndarray, v: np.ndarray, new: np.ndarray, C: np.ndarray
) -> None:
    """Write the state, with the deviator of stress in the place of stress, and its slopes."""
    n, last = rows.shape[1], rows.shape[0] - 3
    for j in range(n):
        scale = v[MODULUS, j] * (1.5 if n == ROD and j == 0 else 1.0)
        new[j] = scale * rows[0, j]
        for k in range(n):
            C[j, k] = scale * slopes[0, j, k]
        new[n + j] = 0.0
        for i in range(last):
            new[n + j] += rows[BACK + i, j]
            if i < last - 1:
                new[2 * n + 1 + own + n * i + j] = rows[BACK + i, j]
    new[2 * n] = rows[-1, WORK]
    if own > 1 and q[POWER] > 0.0:
        new[2 * n + 2] = rows[-1, CREPT] ** q[POWER]


@njit(**KERNEL)
def _spin(
    p: np.ndarray,
    old: np.ndarray,
    de: np.ndarray,
    E: float,
    G: float,
    temperature: float,
    rows: np.ndarray,
    slopes: np.ndarray,
) -> None:
    """Replace ē and the Bᵢ by those from which Hooke's law leads to the elastic response, with the spin (5.2.33)."""
    s, B = (old[0], old[1], old[2]), (old[3], old[4], old[5])
    n, k2 = active(s, B), functions(p, old[6], temperature)[0]
    crossing = Crossing(0.0, (0.0, 0.0, 0.0))
    if p[EXPONENT] == 0.0 or inner_of_rod(n, n) <= k2:
        crossing = crossing_of_spin(s, B, k2, E, G, (E * de[0] / 1.5, G * de[1], G * de[2]))
    c = (E, 2.0 * G, 2.0 * G)
    for i in range(rows.shape[0] - 3):
        B = (rows[BACK + i, 0], rows[BACK + i, 1], rows[BACK + i, 2])
        turned = spun(s, B, E, G, de[0], de[1], de[2], crossing)
        for j in range(3):
            rows[0, j], rows[BACK + i, j] = turned.stress[j] / c[j], turned.back[j]
            slopes[0, j, 0], slopes[BACK + i, j, 0] = turned.d_stress[0][j] / c[j], turned.d_back[0][j]
            slopes[0, j, 1], slopes[BACK + i, j, 1] = turned.d_stress[1][j] / c[j], turned.d_back[1][j]
            slopes[0, j, 2], slopes[BACK + i, j, 2] = turned.d_stress[2][j] / c[j], turned.d_back[2][j]


@njit(**INLINE)
def _through(law: Parts, of: Increment, rows: np.ndarray, slopes: np.ndarray, room: Room) -> int:
    """Replace the rows and slopes at the start of an increment by those at its end; as `advance`."""
    n = rows.shape[1]
    by = np.zeros(n)  # slopes of the part before the yield surface
    beta, count = _crossing(law, of, rows, slopes, by, room), 0
    if of.h == 0.0 and (of.change == 0.0 or not of.follows):
        for j in range(n):
            rows[0, j] += beta * of.strain[j]
            for k in range(n):
                slopes[0, j, k] += beta * of.unit[j, k] + by[k] * of.strain[j]
        if beta == 1.0:
            return 0
        whole, last = Piece(0.0, 1.0, 1.0 - beta, -by), True
    elif 0.0 < beta < 1.0:
        whole, last = Piece(0.0, 1.0, beta, by), False
    else:
        by[:] = 0.0
        whole, last = Piece(0.0, 1.0, 1.0, by), True
    while True:
        more = _pieces(law, of, whole, rows, slopes, room)
        if more < 0:
            return more
        count += more
        if last:
            return count
        whole, last = Piece(0.0, 1.0, 1.0 - beta, -by), True


@njit(**INLINE)
def _active(v: np.ndarray, rows: np.ndarray, j: int) -> float:
    """A component of n."""
    n = v[MODULUS, j] * rows[0, j]
    for i in range(rows.shape[0] - 3):
        n -= rows[BACK + i, j]
    return n


@njit(**INLINE)
def _crossing(law: Parts, of: Increment, rows: np.ndarray, slopes: np.ndarray, by: np.ndarray, room: Room) -> float:
    """Part of the increment in which the elastic path stays within the yield surface; its slopes are written to `by`.

    It is not divided where the stress follows a change of temperature at once, which no strain divides.
    """
    n, v = rows.shape[1], room.v
    if of.follows and of.change != 0.0:
        return 0.0
    for j in range(n):
        room.v[ACTIVE, j], room.v[D_ACTIVE, j] = _active(v, rows, j), v[MODULUS, j] * of.strain[j]
    b = rows[-1, WORK]
    k2 = functions(law.plastic, b, of.temperature)[0]
    growth = functions(law.plastic, b, of.temperature + of.change)[0] - k2 if of.change != 0.0 else 0.0
    nn, ne = inner(room.v, ACTIVE, ACTIVE), inner(room.v, ACTIVE, D_ACTIVE)
    ee = inner(room.v, D_ACTIVE, D_ACTIVE)
    if nn + 2.0 * ne + ee <= (k2 + growth) * (1.0 + 1e-12):
        return 1.0
    if law.plastic[EXPONENT] > 0.0 and nn > k2:  # overstress, which fades at once where no time passes
        return 0.0
    beta = yield_crossing(nn, ne - 0.5 * growth, ee, k2)
    steep = ne + beta * ee - 0.5 * growth
    if beta > 0.0 and steep > 0.0:
        for k in range(n):
            for j in range(n):
                change = _active(v, slopes[:, :, k], j) + beta * v[MODULUS, j] * of.unit[j, k]
                by[k] -= room.v[METRIC, j] * (room.v[ACTIVE, j] + beta * room.v[D_ACTIVE, j]) * change / steep
    return beta


@njit(**INLINE)
def _fading(law: Parts, temperature: float, reference: float, rows: np.ndarray, room: Room) -> float:
    """Part of the increment in which its first stage takes off a fifth of the overstress at its start.

    At constant strain v̇ = −R (v − 1)^m over the increment, with R = √1.5 ṗ₀ Δt (c + Σζᵢ + k k′)/k.
    """
    if reference == 0.0:
        return 1.0
    n, m = rows.shape[1], law.plastic[EXPONENT]
    for j in range(n):
        room.v[ACTIVE, j] = _active(room.v, rows, j)
    k2, dk2, zeta, _, _, _ = functions(law.plastic, rows[-1, WORK], temperature)
    beyond = math.sqrt(inner(room.v, ACTIVE, ACTIVE) / k2) - 1.0
    if not beyond > ROUNDING:
        return 1.0
    for i in range(law.terms.shape[1]):
        zeta += saturation(law, i, temperature).zeta
    rate = math.sqrt(1.5 / k2) * reference * (room.v[MODULUS, 1] + zeta + 0.5 * dk2) * beyond ** (m - 1.0)
    return min(FADED / (1.0 - FADED) ** m / (GAMMA * rate), 1.0) if rate > 0.0 else 1.0


@njit(**INLINE)
def _pieces(law: Parts, of: Increment, whole: Piece, rows: np.ndarray, slopes: np.ndarray, room: Room) -> int:
    """A part of the increment: pieces that become longer as overstress fades, divided until all stages have an end."""
    before, slopes_before = _copied(rows, slopes)
    first = of.fading / whole.length
    for division in range(DIVISIONS):
        count, begin, end = 0, 0.0, first
        while begin < 1.0:
            end = 1.0 if end * LONGER > 1.0 else end
            number = 2**division
            for i in range(number):
                part = (end - begin) / number
                at = begin + i * part
                piece = Piece(at, at + part, part * whole.length, part * whole.by)
                more = _piece(law, of, piece, rows, slopes, room)
                count = count + more if more >= 0 and count >= 0 else FAILED
                if count < 0:
                    break
            if count < 0:
                break
            begin, end = end, end * LONGER
        if count >= 0:
            return count
        _copy(before, slopes_before, rows, slopes)
    return FAILED


@njit(**INLINE)
def _piece(law: Parts, of: Increment, piece: Piece, rows: np.ndarray, slopes: np.ndarray, room: Room) -> int:
    """Both stages."""
    before, slopes_before = _copied(rows, slopes)
    stage, flowed, count = 0, False, 0
    while True:
        part, at = (1.0 if stage == 2 else GAMMA), (GAMMA if stage == 0 else 1.0)
        active, more = _stage(law, of, piece, (part, at), flowed, rows, slopes, room)
        if more < 0:
            return FAILED
        count += more
        again = active.neutral or (stage == 1 and flowed and not active.flow)
        if stage < 2 and again and of.h == 0.0:
            # neutral, whose κ needs n_β on the surface, or the second stage's start lies within: backward Euler for all
            _copy(before, slopes_before, rows, slopes)
            stage, flowed = 2, False
        elif stage == 0:
            _lead(law, of, piece, before, slopes_before, rows, slopes, room)
            stage, flowed = 1, active.flow
        else:
            return count


@njit(**INLINE)
def _stage(
    law: Parts,
    of: Increment,
    piece: Piece,
    part: tuple[float, float],
    flowed: bool,
    rows: np.ndarray,
    slopes: np.ndarray,
    room: Room,
) -> tuple[Active, int]:
    """A stage as long as a part of the piece, and where in it it ends; which unknowns it has, and iterations."""
    n, length = rows.shape[1], part[0] * piece.length
    temperature = of.temperature + (piece.begin + part[1] * (piece.end - piece.begin)) * of.change
    if of.follows and of.change != 0.0:
        E, G, _ = elasticity(law.plastic, temperature)
        _metric(n, E, G, room)
    v, ways = room.v, room.ways
    for j in range(n):
        room.v[TRIAL, j] = v[MODULUS, j] * (rows[0, j] + length * of.strain[j])
        for k in range(n):
            by = part[0] * piece.by[k]
            ways[0, j, k] = v[MODULUS, j] * (slopes[0, j, k] + length * of.unit[j, k] + by * of.strain[j])
            ways[2, j, k] = piece.by[k] / piece.length
    if of.deviates:
        _onset(law, of.temperature + piece.begin * of.change, flowed, rows, slopes, room)
    span = Span(length * of.h, length * of.reference, temperature, of.work, of.heating, of.expansion, of.deviates)
    values, active, count = solve(law, span, rows, slopes, room)
    if count >= 0:
        finish(law, span, rows, slopes, values, active, room)
    return active, count


@njit(**INLINE)
def _onset(law: Parts, temperature: float, flowed: bool, rows: np.ndarray, slopes: np.ndarray, room: Room) -> None:
    """Write n_β and its slopes: n at the start of the stage, or where the elastic path crosses the yield surface."""
    n, v, ways, beta, steep = rows.shape[1], room.v, room.ways, 0.0, 0.0
    for j in range(n):
        room.v[ACTIVE, j] = _active(v, rows, j)
        room.v[D_ACTIVE, j] = room.v[TRIAL, j] - v[MODULUS, j] * rows[0, j]
    if not flowed:
        nn, ne = inner(room.v, ACTIVE, ACTIVE), inner(room.v, ACTIVE, D_ACTIVE)
        ee, k2 = inner(room.v, D_ACTIVE, D_ACTIVE), functions(law.plastic, rows[-1, WORK], temperature)[0]
        beta = yield_crossing(nn, ne, ee, k2) if nn + 2.0 * ne + ee > k2 else 1.0 if nn < k2 else 0.0
        steep = ne + beta * ee
    for j in range(n):
        room.v[ONSET, j] = room.v[ACTIVE, j] + beta * room.v[D_ACTIVE, j]
    for k in range(n):
        along = 0.0
        for j in range(n):
            elastic = v[MODULUS, j] * slopes[0, j, k]
            ways[1, j, k] = _active(v, slopes[:, :, k], j) + beta * (ways[0, j, k] - elastic)
            along += room.v[METRIC, j] * room.v[ONSET, j] * ways[1, j, k]
        if 0.0 < beta < 1.0 and steep > 0.0:
            for j in range(n):
                ways[1, j, k] -= along / steep * room.v[D_ACTIVE, j]


@njit(**INLINE)
def _lead(
    law: Parts,
    of: Increment,
    piece: Piece,
    before: np.ndarray,
    slopes_before: np.ndarray,
    rows: np.ndarray,
    slopes: np.ndarray,
    room: Room,
) -> None:
    """Replace the first stage's end by where its rates lead in the time before the second one."""
    n, last = rows.shape[1], rows.shape[0] - 1
    h = (1.0 - GAMMA) * piece.length * of.h
    for j in range(n):
        room.v[STRESS, j] = room.v[MODULUS, j] * rows[0, j]
    sigma = math.sqrt(1.5 * inner(room.v, STRESS, STRESS))
    creep = creep_strain(law.viscous, sigma, before[last, CREPT], h)
    chi = 1.5 * creep.strain / sigma if creep.strain > 0.0 else 0.0
    for k in range(n if of.h > 0.0 else 0):
        d_sigma = 0.0
        for j in range(n):
            room.v[D_STRESS, j] = room.v[MODULUS, j] * slopes[0, j, k]
            d_sigma += 1.5 * room.v[METRIC, j] * room.v[STRESS, j] * room.v[D_STRESS, j]
        d_sigma = d_sigma / sigma if sigma > 0.0 else 0.0
        d_chi = 0.0
        if chi > 0.0:
            d_creep = creep.by_stress * d_sigma + creep.by_start * slopes_before[last, CREPT, k]
            d_creep += creep.by_time * piece.by[k] / piece.length
            d_chi = chi * (d_creep / creep.strain - d_sigma / sigma)
        for j in range(n):  # in the first stage's creep strain, times AHEAD, from here on stands that of its stress
            crept = chi * room.v[D_STRESS, j] + d_chi * room.v[STRESS, j]
            slopes[0, j, k] += slopes[CREEP, j, k] - crept / AHEAD
            slopes[CREEP, j, k] = 0.0
    for j in range(n if of.h > 0.0 else 0):
        rows[0, j] += rows[CREEP, j] - chi * room.v[STRESS, j] / AHEAD
        rows[CREEP, j] = 0.0
    a, b = before.reshape(-1), rows.reshape(-1)
    for i in range(a.shape[0]):
        b[i] = a[i] + AHEAD * (b[i] - a[i])
    a, b = slopes_before.reshape(-1), slopes.reshape(-1)
    for i in range(a.shape[0]):
        b[i] = a[i] + AHEAD * (b[i] - a[i])
