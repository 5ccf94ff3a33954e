"""Increments of points whose back stresses saturate: both stages of `increment` by one unknown each, at many points.

No time passes, the temperature stays, flow is normal to the yield surface. Each Bᵢ = θᵢ (Bᵢ* + ζᵢ P) is linear in the
stage's plastic strain P = λ n, so that the back stresses leave the stage's equations (static condensation):

    n = (T_trial − Σ θᵢ Bᵢ*)/(1 + (c + Z) λ),   Z = Σ θᵢ ζᵢ,   λ = D/k²,   q = √⅔ D/k,   |n| = k(b* + D).

D alone is left. k/|n| − 1 is linear in D while k and the θᵢ stay, and Newton's method goes by it; its last correction
is made to all that follows from D. With n = f A and H = c + Z, slopes of n in q and, with the other sign, in λ are

    a = f (Σ γᵢθᵢ² Bᵢ* − λ dZ n),   h = f H n,   dZ = −Σ γᵢθᵢ² ζᵢ.

Towards strains a stage gives dP = λ f dA + u dD, a diagonal and a dyad. The second one (index 2) starts where the rates
of the first lead in the rest of the increment, AHEAD times as far, which changes Σ θᵢ Bᵢ* by

    AHEAD (Σ θᵢ₂ θᵢ₁ ζᵢ dP₁ − Σ θᵢ₂ θᵢ₁ γᵢ Bᵢ₁ dq₁),

and the tangent of the whole is a diagonal and three dyads, by β, D₁ and D₂.

Points are processed in rows, as in `local_rows`; those of which a stage does not flow or finds no end are left to
`increment.advance`; both give the same numbers.
"""

import math

import numpy as np

from coilset.model.core.material.law.functions import (
    CHANGE,
    EXPONENT,
    HEATING,
    KAPPA,
    N_ROWS,
    ROW_LENGTH,
    ROWS_START,
    SPIN,
)
from coilset.model.core.material.law.parts import MOST_TERMS, Parts, saturation
from coilset.model.core.material.point.groups import (
    BACK,
    DIAGONAL,
    LARGEST,
    LEFT,
    NORMAL,
    OTHERS,
    RIGHT,
    STRAIN,
    STRESS,
    Components,
    keep,
    modulus,
    of_stress,
    products,
    respond,
    share,
    weight,
)
from coilset.model.core.material.point.local import yield_crossing
from coilset.model.core.material.point.local_rows import ENDED, GROUP, K2, WORK, Points, group_from, harden
from coilset.model.core.runtime.kernels import INLINE, KERNEL, njit
from coilset.model.physics.time.creep.flow import POWER
from coilset.model.physics.time.increment import AHEAD, GAMMA
from coilset.model.physics.time.overstress import ROOT

MAX_ITERATIONS = 12
FINE = 1e-6  # of |n| over k: after a correction of that size no other is left

# Rows of a stage. D, its correction, whether the iteration goes on; b*; k² and its slope, in whose place k's is kept; k
# and 1/k, λ, q, Z, dZ, |n| and the slope of |n| in D; whether a stage has no end.
D, STEP, OPEN, AT, SQUARE, DK, K, INVERSE, L, Q, Z, DZ, NORM, SLOPE, LEFT_OUT = range(OTHERS, OTHERS + 15)
# What the tangent takes of the first stage: q and its slope in D; its length in the increment; and Σ θᵢ₂ θᵢ₁ ζᵢ.
FIRST_Q, FIRST_SLOPE, LENGTH, SHIFT = range(OTHERS + 15, OTHERS + 19)
# By component: T_trial, f, a; λ f, u and the slope of D of the first stage; what its length takes by the strains, from
# β; Σ θᵢ₂ θᵢ₁ γᵢ Bᵢ₁; the Bᵢ₁.
VECTORS = OTHERS + 19
TRIAL, F, A, FIRST_P, FIRST_U, FIRST_D, CROSSING, TURN, ENDS = range(VECTORS, VECTORS + 9 * LARGEST, LARGEST)
ROWS = ENDS + MOST_TERMS * LARGEST


@njit(**INLINE)
def applies(law: Parts) -> bool:
    """Whether a law has back stresses that saturate, and nothing happens but flow along n."""
    p = law.plastic
    still = (p[CHANGE] == 0.0) & (p[HEATING] == 0.0) & (law.viscous[POWER] == 0.0)
    for row in range(int(p[N_ROWS])):
        still = still & (p[ROWS_START + row * ROW_LENGTH + KAPPA] == 0.0)
    return (law.terms.shape[1] > 0) & still & (p[SPIN] == 0.0) & (p[EXPONENT] == 0.0)


@njit(**KERNEL)
def flow_points(
    law: Parts,
    components: Components,
    old: np.ndarray,
    de: np.ndarray,
    new: np.ndarray,
    tangent: np.ndarray,
    with_tangent: bool,
    count: np.ndarray,
) -> bool:
    """One increment at many points, where `applies`; as `return_map.flow_points`, with all back stresses.

    The iterations are those of both stages, -1 if a point is left to `increment.advance`, where
    neither its state nor its tangent counts.
    """
    good, first, n, terms = True, 0, len(components), law.terms.shape[1]
    w, place = np.empty((ROWS, GROUP)), np.empty(GROUP, np.uint64)
    while first < old.shape[0]:
        of = group_from(law.plastic, old[:, : old.shape[1] - n * (terms - 1)], first, 2 * n + 1)
        flow, whole = respond(law.plastic, of, components, old, de, new, tangent, with_tangent, place, w)
        first += of.size
        count[of.first : first] = 0
        if flow > 0:
            _separate(of, components, terms, flow, whole, place, old, w)
            _begin(law, of, components, whole, w)
            iterations = _solve(law, of, components, whole, w)
            _lead(law, of, components, whole, w)
            iterations += _solve(law, of, components, whole, w)
            _end(law, of, components, whole, w)
            _tangent(of, components, whole, w)
            for k in range(flow):
                w[ENDED, k] = -1.0 if w[LEFT_OUT, k] > 0.0 else iterations
            good &= keep(of, components, terms, flow, with_tangent, place, w, new, tangent, count)
    return good


@njit(**INLINE)
def _separate(
    of: Points,
    components: Components,
    terms: int,
    flow: int,
    size: int,
    place: np.ndarray,
    old: np.ndarray,
    w: np.ndarray,
) -> None:
    """Replace the sum of the back stresses of the points that flow by each of them."""
    n, last = len(components), terms - 1
    further = old.shape[1] - n * last
    for k in range(size):
        at = np.uint64(of.first) + place[min(k, flow - 1)]
        for j in range(n):
            rest = w[BACK + j, k]
            for i in range(last):
                w[BACK + n * i + j, k] = old[at, further + n * i + j]
                rest -= old[at, further + n * i + j]
            w[BACK + n * last + j, k] = rest


@njit(**INLINE)
def _begin(law: Parts, of: Points, components: Components, size: int, w: np.ndarray) -> None:
    """Where the elastic path crosses the yield surface; T_trial of the first stage, and D by Newton's method from 0."""
    n, Z = len(components), 0.0
    for k in range(size):
        for j in range(n):
            w[A + j, k] = 0.0
    for i in range(law.terms.shape[1]):
        zeta, gamma, _, _ = saturation(law, i, of.temperature)
        back = BACK + n * i
        Z += zeta
        for k in range(size):
            for j in range(n):
                w[A + j, k] += gamma * w[back + j, k]
    for k in range(size):
        na, ea, nn, ne, ee = products(components, w, k)
        ne, ee = 1.5 * na * ea + ne, 1.5 * ea * ea + ee
        beta = yield_crossing(1.5 * na * na + nn, ne, ee, w[K2, k])
        steep = ne + beta * ee
        turn = -(1.0 - GAMMA) * beta / steep if (beta > 0.0) & (steep > 0.0) else 0.0
        length = beta + GAMMA * (1.0 - beta)
        w[LENGTH, k], w[LEFT_OUT, k] = length, 0.0
        nn = na = nh = 0.0
        for j in range(n):
            e, c = w[STRAIN + j, k], modulus(of, n, j)
            w[CROSSING + j, k] = turn * (weight(n, j) * c * share(n, j) * (w[NORMAL + j, k] + beta * e))
            w[TRIAL + j, k] = w[STRESS + j, k] + length * e
            normal = w[NORMAL + j, k] + length * e
            nn += weight(n, j) * normal * normal
            na += weight(n, j) * normal * w[A + j, k]
            nh += weight(n, j) * normal * normal * (c + Z)
        root, norm = math.sqrt(w[K2, k]), math.sqrt(nn)
        to = (norm - root) * nn * root / (root * (nh - na * ROOT * root) + 0.5 * w[K2 + 1, k] * nn)
        w[D, k] = to if to > 0.0 else 0.0


@njit(**INLINE)
def _solve(law: Parts, of: Points, components: Components, size: int, w: np.ndarray) -> int:
    """The stages' D, from those in the rows, and what follows from them; iterations until all have converged."""
    count, running = 0, 1
    while running > 0 and count < MAX_ITERATIONS:
        if count > 0:
            for k in range(size):
                to, least = w[D, k] + w[STEP, k], 0.5 * w[D, k]
                w[D, k] = to if to > least else least
        count += 1
        _evaluate(law, of, components, size, w)
        running = 0
        for k in range(size):
            running += 1 if w[OPEN, k] > 0.0 else 0
    _correct(of, components, size, w)
    return count


@njit(**INLINE)
def _evaluate(law: Parts, of: Points, components: Components, size: int, w: np.ndarray) -> None:
    """The stages at their D, and its correction by Newton's method."""
    n = len(components)
    for k in range(size):
        w[AT, k] = w[WORK, k] + w[D, k]
    harden(law.plastic, of, size, AT, SQUARE, w)
    for k in range(size):
        root = math.sqrt(w[SQUARE, k])
        inverse = 1.0 / root
        w[K, k], w[INVERSE, k], w[DK, k] = root, inverse, 0.5 * w[DK, k] * inverse
        w[L, k], w[Q, k], w[Z, k], w[DZ, k] = w[D, k] * inverse * inverse, ROOT * w[D, k] * inverse, 0.0, 0.0
        for j in range(n):
            w[NORMAL + j, k], w[A + j, k] = w[TRIAL + j, k], 0.0
    for i in range(law.terms.shape[1]):
        zeta, gamma, _, _ = saturation(law, i, of.temperature)
        back = BACK + n * i
        for k in range(size):
            theta = 1.0 / (1.0 + gamma * w[Q, k])
            fall = theta * theta * gamma
            w[Z, k] += theta * zeta
            w[DZ, k] -= fall * zeta
            for j in range(n):
                B = w[back + j, k]
                w[NORMAL + j, k] -= theta * B
                w[A + j, k] += fall * B
    for k in range(size):
        nn = na = nh = 0.0
        l, root, dk = w[L, k], w[K, k], w[DK, k]
        for j in range(n):
            H = modulus(of, n, j) + w[Z, k]
            f = 1.0 / (1.0 + H * l)
            normal = f * w[NORMAL + j, k]
            a = f * (w[A + j, k] - normal * l * w[DZ, k])
            w[F + j, k], w[NORMAL + j, k], w[A + j, k] = f, normal, a
            nn += weight(n, j) * normal * normal
            na += weight(n, j) * normal * a
            nh += weight(n, j) * normal * f * H * normal
        norm = math.sqrt(nn)
        by_l, by_q = _slopes(w, k)
        steep = na * by_q - nh * by_l  # |n| times its slope
        step = (norm - root) * nn / (dk * nn - root * steep)
        w[NORM, k], w[SLOPE, k], w[STEP, k] = norm, steep / norm, step
        w[OPEN, k] = 0.0 if (abs(norm - root) <= FINE * root) & (w[D, k] + step > 0.0) else 1.0


@njit(**INLINE)
def _slopes(w: np.ndarray, k: int) -> tuple[float, float]:
    """Of λ and q in D."""
    falls = w[DK, k] * w[INVERSE, k]
    return w[INVERSE, k] * w[INVERSE, k] - 2.0 * w[L, k] * falls, ROOT * w[INVERSE, k] - w[Q, k] * falls


@njit(**INLINE)
def _correct(of: Points, components: Components, size: int, w: np.ndarray) -> None:
    """Make the last correction to all that follows from D; mark stages that have found no end."""
    n = len(components)
    for k in range(size):
        step = w[STEP, k]
        by_l, by_q = _slopes(w, k)
        w[LEFT_OUT, k] += w[OPEN, k]
        w[D, k] += step
        w[K, k] += w[DK, k] * step
        inverse = 1.0 / w[K, k]
        w[INVERSE, k], w[L, k], w[Q, k] = inverse, w[D, k] * inverse * inverse, ROOT * w[D, k] * inverse
        before, w[NORM, k] = w[Z, k], w[K, k]
        w[Z, k] += w[DZ, k] * by_q * step
        for j in range(n):
            c, normal = modulus(of, n, j), w[NORMAL + j, k]
            w[NORMAL + j, k] += (by_q * w[A + j, k] - by_l * w[F + j, k] * (c + before) * normal) * step
            w[F + j, k] = 1.0 / (1.0 + (c + w[Z, k]) * w[L, k])


@njit(**INLINE)
def _lead(law: Parts, of: Points, components: Components, size: int, w: np.ndarray) -> None:
    """Keep what the tangent takes of the first stage; replace its start by that of the second one."""
    n = len(components)
    for k in range(size):
        l = w[L, k]
        by_l, by_q = _slopes(w, k)
        steep = 1.0 / (w[NORM, k] * (w[DK, k] - w[SLOPE, k]))
        w[FIRST_Q, k], w[FIRST_SLOPE, k] = w[Q, k], by_q
        w[WORK, k] += AHEAD * w[D, k]
        for j in range(n):
            c, f, normal = modulus(of, n, j), w[F + j, k], w[NORMAL + j, k]
            h = f * (c + w[Z, k]) * normal
            w[FIRST_P + j, k] = l * f
            w[FIRST_U + j, k] = by_l * (normal - l * h) + by_q * l * w[A + j, k]
            w[FIRST_D + j, k] = weight(n, j) * normal * f * steep
            w[TRIAL + j, k] = w[STRESS + j, k] + w[STRAIN + j, k] - AHEAD * c * l * normal
    for i in range(law.terms.shape[1]):
        zeta, gamma, _, _ = saturation(law, i, of.temperature)
        back, ends = BACK + n * i, ENDS + n * i
        for k in range(size):
            theta = 1.0 / (1.0 + gamma * w[Q, k])
            for j in range(n):
                B = w[back + j, k]
                end = theta * (B + zeta * w[L, k] * w[NORMAL + j, k])
                w[ends + j, k], w[back + j, k] = end, B + AHEAD * (end - B)


@njit(**INLINE)
def _end(law: Parts, of: Points, components: Components, size: int, w: np.ndarray) -> None:
    """Replace the start of the second stage by its end."""
    n = len(components)
    for k in range(size):
        w[SHIFT, k] = 0.0
        w[WORK, k] += w[D, k]
        for j in range(n):
            w[TURN + j, k] = 0.0
            w[STRESS + j, k] = w[TRIAL + j, k] - modulus(of, n, j) * w[L, k] * w[NORMAL + j, k]
    for i in range(law.terms.shape[1]):
        zeta, gamma, _, _ = saturation(law, i, of.temperature)
        back, ends = BACK + n * i, ENDS + n * i
        for k in range(size):
            theta = 1.0 / (1.0 + gamma * w[Q, k])
            both = theta / (1.0 + gamma * w[FIRST_Q, k])
            w[SHIFT, k] += both * zeta
            for j in range(n):
                w[TURN + j, k] += both * gamma * w[ends + j, k]
                w[back + j, k] = theta * (w[back + j, k] + zeta * w[L, k] * w[NORMAL + j, k])


@njit(**INLINE)
def _tangent(of: Points, components: Components, size: int, w: np.ndarray) -> None:
    """Write the diagonal and the dyads of the tangent of T.

    Over the first stage D₁ changes by G = g:dA and P₁ by λ f dA + u G. With y = AHEAD (c + Σ θᵢ₂ θᵢ₁ ζᵢ) and z = AHEAD
    dq₁/dD₁ Σ θᵢ₂ θᵢ₁ γᵢ Bᵢ₁ the second one has dA = c de − y dP₁ + z G.
    """
    n = len(components)
    for k in range(size):
        l, q, dk, length = w[L, k], w[Q, k], w[DK, k], w[LENGTH, k]
        falls = dk * w[INVERSE, k]
        by_l, by_q = _slopes(w, k)
        steep = 1.0 / (w[NORM, k] * (dk - w[SLOPE, k]))
        first_e = second_e = by_first = by_work = 0.0
        for j in range(n):
            c, f, normal, e = modulus(of, n, j), w[F + j, k], w[NORMAL + j, k], w[STRAIN + j, k]
            y, z = AHEAD * (c + w[SHIFT, k]), AHEAD * w[FIRST_SLOPE, k] * w[TURN + j, k]
            of_n = weight(n, j) * normal
            g = of_n * f * steep
            first_e += w[FIRST_D + j, k] * e
            second_e += g * y * w[FIRST_P + j, k] * e
            by_first += g * (z - y * w[FIRST_U + j, k])
            by_work += of_n * (2.0 * l * f * (c + w[Z, k]) * normal - q * w[A + j, k])
        by_first += AHEAD * (falls * by_work - dk * w[NORM, k]) * steep
        for j in range(n):
            c, f, normal, e = modulus(of, n, j), w[F + j, k], w[NORMAL + j, k], w[STRAIN + j, k]
            y, z = AHEAD * (c + w[SHIFT, k]), AHEAD * w[FIRST_SLOPE, k] * w[TURN + j, k]
            p, u, lf, beta = w[FIRST_P + j, k], w[FIRST_U + j, k], l * f, w[CROSSING + j, k]
            along_l, along_q = normal - l * f * (c + w[Z, k]) * normal, l * w[A + j, k]
            scale = c * of_stress(n, j)
            strain = c * share(n, j)
            G = length * w[FIRST_D + j, k] * strain + first_e * beta
            w[RIGHT + j, k], w[RIGHT + LARGEST + j, k] = beta, G
            g = weight(n, j) * normal * f * steep * (1.0 - y * p * length) * strain
            w[RIGHT + 2 * LARGEST + j, k] = g - second_e * beta + by_first * G
            w[DIAGONAL + j, k] = scale * (1.0 - AHEAD * c * p * length - c * lf * (1.0 - y * p * length))
            w[LEFT + j, k] = -scale * p * e * (AHEAD - lf * y)
            of_work = -AHEAD * falls * (2.0 * l * along_l + q * along_q)
            w[LEFT + LARGEST + j, k] = -scale * (AHEAD * u + lf * (z - y * u) + of_work)
            w[LEFT + 2 * LARGEST + j, k] = -scale * (by_l * along_l + by_q * along_q)
