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

from coilset.model.material.creep.flow import POWER
from coilset.model.material.law.functions import CHANGE, EXPONENT, HEATING, KAPPA, N_ROWS, ROW_LENGTH, ROWS_START, SPIN
from coilset.model.material.law.parts import Parts, saturation
from coilset.model.material.point.increment import AHEAD, GAMMA
from coilset.model.material.point.local import yield_crossing
from coilset.model.material.point.local_rows import FLOWS, FORM, GROUP, K2, WORK, Points, gather, group_from, harden
from coilset.model.material.point.overstress import ROOT
from coilset.model.material.point.stage import MOST_TERMS
from coilset.model.runtime.kernels import INLINE, KERNEL, njit

# Numbers of the components, by which functions are compiled for the rod's three or all six.
Components = tuple[int, ...]
ROD, SOLID = (0, 1, 2), (0, 1, 2, 3, 4, 5)
MAX_ITERATIONS = 12
FINE = 1e-6  # of |n| over k: after a correction of that size no other is left

# Rows from FORM on: those of the deviator of stress and of the elastic increment of T, which are given, and of each Bᵢ;
# then, behind the largest of them, those of a stage. D, its correction, whether the iteration goes on; b*; k² and its
# slope, in whose place k's is kept; k and 1/k, λ, q, Z, dZ, |n| and the slope of |n| in D; whether a stage has no end.
LARGEST = len(SOLID)
STAGE = FORM + (2 + MOST_TERMS) * LARGEST
D, STEP, OPEN, AT, SQUARE, DK, K, INVERSE, L, Q, Z, DZ, NORM, SLOPE, LEFT_OUT = range(STAGE, STAGE + 15)
# What the tangent takes of the first stage: q and its slope in D; its length in the increment; and Σ θᵢ₂ θᵢ₁ ζᵢ.
FIRST_Q, FIRST_SLOPE, LENGTH, SHIFT = range(STAGE + 15, STAGE + 19)
# By component: T_trial, f, n, a; λ f, u and the slope of D of the first stage; what its length takes by the strains,
# from β; Σ θᵢ₂ θᵢ₁ γᵢ Bᵢ₁; the tangent's diagonal, and its dyads' left and right vectors; the Bᵢ₁.
VECTORS = STAGE + 19
TRIAL, F, N, A, FIRST_P, FIRST_U, FIRST_D, CROSSING, TURN, DIAGONAL = range(VECTORS, VECTORS + 10 * LARGEST, LARGEST)
LEFT = DIAGONAL + LARGEST
RIGHT = LEFT + 3 * LARGEST
ENDS = RIGHT + 3 * LARGEST
ROWS = ENDS + MOST_TERMS * LARGEST


@njit(**INLINE)
def applies(law: Parts) -> bool:
    """Whether a law has back stresses that saturate, and nothing happens but flow along n."""
    p = law.plastic
    still = (p[CHANGE] == 0.0) & (p[HEATING] == 0.0) & (law.viscous[POWER] == 0.0)
    for row in range(int(p[N_ROWS])):
        still = still & (p[ROWS_START + row * ROW_LENGTH + KAPPA] == 0.0)
    return (law.terms.shape[1] > 0) & still & (p[SPIN] == 0.0) & (p[EXPONENT] == 0.0)


@njit(**INLINE)
def _is_axial(n: int, j: int) -> bool:
    """Whether a component is the rod's axial one."""
    return (n == 3) & (j == 0)


@njit(**INLINE)
def _is_normal(n: int, j: int) -> bool:
    """Whether a component is one of the normal ones of six."""
    return (n > 3) & (j < 3)


@njit(**INLINE)
def _weight(n: int, j: int) -> float:
    """Of a component in a:b."""
    return 1.5 if _is_axial(n, j) else 1.0 if _is_normal(n, j) else 2.0


@njit(**INLINE)
def _modulus(of: Points, n: int, j: int) -> float:
    """c of a component of T."""
    return of.E / 1.5 if _is_axial(n, j) else 2.0 * of.G


@njit(**INLINE)
def _share(n: int, j: int) -> float:
    """Part of an engineering strain in the component of its tensor."""
    return 1.0 if _is_axial(n, j) or _is_normal(n, j) else 0.5


@njit(**KERNEL)
def flow_points(
    law: Parts,
    components: Components,
    old: np.ndarray,
    de: np.ndarray,
    new: np.ndarray,
    tangent: np.ndarray,
    count: np.ndarray,
) -> bool:
    """One increment at many points, where `applies`.

    Args:
        law: Parts.
        components: ROD or SOLID.
        old: states at the start, as `increment.advance` has them, shape (points, columns); not written.
        de: strain increments, shape (components, points).
        new: states at the end; written.
        tangent: dσ/dε by rows, shape (components², points), N/mm²; written.
        count: iterations of both stages, 0 if a point stayed elastic, -1 if it is left to `increment.advance`, where
            neither its state nor its tangent counts, shape (points,); written.

    Returns:
        Whether none is left.
    """
    n, terms, first, good = len(components), law.terms.shape[1], 0, True
    further = old.shape[1] - n * (terms - 1)  # where the back stresses but the last begin
    w, place = np.empty((ROWS, GROUP)), np.empty(GROUP, np.uint64)
    while first < old.shape[0]:
        of = group_from(law.plastic, old[:, :further], first, 2 * n + 1)
        _trial(law, of, components, old, de, w)
        _elastic(of, components, old, de, new, tangent)
        flow, whole = gather(of.size, 2 * n, place, w)
        first += of.size
        count[of.first : first] = 0
        if flow == 0:
            continue
        _gather(of, n, terms, flow, whole, old, place, w)
        _begin(law, of, components, whole, w)
        iterations = _solve(law, of, components, whole, w)
        _lead(law, of, components, whole, w)
        iterations += _solve(law, of, components, whole, w)
        _end(law, of, components, whole, w)
        _tangent(of, components, whole, w)
        for j in range(flow):
            k = of.first + int(place[j])
            count[k] = -1 if w[LEFT_OUT, j] > 0.0 else iterations
            good = good and w[LEFT_OUT, j] == 0.0
            _write(of, components, terms, j, k, w, new, tangent)
    return good


@njit(**INLINE)
def _trial(law: Parts, of: Points, components: Components, old: np.ndarray, de: np.ndarray, w: np.ndarray) -> None:
    """The stress and strain of a group, and which of its points flow."""
    n = len(components)
    for k in range(of.size):
        at, mean, grown = of.first + k, 0.0, 0.0
        if n > 3:
            mean, grown = (old[at, 0] + old[at, 1] + old[at, 2]) / 3.0, (de[0, at] + de[1, at] + de[2, at]) / 3.0
        for j in range(n):
            normal = 1.0 if _is_normal(n, j) else 0.0
            w[FORM + j, k] = old[at, j] / 1.5 if _is_axial(n, j) else old[at, j] - normal * mean
            w[FORM + n + j, k] = _modulus(of, n, j) * _share(n, j) * (de[j, at] - normal * grown)
            w[N + j, k] = w[FORM + j, k] - old[at, n + j]
        w[WORK, k] = old[at, 2 * n]
    harden(law.plastic, of, of.size, WORK, K2, w)
    for k in range(of.size):
        square = 0.0
        for j in range(n):
            trial = w[N + j, k] + w[FORM + n + j, k]
            square += _weight(n, j) * trial * trial
        w[FLOWS, k] = 0.0 if square <= w[K2, k] * (1.0 + 1e-12) else 1.0


@njit(**INLINE)
def _lame(of: Points) -> float:
    """Lamé's first constant."""
    return of.E * of.G / (3.0 * (3.0 * of.G - of.E)) - 2.0 / 3.0 * of.G


@njit(**INLINE)
def _elastic(
    of: Points, components: Components, old: np.ndarray, de: np.ndarray, new: np.ndarray, tangent: np.ndarray
) -> None:
    """Write the elastic response of a group."""
    n, lame = len(components), _lame(of)
    for i in range(n * n):
        j = i // n
        modulus = of.E if _is_axial(n, j) else 2.0 * of.G * _share(n, j)
        value = lame if _is_normal(n, j) and _is_normal(n, i % n) else 0.0
        value += modulus if j == i % n else 0.0
        for k in range(of.size):
            tangent[i, of.first + k] = value
    for k in range(of.size):
        at, volume = of.first + k, 0.0
        if n > 3:
            volume = lame * (de[0, at] + de[1, at] + de[2, at])
        for j in range(n):
            modulus = of.E if _is_axial(n, j) else 2.0 * of.G * _share(n, j)
            new[at, j] = old[at, j] + modulus * de[j, at] + (volume if _is_normal(n, j) else 0.0)
        for j in range(n, old.shape[1]):
            new[at, j] = old[at, j]


@njit(**INLINE)
def _gather(
    of: Points, n: int, terms: int, flow: int, size: int, old: np.ndarray, place: np.ndarray, w: np.ndarray
) -> None:
    """The back stresses of the points that flow, the last one repeated."""
    back, further = FORM + 2 * n, old.shape[1] - n * (terms - 1)
    for k in range(size):
        at = of.first + int(place[min(k, flow - 1)])
        for j in range(n):
            last = old[at, n + j]
            w[N + j, k] = w[FORM + j, k] - last
            for i in range(terms - 1):
                w[back + n * i + j, k] = old[at, further + n * i + j]
                last -= old[at, further + n * i + j]
            w[back + n * (terms - 1) + j, k] = last


@njit(**INLINE)
def _begin(law: Parts, of: Points, components: Components, size: int, w: np.ndarray) -> None:
    """Where the elastic path crosses the yield surface; T_trial of the first stage, and D by Newton's method from 0."""
    n, Z = len(components), 0.0
    for k in range(size):
        for j in range(n):
            w[A + j, k] = 0.0
    for i in range(law.terms.shape[1]):
        zeta, gamma, _, _ = saturation(law, i, of.temperature)
        back = FORM + n * (2 + i)
        Z += zeta
        for k in range(size):
            for j in range(n):
                w[A + j, k] += gamma * w[back + j, k]
    for k in range(size):
        nn = ne = ee = 0.0
        for j in range(n):
            normal, e = w[N + j, k], w[FORM + n + j, k]
            nn += _weight(n, j) * normal * normal
            ne += _weight(n, j) * normal * e
            ee += _weight(n, j) * e * e
        beta = yield_crossing(nn, ne, ee, w[K2, k])
        steep = ne + beta * ee
        turn = -(1.0 - GAMMA) * beta / steep if (beta > 0.0) & (steep > 0.0) else 0.0
        length = beta + GAMMA * (1.0 - beta)
        w[LENGTH, k], w[LEFT_OUT, k] = length, 0.0
        nn = na = nh = 0.0
        for j in range(n):
            e, c = w[FORM + n + j, k], _modulus(of, n, j)
            w[CROSSING + j, k] = turn * (_weight(n, j) * c * _share(n, j) * (w[N + j, k] + beta * e))
            w[TRIAL + j, k] = w[FORM + j, k] + length * e
            normal = w[N + j, k] + length * e
            nn += _weight(n, j) * normal * normal
            na += _weight(n, j) * normal * w[A + j, k]
            nh += _weight(n, j) * normal * normal * (c + Z)
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
            w[N + j, k], w[A + j, k] = w[TRIAL + j, k], 0.0
    for i in range(law.terms.shape[1]):
        zeta, gamma, _, _ = saturation(law, i, of.temperature)
        back = FORM + n * (2 + i)
        for k in range(size):
            theta = 1.0 / (1.0 + gamma * w[Q, k])
            fall = theta * theta * gamma
            w[Z, k] += theta * zeta
            w[DZ, k] -= fall * zeta
            for j in range(n):
                B = w[back + j, k]
                w[N + j, k] -= theta * B
                w[A + j, k] += fall * B
    for k in range(size):
        nn = na = nh = 0.0
        l, root, dk = w[L, k], w[K, k], w[DK, k]
        for j in range(n):
            H = _modulus(of, n, j) + w[Z, k]
            f = 1.0 / (1.0 + H * l)
            normal = f * w[N + j, k]
            a = f * (w[A + j, k] - normal * l * w[DZ, k])
            w[F + j, k], w[N + j, k], w[A + j, k] = f, normal, a
            nn += _weight(n, j) * normal * normal
            na += _weight(n, j) * normal * a
            nh += _weight(n, j) * normal * f * H * normal
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
            c, normal = _modulus(of, n, j), w[N + j, k]
            w[N + j, k] += (by_q * w[A + j, k] - by_l * w[F + j, k] * (c + before) * normal) * step
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
            c, f, normal = _modulus(of, n, j), w[F + j, k], w[N + j, k]
            h = f * (c + w[Z, k]) * normal
            w[FIRST_P + j, k] = l * f
            w[FIRST_U + j, k] = by_l * (normal - l * h) + by_q * l * w[A + j, k]
            w[FIRST_D + j, k] = _weight(n, j) * normal * f * steep
            w[TRIAL + j, k] = w[FORM + j, k] + w[FORM + n + j, k] - AHEAD * c * l * normal
    for i in range(law.terms.shape[1]):
        zeta, gamma, _, _ = saturation(law, i, of.temperature)
        back, ends = FORM + n * (2 + i), ENDS + n * i
        for k in range(size):
            theta = 1.0 / (1.0 + gamma * w[Q, k])
            for j in range(n):
                B = w[back + j, k]
                end = theta * (B + zeta * w[L, k] * w[N + j, k])
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
            w[FORM + j, k] = w[TRIAL + j, k] - _modulus(of, n, j) * w[L, k] * w[N + j, k]
    for i in range(law.terms.shape[1]):
        zeta, gamma, _, _ = saturation(law, i, of.temperature)
        back, ends = FORM + n * (2 + i), ENDS + n * i
        for k in range(size):
            theta = 1.0 / (1.0 + gamma * w[Q, k])
            both = theta / (1.0 + gamma * w[FIRST_Q, k])
            w[SHIFT, k] += both * zeta
            for j in range(n):
                w[TURN + j, k] += both * gamma * w[ends + j, k]
                w[back + j, k] = theta * (w[back + j, k] + zeta * w[L, k] * w[N + j, k])


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
            c, f, normal, e = _modulus(of, n, j), w[F + j, k], w[N + j, k], w[FORM + n + j, k]
            y, z = AHEAD * (c + w[SHIFT, k]), AHEAD * w[FIRST_SLOPE, k] * w[TURN + j, k]
            weight = _weight(n, j) * normal
            g = weight * f * steep
            first_e += w[FIRST_D + j, k] * e
            second_e += g * y * w[FIRST_P + j, k] * e
            by_first += g * (z - y * w[FIRST_U + j, k])
            by_work += weight * (2.0 * l * f * (c + w[Z, k]) * normal - q * w[A + j, k])
        by_first += AHEAD * (falls * by_work - dk * w[NORM, k]) * steep
        for j in range(n):
            c, f, normal, e = _modulus(of, n, j), w[F + j, k], w[N + j, k], w[FORM + n + j, k]
            y, z = AHEAD * (c + w[SHIFT, k]), AHEAD * w[FIRST_SLOPE, k] * w[TURN + j, k]
            p, u, lf, beta = w[FIRST_P + j, k], w[FIRST_U + j, k], l * f, w[CROSSING + j, k]
            along_l, along_q = normal - l * f * (c + w[Z, k]) * normal, l * w[A + j, k]
            scale = c * (1.5 if _is_axial(n, j) else 1.0)
            strain = c * _share(n, j)
            G = length * w[FIRST_D + j, k] * strain + first_e * beta
            w[RIGHT + j, k], w[RIGHT + n + j, k] = beta, G
            g = _weight(n, j) * normal * f * steep * (1.0 - y * p * length) * strain
            w[RIGHT + 2 * n + j, k] = g - second_e * beta + by_first * G
            w[DIAGONAL + j, k] = scale * (1.0 - AHEAD * c * p * length - c * lf * (1.0 - y * p * length))
            w[LEFT + j, k] = -scale * p * e * (AHEAD - lf * y)
            of_work = -AHEAD * falls * (2.0 * l * along_l + q * along_q)
            w[LEFT + n + j, k] = -scale * (AHEAD * u + lf * (z - y * u) + of_work)
            w[LEFT + 2 * n + j, k] = -scale * (by_l * along_l + by_q * along_q)


@njit(**INLINE)
def _write(
    of: Points,
    components: Components,
    terms: int,
    j: int,
    k: int,
    w: np.ndarray,
    new: np.ndarray,
    tangent: np.ndarray,
) -> None:
    """Write the state and the tangent of the point k, that of the rows' column j."""
    n, last = len(components), terms - 1
    back, further, mean, bulk = FORM + 2 * n, new.shape[1] - n * last, 0.0, _lame(of) + 2.0 / 3.0 * of.G
    if n > 3:
        mean = (new[k, 0] + new[k, 1] + new[k, 2]) / 3.0  # of the elastic response
    for i in range(n):
        normal = _is_normal(n, i)
        new[k, i] = w[FORM + i, j] * (1.5 if _is_axial(n, i) else 1.0) + (mean if normal else 0.0)
        total = w[back + n * last + i, j]
        for term in range(last):
            B = w[back + n * term + i, j]
            total += B
            new[k, further + n * term + i] = B
        new[k, n + i] = total
        diagonal = w[DIAGONAL + i, j]
        for m in range(n):
            dyads = 0.0
            for r in range(3):
                dyads += w[LEFT + r * n + i, j] * w[RIGHT + r * n + m, j]
            own = diagonal * _share(n, i) if i == m else 0.0
            both = bulk - diagonal / 3.0 if normal and _is_normal(n, m) else 0.0
            tangent[n * i + m, k] = dyads + own + both
    new[k, 2 * n] = w[WORK, j]
