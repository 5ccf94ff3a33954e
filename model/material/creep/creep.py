"""Creep combined with plastic flow at one point, D = D_el + D_pl + D_c, over an increment of time, with the tangent.

The equivalent creep strain c grows under the equivalent stress σ (von Mises) as

    c = φ(σ) t^p,   φ = c₀ (σ/σ₀)^N  (Norton-Bailey)   or   c₀ sinh(σ/σ₀)^N  (Garofalo's form),

with t in hours, scaled with temperature, see `creep_law`. When the stress changes, strain hardening uses the rate at
the current c, time hardening the rate at the current t. Both become smooth rates in other variables,

    strain hardening   u = c^(1/p),   du/dt = φ^(1/p)          time hardening   u = c,   du/d(t^p) = φ,

so that c(t) is exact under constant stress, even from t = 0, where dc/dt is infinite. The direction is that of the
stress deviator: creep depends on T, not on T − B, and does not change plastic work and back stress.

Time integration uses the two stages of an L-stable, diagonally implicit Runge-Kutta method of second order
(γ = 1 − 1/√2; Alexander, SIAM J. Numer. Anal. 14, 1977),

    x₁ = [c] from 0 to γ at σ₁,      x₂ = [c] from 0 to 1 − γ at σ₁, and from there to 1 at σ₂,

each solved for its creep strain x by Newton's method, x = X(σ(Δε − x)). The stress σ of a given strain comes from the
return mapping: elasticity and plasticity enter as one function with its tangent, so that both flows act simultaneously
without operator splitting. Without yield X(σ(Δε − x)) is convex and decreases with x, so that Newton's method from x =
0 approaches the root from one side for any time step. This root is the solution if its stress does not yield, and
otherwise the starting point of a second iteration.
"""

import math
from collections import namedtuple

import numpy as np
from numba import njit

from coilset.model.base.kernel import KERNEL
from coilset.model.material.creep.flow import POWER, direction, equivalent, flow, passes, rate
from coilset.model.material.law.functions import elasticity
from coilset.model.material.point.rod import return_map as rod_return_map
from coilset.model.material.point.solid import return_map as solid_return_map

# Replaces the parameter array of the law's kernels where time passes: that array, the same without yield,
# and the array of creep.
Creeping = namedtuple("Creeping", "plastic elastic viscous")
# What a stage starts from: state at its temperature, mechanical strain of the whole stage, u, and its length in time.
Part = namedtuple("Part", "start strain u h")
# What is written at its end: creep strain x, state and tangent of the return mapping there, ∂X/∂σ.
End = namedtuple("End", "x new C A")

GAMMA = 1.0 - math.sqrt(0.5)
MAX_ITERATIONS = 60
TOLERANCE = 1e-11  # of the creep strain's last correction, over the increment of strain
SHORTEST = 1e-6  # part of a correction


@njit(**KERNEL)
def creep_map(law: Creeping, old: np.ndarray, de: np.ndarray, new: np.ndarray, C: np.ndarray) -> int:
    """One increment of strain and time.

    Args:
        law: Creeping.
        old: the point's state at the start: that of the return mapping without temperature, shape (7,) or (13,), then
            temperature (K) and c; not written.
        de: strain increment, shape (3,) as in `rod` or (6,) as in `solid`, engineering shear strains, thermal strain
            included.
        new: the state at the end; written.
        C: dσ/dε, shape (3, 3) or (6, 6), N/mm²; written.

    Returns:
        Number of local iterations, or below 0 if there was no convergence.
    """
    n, q = de.shape[0], law.viscous
    columns = 2 * n + 2
    h, after = passes(q, old[columns - 1])
    if h == 0.0 and after == old[columns - 1]:
        new[columns] = old[columns]
        return elastoplastic(law.plastic, old[:columns], de, new[:columns], C)
    power, c0 = q[POWER], old[columns]
    u0 = c0 ** (1.0 / power)
    start, strain = np.empty(columns), np.empty(n)
    first, C1, A = np.empty(n), np.empty((n, n)), np.empty((n, n))
    end = End(np.empty(n), new[:columns], C1, A)

    # ---- first stage: σ₁ at γ, and S = γ dσ₁/dε
    _warmed(law.plastic, old, de, (GAMMA, after), start, strain)
    count = _stage(law, Part(start, strain, u0, GAMMA * h), end)
    if count < 0:
        return count
    S = _eliminated(_product(C1, A), GAMMA * C1)

    # ---- creep strain of σ₁ over the first 1 − γ, and how it and u change with σ₁
    middle = flow(q, new[:n], u0, (1.0 - GAMMA) * h, first, A)
    d_first, d_u = A.copy(), direction(new[:n])
    d_u *= (1.0 - GAMMA) * h * rate(q, equivalent(new[:n]))[1]

    # ---- second stage
    _warmed(law.plastic, old, de, (1.0, after), start, strain)
    strain -= first
    more = _stage(law, Part(start, strain, middle, GAMMA * h), end)
    if more < 0:
        return more
    along = direction(new[:n])
    u = middle + GAMMA * h * rate(q, equivalent(new[:n]))[0]
    new[columns] = u**power
    if middle > 0.0:  # dX₂/du at fixed σ₂
        along *= power * (u ** (power - 1.0) - middle ** (power - 1.0))
        for i in range(n):
            for j in range(n):
                d_first[i, j] += along[i] * d_u[j]
    C[:] = _eliminated(_product(C1, A), C1 - _product(C1, _product(d_first, S)))
    return count + more


@njit(**KERNEL)
def elastoplastic(p: np.ndarray, old: np.ndarray, de: np.ndarray, new: np.ndarray, C: np.ndarray) -> int:
    """The return mapping of the form that `de` belongs to."""
    if de.shape[0] == 3:
        return rod_return_map(p, old, de[0], de[1], de[2], new, C)
    return solid_return_map(p, old, de, new, C)


@njit(**KERNEL)
def _warmed(
    p: np.ndarray, old: np.ndarray, de: np.ndarray, to: tuple[float, float], start: np.ndarray, strain: np.ndarray
) -> None:
    """Start of a stage: the elastic strains of `old` at the stage's temperature, and the mechanical strain.

    `to` is the part of the increment at the stage's end, and the temperature at the increment's end.

    σ = C(T) : ε_el, so that on heating the stress follows the elastic constants at once, and recovers on cooling.
    """
    n, part = de.shape[0], to[0]
    columns = 2 * n + 2
    before = old[columns - 1]
    after = before + part * (to[1] - before)
    E0, G0, alpha0 = elasticity(p, before)
    E1, G1, alpha1 = elasticity(p, after)
    thermal = 0.5 * (alpha0 + alpha1) * (after - before)
    for i in range(columns):
        start[i] = old[i]
    start[columns - 1] = after
    normals = 1 if n == 3 else 3
    for i in range(n):
        strain[i] = part * de[i] - (thermal if i < normals else 0.0)
    if n == 3:
        start[0] *= E1 / E0
    else:
        mean = (old[0] + old[1] + old[2]) / 3.0
        bulk = (E1 * G1 / (3.0 * G1 - E1)) / (E0 * G0 / (3.0 * G0 - E0))
        for i in range(3):
            start[i] = (old[i] - mean) * G1 / G0 + mean * bulk
    for i in range(normals, n):
        start[i] *= G1 / G0


@njit(**KERNEL)
def _stage(law: Creeping, part: Part, end: End) -> int:
    """Solve x = X(σ(strain − x)); returns the number of iterations, or -1."""
    end.x[:] = 0.0
    count = _newton(law.elastic, law.viscous, part, end)
    if count < 0 or elastoplastic(law.plastic, part.start, part.strain - end.x, end.new, end.C) == 0:
        return count
    more = _newton(law.plastic, law.viscous, part, end)
    return more if more < 0 else count + more


@njit(**KERNEL)
def _newton(p: np.ndarray, q: np.ndarray, part: Part, end: End) -> int:
    """Newton's method for x from its current value, with corrections halved if they do not help; as `_stage`."""
    start, strain, u0, h = part
    x, new, C, A = end
    n = strain.shape[0]
    wanted, r, step = np.empty(n), np.empty((n, 1)), np.zeros(n)
    last, share = math.inf, 1.0
    for iteration in range(1, MAX_ITERATIONS + 1):
        off = math.inf
        if elastoplastic(p, start, strain - x, new, C) >= 0:
            flow(q, new[:n], u0, h, wanted, A)
            off = 0.0
            for i in range(n):
                r[i, 0] = wanted[i] - x[i]
                off += r[i, 0] * r[i, 0]
        if iteration == 1 and not math.isfinite(off):
            return -1
        if not off <= last and share > SHORTEST:
            share *= 0.5
            for i in range(n):
                x[i] -= share * step[i]
            continue
        last, share = off, 1.0
        correction = _eliminated(_product(A, C), r)
        largest, size = 0.0, np.abs(strain).max()
        for i in range(n):
            step[i] = correction[i, 0]
            size = max(size, abs(x[i]))
            largest = max(largest, abs(step[i]))
        if not math.isfinite(largest):
            return -1
        if largest <= TOLERANCE * size + 1e-16:
            return iteration
        for i in range(n):
            x[i] += step[i]
    return -1


@njit(**KERNEL)
def _product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Product of two matrices, small ones."""
    result = np.zeros((a.shape[0], b.shape[1]))
    for i in range(a.shape[0]):
        for k in range(a.shape[1]):
            for j in range(b.shape[1]):
                result[i, j] += a[i, k] * b[k, j]
    return result


@njit(**KERNEL)
def _eliminated(M: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(1 + M)⁻¹ b by elimination with pivoting; M is overwritten."""
    n, x = M.shape[0], b.copy()
    for i in range(n):
        M[i, i] += 1.0
    for i in range(n):
        top = i
        for k in range(i + 1, n):
            if abs(M[k, i]) > abs(M[top, i]):
                top = k
        if top != i:
            for j in range(n):
                M[i, j], M[top, j] = M[top, j], M[i, j]
            for j in range(x.shape[1]):
                x[i, j], x[top, j] = x[top, j], x[i, j]
        for k in range(i + 1, n):
            f = M[k, i] / M[i, i]
            for j in range(i, n):
                M[k, j] -= f * M[i, j]
            for j in range(x.shape[1]):
                x[k, j] -= f * x[i, j]
    for j in range(x.shape[1]):
        for i in range(n - 1, -1, -1):
            for k in range(i + 1, n):
                x[i, j] -= M[i, k] * x[k, j]
            x[i, j] /= M[i, i]
    return x
