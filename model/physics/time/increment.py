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

from coilset.model.core.material.law.functions import (
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
from coilset.model.core.material.law.parts import Parts, saturation
from coilset.model.core.material.point.groups import active
from coilset.model.core.material.point.groups import inner as inner_of_rod
from coilset.model.core.material.point.local import FAILED, TOO_HOT, yield_crossing
from coilset.model.core.runtime.kernels import INLINE, PASTED, njit
from coilset.model.physics.back_stresses.spin import Crossing, crossing_of_spin, spun
from coilset.model.physics.time.creep.flow import POWER, creep_strain, passes
from coilset.model.physics.time.stage import (
    BACK,
    CREEP,
    CREPT,
    ELASTIC,
    SCALARS,
    WORK,
    Active,
    Room,
    Stage,
    finish,
    inner,
    solve,
)

# What an increment is made of. law: Parts; h: time of creep; reference: ṗ₀ Δt, 0 without overstress; temperature at its
# start, and its change; heating, work, expansion, deviates: as in `Stage`; fading: see `_fading`; follows: whether the
# stress follows C(T) at once.
Increment = namedtuple("Increment", "law h reference temperature change heating work expansion fading follows deviates")
# A part of what lies before or beyond the yield surface: where in that it begins and ends, its length in the increment,
# and the slopes of this length by the strains, over `Room.before`.
Piece = namedtuple("Piece", "begin end length by")

GAMMA = 1.0 - math.sqrt(0.5)
AHEAD = (1.0 - GAMMA) / GAMMA
ROD = 3  # components
DIVISIONS = 6  # of an increment in halves
ROUNDING = 1e-9  # overstress, over the static surface, that is none
FADED, LONGER = 0.2, 3.0  # share of overstress, see `_fading`; how much longer the next piece ends


@njit(**PASTED)
def advance(law: Parts, old: np.ndarray, de: np.ndarray, new: np.ndarray, C: np.ndarray, room: np.ndarray) -> int:
    """One increment of strain and time.

    Args:
        law: Parts.
        old: the point's state at the start, as `groups` has it; behind b* the temperature, K, where the point
            has its own, the equivalent creep strain, where the material creeps, and all back stresses but the last, of
            which the columns of B have the sum. Not written.
        de: strain increment, shape (3,) or (6,), engineering shear strains, thermal strain
            included where the material creeps.
        new: the state at the end; written.
        C: dσ/dε, shape (3, 3) or (6, 6), N/mm²; written.
        room: work space, shape (1,) of ROOM; numba frees an array after its last use, and its record is used until the
            end: the caller keeps it, as an argument or over a loop.

    Returns:
        Number of local iterations, 0 for an elastic increment, -1 if there was no convergence, -2 if the point heated
        itself out of the material's table (then `new` is `old`).
    """
    w, n, p, q = room[0], de.shape[0], law.plastic, law.viscous
    w.components, w.terms = n, max(law.terms.shape[1], 1)
    own = old.shape[0] - (2 * n + 1) - n * (w.terms - 1)  # columns of temperature and creep
    start = old[2 * n + 1] if own > 0 else p[TEMPERATURE] - p[CHANGE]
    h, end = passes(q, start) if own > 1 and q[POWER] > 0.0 else (0.0, start + p[CHANGE])
    heating, follows = p[HEATING] if own > 0 else 0.0, own > 1
    E0, G0, alpha0 = elasticity(p, start if follows else 0.5 * (start + end))
    E1, G1, alpha1 = elasticity(p, end) if follows else (E0, G0, alpha0)
    alpha = 0.5 * (alpha0 + alpha1)
    thermal = alpha * (end - start) if follows else 0.0
    _metric(E0, G0, w)
    _start(old, de, own, q, w)
    if n == ROD:
        w.strain[0] -= thermal
    reference = 1.0 / p[RATE] if p[RATE] > 0.0 else 0.0
    fading = _fading(law, start, reference, w)
    if p[SPIN] != 0.0 and n == ROD:
        _spin(p, old, de, E0, G0, start, w)
    work = w.rows[SCALARS, WORK]
    expansion = alpha * heating if n == ROD else 0.0
    deviates = functions(p, work, start)[4] > 0.0
    of = Increment(law, h, reference, start, end - start, heating, work, expansion, fading, follows, deviates)
    count = _through(of, w)
    for i in range(len(new)):
        new[i] = old[i]
    if count < 0:
        return FAILED
    temperature = end + heating * (w.rows[SCALARS, WORK] - work)
    if heating > 0.0 and not inside_table(p, temperature):
        return TOO_HOT
    _metric(E1, G1, w)
    _end(own, q, w, new, C)
    if n > ROD:
        bulk0, bulk = E0 * G0 / (3.0 * (3.0 * G0 - E0)), E1 * G1 / (3.0 * (3.0 * G1 - E1))
        mean = (old[0] + old[1] + old[2]) / 3.0 * (bulk / bulk0)
        grown = 3.0 * (thermal + alpha * (temperature - end))
        mean += bulk * (de[0] + de[1] + de[2] - grown)
        for i in range(3):
            new[i] += mean
            for k in range(n):
                C[i, k] += bulk * ((1.0 if k < 3 else 0.0) - 3.0 * alpha * heating * w.slopes[SCALARS, WORK, k])
    if own > 0:
        new[2 * n + 1] = temperature
    return count


@njit(**INLINE)
def _metric(E: float, G: float, w: Room) -> None:
    """Write weights of the inner product, and moduli of the components of T."""
    n = w.components
    for j in range(n):
        w.metric[j] = 2.0 if n == ROD or j > 2 else 1.0
        w.modulus[j] = 2.0 * G
    if n == ROD:
        w.metric[0], w.modulus[0] = 1.5, E / 1.5


@njit(**INLINE)
def _start(state: np.ndarray, de: np.ndarray, own: int, q: np.ndarray, w: Room) -> None:
    """Write the strain of T over c and ē, the Bᵢ, b and u of a point's state, with their slopes by the strains."""
    n, last = w.components, w.terms - 1
    further = 2 * n + 1 + own
    mean = state[0] / 3.0 if n == ROD else (state[0] + state[1] + state[2]) / 3.0
    for j in range(n):
        normal = j < (1 if n == ROD else 3)
        w.strain[j] = w.before[j] = w.d_time[j] = w.rows[CREEP, j] = w.rows[SCALARS, j] = 0.0
        for k in range(n):
            w.unit[j, k] = (1.0 if normal else 0.5) if j == k else 0.0
            if n > ROD and normal and k < 3:
                w.unit[j, k] -= 1.0 / 3.0
            w.strain[j] += w.unit[j, k] * de[k]
        w.rows[ELASTIC, j] = (state[j] - (mean if normal else 0.0)) / w.modulus[j]
        w.rows[BACK + last, j] = state[n + j]
        for i in range(last):
            w.rows[BACK + i, j] = state[further + n * i + j]
            w.rows[BACK + last, j] -= w.rows[BACK + i, j]
        for i in range(BACK + w.terms):
            for k in range(n):
                w.slopes[i, j, k] = 0.0
        w.onset[j] = 0.0
        for k in range(n):
            w.d_onset[j, k] = 0.0
    for i in range(w.terms):
        w.fading[i] = w.d_fading[i] = 0.0
    w.rows[SCALARS, WORK] = state[2 * n]
    if own > 1 and q[POWER] > 0.0:
        w.rows[SCALARS, CREPT] = state[2 * n + 2] ** (1.0 / q[POWER])


@njit(**INLINE)
def _end(own: int, q: np.ndarray, w: Room, new: np.ndarray, C: np.ndarray) -> None:
    """Write the state, with the deviator of stress in the place of stress, and its slopes."""
    n, last = w.components, w.terms - 1
    for j in range(n):
        scale = w.modulus[j] * (1.5 if n == ROD and j == 0 else 1.0)
        new[j] = scale * w.rows[ELASTIC, j]
        for k in range(n):
            C[j, k] = scale * w.slopes[ELASTIC, j, k]
        new[n + j] = 0.0
        for i in range(w.terms):
            new[n + j] += w.rows[BACK + i, j]
            if i < last:
                new[2 * n + 1 + own + n * i + j] = w.rows[BACK + i, j]
    new[2 * n] = w.rows[SCALARS, WORK]
    if own > 1 and q[POWER] > 0.0:
        new[2 * n + 2] = w.rows[SCALARS, CREPT] ** q[POWER]


@njit(**INLINE)
def _copy(w: Room, rows: np.ndarray, slopes: np.ndarray, to_rows: np.ndarray, to_slopes: np.ndarray) -> None:
    for i in range(BACK + w.terms):
        for j in range(w.components):
            to_rows[i, j] = rows[i, j]
            for k in range(w.components):
                to_slopes[i, j, k] = slopes[i, j, k]


@njit(**PASTED)
def _spin(p: np.ndarray, old: np.ndarray, de: np.ndarray, E: float, G: float, temperature: float, w: Room) -> None:
    """Replace ē and the Bᵢ by those from which Hooke's law leads to the elastic response, with the spin (5.2.33)."""
    s, B = (old[0], old[1], old[2]), (old[3], old[4], old[5])
    n, k2 = active(s, B), functions(p, old[6], temperature)[0]
    crossing = Crossing(0.0, (0.0, 0.0, 0.0))
    if p[EXPONENT] == 0.0 or inner_of_rod(n, n) <= k2:
        crossing = crossing_of_spin(s, B, k2, E, G, (E * de[0] / 1.5, G * de[1], G * de[2]))
    c, rows, slopes = (E, 2.0 * G, 2.0 * G), w.rows, w.slopes
    for i in range(BACK, BACK + w.terms):
        B = (rows[i, 0], rows[i, 1], rows[i, 2])
        turned = spun(s, B, E, G, de[0], de[1], de[2], crossing)
        for j in range(3):
            rows[ELASTIC, j], rows[i, j] = turned.stress[j] / c[j], turned.back[j]
            for k in range(3):
                slopes[ELASTIC, j, k], slopes[i, j, k] = turned.d_stress[k][j] / c[j], turned.d_back[k][j]


@njit(**PASTED)
def _through(of: Increment, w: Room) -> int:
    """Replace the rows and slopes at the start of an increment by those at its end; as `advance`."""
    beta, count = _crossing(of, w), 0
    if of.h == 0.0 and (of.change == 0.0 or not of.follows):
        for j in range(w.components):
            w.rows[ELASTIC, j] += beta * w.strain[j]
            for k in range(w.components):
                w.slopes[ELASTIC, j, k] += beta * w.unit[j, k] + w.before[k] * w.strain[j]
        if beta == 1.0:
            return 0
        whole, last = Piece(0.0, 1.0, 1.0 - beta, -1.0), True
    elif 0.0 < beta < 1.0:
        whole, last = Piece(0.0, 1.0, beta, 1.0), False
    else:
        whole, last = Piece(0.0, 1.0, 1.0, 0.0), True
    while True:
        more = _pieces(of, whole, w)
        if more < 0:
            return more
        count += more
        if last:
            return count
        whole, last = Piece(0.0, 1.0, 1.0 - beta, -1.0), True


@njit(**INLINE)
def _n(w: Room, j: int) -> float:
    """A component of n."""
    n = w.modulus[j] * w.rows[ELASTIC, j]
    for i in range(BACK, BACK + w.terms):
        n -= w.rows[i, j]
    return n


@njit(**INLINE)
def _d_n(w: Room, j: int, k: int) -> float:
    """The slope of a component of n by a strain."""
    n = w.modulus[j] * w.slopes[ELASTIC, j, k]
    for i in range(BACK, BACK + w.terms):
        n -= w.slopes[i, j, k]
    return n


@njit(**INLINE)
def _crossing(of: Increment, w: Room) -> float:
    """Part of the increment in which the elastic path stays within the yield surface; its slopes are written.

    It is not divided where the stress follows a change of temperature at once, which no strain divides.
    """
    if of.follows and of.change != 0.0:
        return 0.0
    n, p = w.components, of.law.plastic
    for j in range(n):
        w.active[j], w.d_active[j] = _n(w, j), w.modulus[j] * w.strain[j]
    b = w.rows[SCALARS, WORK]
    k2 = functions(p, b, of.temperature)[0]
    growth = functions(p, b, of.temperature + of.change)[0] - k2 if of.change != 0.0 else 0.0
    nn, ne, ee = inner(w, w.active, w.active), inner(w, w.active, w.d_active), inner(w, w.d_active, w.d_active)
    if nn + 2.0 * ne + ee <= (k2 + growth) * (1.0 + 1e-12):
        return 1.0
    if p[EXPONENT] > 0.0 and nn > k2:  # overstress, which fades at once where no time passes
        return 0.0
    beta = yield_crossing(nn, ne - 0.5 * growth, ee, k2)
    steep = ne + beta * ee - 0.5 * growth
    if beta > 0.0 and steep > 0.0:
        for k in range(n):
            for j in range(n):
                change = _d_n(w, j, k) + beta * w.modulus[j] * w.unit[j, k]
                w.before[k] -= w.metric[j] * (w.active[j] + beta * w.d_active[j]) * change / steep
    return beta


@njit(**INLINE)
def _fading(law: Parts, temperature: float, reference: float, w: Room) -> float:
    """Part of the increment in which its first stage takes off a fifth of the overstress at its start.

    At constant strain v̇ = −R (v − 1)^m over the increment, with R = √1.5 ṗ₀ Δt (c + Σζᵢ + k k′)/k.
    """
    if reference == 0.0:
        return 1.0
    m = law.plastic[EXPONENT]
    for j in range(w.components):
        w.active[j] = _n(w, j)
    k2, dk2, zeta, _, _, _ = functions(law.plastic, w.rows[SCALARS, WORK], temperature)
    beyond = math.sqrt(inner(w, w.active, w.active) / k2) - 1.0
    if not beyond > ROUNDING:
        return 1.0
    for i in range(law.terms.shape[1]):
        zeta += saturation(law, i, temperature).zeta
    rate = math.sqrt(1.5 / k2) * reference * (w.modulus[1] + zeta + 0.5 * dk2) * beyond ** (m - 1.0)
    return min(FADED / (1.0 - FADED) ** m / (GAMMA * rate), 1.0) if rate > 0.0 else 1.0


@njit(**PASTED)
def _pieces(of: Increment, whole: Piece, w: Room) -> int:
    """A part of the increment: pieces that become longer as overstress fades, divided until all stages have an end."""
    _copy(w, w.rows, w.slopes, w.rows_of_part, w.slopes_of_part)
    first = of.fading / whole.length
    for division in range(DIVISIONS):
        count, begin, end = 0, 0.0, first
        while begin < 1.0:
            end = 1.0 if end * LONGER > 1.0 else end
            number = 2**division
            for i in range(number):
                part = (end - begin) / number
                at = begin + i * part
                more = _piece(of, Piece(at, at + part, part * whole.length, part * whole.by), w)
                count = count + more if more >= 0 and count >= 0 else FAILED
                if count < 0:
                    break
            if count < 0:
                break
            begin, end = end, end * LONGER
        if count >= 0:
            return count
        _copy(w, w.rows_of_part, w.slopes_of_part, w.rows, w.slopes)
    return FAILED


@njit(**INLINE)
def _piece(of: Increment, piece: Piece, w: Room) -> int:
    """Both stages."""
    _copy(w, w.rows, w.slopes, w.rows_of_piece, w.slopes_of_piece)
    stage, flowed, count = 0, False, 0
    while True:
        part, at = (1.0 if stage == 2 else GAMMA), (GAMMA if stage == 0 else 1.0)
        active, more = _stage(of, piece, part, at, flowed, w)
        if more < 0:
            return FAILED
        count += more
        again = active.neutral or (stage == 1 and flowed and not active.flow)
        if stage < 2 and again and of.h == 0.0:
            # neutral, whose κ needs n_β on the surface, or the second stage's start lies within: backward Euler for all
            _copy(w, w.rows_of_piece, w.slopes_of_piece, w.rows, w.slopes)
            stage, flowed = 2, False
        elif stage == 0:
            _lead(of, piece, w)
            stage, flowed = 1, active.flow
        else:
            return count


@njit(**INLINE)
def _stage(of: Increment, piece: Piece, part: float, at: float, flowed: bool, w: Room) -> tuple[Active, int]:
    """A stage as long as a part of the piece, which ends at a part of it; which unknowns it has, and iterations."""
    n, length, by, law = w.components, part * piece.length, part * piece.by, of.law
    temperature = of.temperature + (piece.begin + at * (piece.end - piece.begin)) * of.change
    if of.follows and of.change != 0.0:
        E, G, _ = elasticity(law.plastic, temperature)
        _metric(E, G, w)
    for j in range(n):
        c, e = w.modulus[j], w.strain[j]
        w.trial[j] = c * (w.rows[ELASTIC, j] + length * e)
        w.d_time[j] = piece.by * w.before[j] / piece.length
        for k in range(n):
            w.d_trial[j, k] = c * (w.slopes[ELASTIC, j, k] + length * w.unit[j, k] + by * w.before[k] * e)
    if of.deviates:
        _onset(law, of.temperature + piece.begin * of.change, flowed, w)
    stage = Stage(
        law, length * of.h, length * of.reference, temperature, of.work, of.heating, of.expansion, of.deviates
    )
    values, active, count = solve(stage, w)
    if count >= 0:
        finish(stage, values, active, w)
    return active, count


@njit(**INLINE)
def _onset(law: Parts, temperature: float, flowed: bool, w: Room) -> None:
    """Write n_β and its slopes: n at the start of the stage, or where the elastic path crosses the yield surface."""
    n, beta, steep = w.components, 0.0, 0.0
    for j in range(n):
        w.active[j] = _n(w, j)
        w.d_active[j] = w.trial[j] - w.modulus[j] * w.rows[ELASTIC, j]
    if not flowed:
        nn, ne, ee = inner(w, w.active, w.active), inner(w, w.active, w.d_active), inner(w, w.d_active, w.d_active)
        k2 = functions(law.plastic, w.rows[SCALARS, WORK], temperature)[0]
        beta = yield_crossing(nn, ne, ee, k2) if nn + 2.0 * ne + ee > k2 else 1.0 if nn < k2 else 0.0
        steep = ne + beta * ee
    for j in range(n):
        w.onset[j] = w.active[j] + beta * w.d_active[j]
    for k in range(n):
        along = 0.0
        for j in range(n):
            elastic = w.modulus[j] * w.slopes[ELASTIC, j, k]
            w.d_onset[j, k] = _d_n(w, j, k) + beta * (w.d_trial[j, k] - elastic)
            along += w.metric[j] * w.onset[j] * w.d_onset[j, k]
        if 0.0 < beta < 1.0 and steep > 0.0:
            for j in range(n):
                w.d_onset[j, k] -= along / steep * w.d_active[j]


@njit(**INLINE)
def _lead(of: Increment, piece: Piece, w: Room) -> None:
    """Replace the first stage's end by where its rates lead in the time before the second one."""
    n, rows, slopes, before, d_before = w.components, w.rows, w.slopes, w.rows_of_piece, w.slopes_of_piece
    if of.h > 0.0:
        _lead_creep(of, (1.0 - GAMMA) * piece.length * of.h, w)
    for i in range(BACK + w.terms):
        for j in range(n):
            rows[i, j] = before[i, j] + AHEAD * (rows[i, j] - before[i, j])
            for k in range(n):
                slopes[i, j, k] = d_before[i, j, k] + AHEAD * (slopes[i, j, k] - d_before[i, j, k])


@njit(**INLINE)
def _lead_creep(of: Increment, h: float, w: Room) -> None:
    """Replace the creep strain of the first stage, times AHEAD, by that of its stress in the time h."""
    n, rows, slopes, u, d_u = w.components, w.rows, w.slopes, w.rows_of_piece, w.slopes_of_piece
    for j in range(n):
        w.stress[j] = w.modulus[j] * rows[ELASTIC, j]
    sigma = math.sqrt(1.5 * inner(w, w.stress, w.stress))
    creep = creep_strain(of.law.viscous, sigma, u[SCALARS, CREPT], h)
    chi = 1.5 * creep.strain / sigma if creep.strain > 0.0 else 0.0
    for k in range(n):
        d_sigma = 0.0
        for j in range(n):
            w.d_stress[j] = w.modulus[j] * slopes[ELASTIC, j, k]
            d_sigma += 1.5 * w.metric[j] * w.stress[j] * w.d_stress[j]
        d_sigma = d_sigma / sigma if sigma > 0.0 else 0.0
        d_chi = 0.0
        if chi > 0.0:
            d_creep = creep.by_stress * d_sigma + creep.by_start * d_u[SCALARS, CREPT, k] + creep.by_time * w.d_time[k]
            d_chi = chi * (d_creep / creep.strain - d_sigma / sigma)
        for j in range(n):
            crept = chi * w.d_stress[j] + d_chi * w.stress[j]
            slopes[ELASTIC, j, k] += slopes[CREEP, j, k] - crept / AHEAD
            slopes[CREEP, j, k] = 0.0
    for j in range(n):
        rows[ELASTIC, j] += rows[CREEP, j] - chi * w.stress[j] / AHEAD
        rows[CREEP, j] = 0.0
