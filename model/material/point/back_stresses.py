"""An increment of a rod's point whose back stresses saturate: both stages of `increment` by one unknown each.

No time passes, the temperature stays, flow is normal to the yield surface. Each Bᵢ = θᵢ (Bᵢ* + ζᵢ P) is linear in the
stage's plastic strain P = λ n, so that the back stresses leave the stage's equations (static condensation):

    n = (T_trial − Σ θᵢ Bᵢ*)/(1 + (c + Z) λ),   Z = Σ θᵢ ζᵢ,   λ = D/k²,   q = √⅔ D/k,   |n| = k(b* + D).

D alone is left. k/|n| − 1 is linear in D while k and the θᵢ stay, and Newton's method goes by it. Slopes of the start
of the second stage by the strains are kept as what remains of them in n,

    Σ θᵢ dBᵢ* = AHEAD (Σ θᵢ θᵢ₁ ζᵢ dP₁ − Σ θᵢ θᵢ₁ γᵢ Bᵢ₁ dq₁),   index 1: of the first stage.

Where a stage does not flow or finds no end, all is left to `increment.advance`; both give the same numbers.
"""

import math
from collections import namedtuple

import numpy as np

from coilset.model.material.creep.flow import POWER
from coilset.model.material.law.functions import CHANGE, EXPONENT, HEATING, SPIN, TEMPERATURE, elasticity, functions
from coilset.model.material.law.parts import Parts, saturation
from coilset.model.material.point.increment import AHEAD, GAMMA, ROD
from coilset.model.material.point.overstress import ROOT
from coilset.model.material.point.rod import Vector, add, inner, scaled
from coilset.model.material.point.spin import crossing_of_spin
from coilset.model.runtime.kernels import INLINE, KERNEL, njit

# A stage at D: k and its slope in b*, λ, q, n, |n| and its slope in D; f: 1/(1 + (c + Z) λ); slopes of n in q (a) and,
# with the other sign, in λ (h).
Flow = namedtuple("Flow", "k dk l q n norm slope f a h")
NOTHING = (0.0, 0.0, 0.0)
MAX_ITERATIONS = 30
PRECISION, FINE = 1e-13, 1e-7  # of |n| over k; after a correction of the latter no other is left


@njit(**INLINE)
def applies(law: Parts) -> bool:
    """Whether a law has back stresses that saturate, and nothing happens but flow."""
    p = law.plastic
    still = (p[CHANGE] == 0.0) & (p[HEATING] == 0.0) & (law.viscous[POWER] == 0.0)
    return (law.terms.shape[1] > 0) & still & (p[SPIN] == 0.0) & (p[EXPONENT] == 0.0)


@njit(**INLINE)
def _constants(law: Parts, temperature: float, i: int) -> tuple[float, float]:
    """ζᵢ and γᵢ."""
    of = saturation(law, i, temperature)
    return of.zeta, of.gamma


@njit(**INLINE)
def _of(row: np.ndarray, first: int, i: int, last: int) -> Vector:
    """Bᵢ in a row that has the last one, not their sum, in the columns of B."""
    at = ROD if i == last else first + ROD * i
    return (row[at], row[at + 1], row[at + 2])


@njit(**INLINE)
def _at(law: Parts, temperature: float, row: np.ndarray, first: int, T: Vector, c: Vector, b: float, D: float) -> Flow:
    """A stage at D.

    Args:
        law, temperature: of the point.
        row, first: with the Bᵢ* at the start of the stage, and the column of the first of them.
        T: elastic response, deviator.
        c: moduli of T.
        b: b* at the start.
        D: plastic work of the stage.
    """
    k2, dk2 = functions(law.plastic, b + D, temperature)[:2]
    k = math.sqrt(k2)
    dk = 0.5 * dk2 / k
    l, q = D / k2, ROOT * D / k
    Z = dZ = m0 = m1 = m2 = 0.0
    n0, n1, n2 = T
    last = law.terms.shape[1] - 1
    for i in range(last + 1):
        zeta, gamma = _constants(law, temperature, i)
        theta = 1.0 / (1.0 + gamma * q)
        fall = theta * theta * gamma
        B = _of(row, first, i, last)
        Z += theta * zeta
        dZ -= fall * zeta
        n0, n1, n2 = n0 - theta * B[0], n1 - theta * B[1], n2 - theta * B[2]
        m0, m1, m2 = m0 + fall * B[0], m1 + fall * B[1], m2 + fall * B[2]
    H = (c[0] + Z, c[1] + Z, c[2] + Z)
    f = (1.0 / (1.0 + H[0] * l), 1.0 / (1.0 + H[1] * l), 1.0 / (1.0 + H[2] * l))
    n = (f[0] * n0, f[1] * n1, f[2] * n2)
    a = (f[0] * (m0 - n[0] * l * dZ), f[1] * (m1 - n[1] * l * dZ), f[2] * (m2 - n[2] * l * dZ))
    h = (f[0] * n[0] * H[0], f[1] * n[1] * H[1], f[2] * n[2] * H[2])
    norm = math.sqrt(inner(n, n))
    slope = (inner(n, a) * (ROOT - q * dk) / k - inner(n, h) * (1.0 / k2 - 2.0 * l * dk / k)) / norm
    return Flow(k, dk, l, q, n, norm, slope, f, a, h)


@njit(**INLINE)
def _solve(
    law: Parts, temperature: float, row: np.ndarray, first: int, T: Vector, c: Vector, b: float, D: float
) -> tuple[float, int]:
    """D of a stage, from a first one, as `_at`, and iterations, −1 if there is none."""
    low, high = 0.0, math.inf
    for count in range(MAX_ITERATIONS):
        x = _at(law, temperature, row, first, T, c, b, D)
        off = x.k / x.norm - 1.0
        if abs(off) <= PRECISION and D > 0.0:
            return D, count + 1
        step = -off * x.norm * x.norm / (x.dk * x.norm - x.k * x.slope)
        if abs(off) <= FINE and D > 0.0 and D + step > 0.0:
            return D + step, count + 1
        low, high = (D, high) if off < 0.0 else (low, D)
        if low < D + step < high:
            D += step
        elif high < math.inf and low > 0.0:
            D = 0.5 * (low + high)
        else:
            return D, -1
    return D, -1


@njit(**INLINE)
def _change(x: Flow, dA: Vector, db: float) -> tuple[float, float, Vector]:
    """How D, q and P of a stage change with T_trial − Σ θᵢ Bᵢ* at constant θᵢ, and with b* at its start."""
    n, a, h, l = x.n, x.a, x.h, x.l
    falls, way = x.dk / x.k, (x.f[0] * dA[0], x.f[1] * dA[1], x.f[2] * dA[2])
    of_b = 2.0 * l * falls * inner(n, h) - x.q * falls * inner(n, a)
    dD = ((inner(n, way) + of_b * db) / x.norm - x.dk * db) / (x.dk - x.slope)
    dl = dD / (x.k * x.k) - 2.0 * l * falls * (db + dD)
    dq = ROOT * dD / x.k - x.q * falls * (db + dD)
    dn = (way[0] + a[0] * dq - h[0] * dl, way[1] + a[1] * dq - h[1] * dl, way[2] + a[2] * dq - h[2] * dl)
    return dD, dq, (dl * n[0] + l * dn[0], dl * n[1] + l * dn[1], dl * n[2] + l * dn[2])


@njit(**KERNEL)
def flow_of_rod(law: Parts, old: np.ndarray, de: Vector, new: np.ndarray, C: np.ndarray) -> int:
    """`increment.advance` of a rod's point where `applies`.

    −1 if κ is not zero, or a stage does not flow or finds no end; then nothing of what is written counts.
    """
    size = law.terms.shape[1]
    last, first = size - 1, old.shape[0] - ROD * (size - 1)
    temperature = old[2 * ROD + 1] if first > 2 * ROD + 1 else law.plastic[TEMPERATURE]
    E, G, _ = elasticity(law.plastic, temperature)
    b = old[2 * ROD]
    k2, _, _, _, kappa, _ = functions(law.plastic, b, temperature)
    if kappa > 0.0:
        return -1
    e = (E * de[0] / 1.5, G * de[1], G * de[2])
    part = crossing_of_spin((old[0], old[1], old[2]), (old[3], old[4], old[5]), k2, E, G, e)
    for i in range(old.shape[0]):
        new[i] = old[i]
    if part.beta == 1.0:
        for j in range(ROD):
            new[j] += e[j] * (1.5 if j == 0 else 1.0)
            for k in range(ROD):
                C[j, k] = 0.0
        C[0, 0], C[1, 1], C[2, 2] = E, G, G
        return 0
    for i in range(last):
        for j in range(ROD):
            new[ROD + j] -= old[first + ROD * i + j]
    c, elastic = (E / 1.5, 2.0 * G, 2.0 * G), (E / 1.5, G, G)

    length = part.beta + GAMMA * (1.0 - part.beta)
    T = (old[0] / 1.5 + length * e[0], old[1] + length * e[1], old[2] + length * e[2])
    D, count = _solve(law, temperature, new, first, T, c, b, 0.0)
    if count < 0:
        return -1
    one = _at(law, temperature, new, first, T, c, b, D)
    P, b, total = scaled(one.n, one.l), b + AHEAD * D, count
    for i in range(size):
        zeta, gamma = _constants(law, temperature, i)
        theta, at = 1.0 / (1.0 + gamma * one.q), ROD if i == last else first + ROD * i
        for j in range(ROD):
            new[at + j] += AHEAD * theta * (zeta * P[j] - gamma * one.q * new[at + j])

    T = (
        old[0] / 1.5 + e[0] - AHEAD * c[0] * P[0],
        old[1] + e[1] - AHEAD * c[1] * P[1],
        old[2] + e[2] - AHEAD * c[2] * P[2],
    )
    D, count = _solve(law, temperature, new, first, T, c, b, D)
    if count < 0:
        return -1
    two = _at(law, temperature, new, first, T, c, b, D)
    P = scaled(two.n, two.l)
    s, w = 0.0, NOTHING  # of Σ θᵢ dBᵢ*
    for i in range(size):
        zeta, gamma = _constants(law, temperature, i)
        before, theta = 1.0 / (1.0 + gamma * one.q), 1.0 / (1.0 + gamma * two.q)
        at = ROD if i == last else first + ROD * i
        s += theta * before * zeta
        # Bᵢ₁ from Bᵢ* at the start of the increment
        w = add(w, scaled(_first_end(old, first, i, last, before, zeta, one), theta * before * gamma))
        for j in range(ROD):
            new[at + j] = theta * (new[at + j] + zeta * P[j])
    for j in range(ROD):
        new[j] = (T[j] - c[j] * P[j]) * (1.5 if j == 0 else 1.0)
        for i in range(last):
            new[ROD + j] += new[first + ROD * i + j]
    new[2 * ROD] = b + D

    for k in range(ROD):
        more = (1.0 - GAMMA) * part.d_beta[k]
        unit = (1.0 if k == 0 else 0.0, 1.0 if k == 1 else 0.0, 1.0 if k == 2 else 0.0)
        hooke = (elastic[0] * unit[0], elastic[1] * unit[1], elastic[2] * unit[2])
        dD, dq, dP = _change(one, add(scaled(hooke, length), scaled(e, more)), 0.0)
        dT = (
            hooke[0] - AHEAD * c[0] * dP[0],
            hooke[1] - AHEAD * c[1] * dP[1],
            hooke[2] - AHEAD * c[2] * dP[2],
        )
        dA = add(dT, add(scaled(dP, -AHEAD * s), scaled(w, AHEAD * dq)))
        _, _, dP = _change(two, dA, AHEAD * dD)
        for j in range(ROD):
            C[j, k] = (dT[j] - c[j] * dP[j]) * (1.5 if j == 0 else 1.0)
    return total + count


@njit(**INLINE)
def _first_end(row: np.ndarray, first: int, i: int, last: int, theta: float, zeta: float, one: Flow) -> Vector:
    """Bᵢ at the end of the first stage, from a row that has the sum of all in the columns of B."""
    B = _of(row, first, i, last)
    for k in range(last if i == last else 0):
        B = add(B, scaled(_of(row, first, k, last), -1.0))
    return scaled(add(B, scaled(one.n, zeta * one.l)), theta)
