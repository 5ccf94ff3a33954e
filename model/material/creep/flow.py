"""Creep rates of a point: the creep strain under constant stress, and its slopes; see `creep`."""

import math
from collections import namedtuple

import numpy as np
from numba import njit

from coilset.model.base.kernel import KERNEL

# The array of creep. TIME: the increment of t, or of t^p for time hardening; POWER: p, or 1; FORM: 0 power law, 1 sinh;
# STRAIN, STRESS, EXPONENT: c₀, σ₀ in N/mm², N; TEMPERATURE: at the increment's end, K. ENERGY: Q/R in K where each
# point has a temperature of its own, which stays during the increment, and TIME is hours, not yet scaled; else SCALED.
# T0: of the constants, K.
TIME, POWER, FORM, STRAIN, STRESS, EXPONENT, TEMPERATURE, ENERGY, T0 = range(9)
SCALED = -1.0


@njit(**KERNEL)
def equivalent(s: np.ndarray) -> float:
    """Equivalent stress of σ11, τ12, τ13 or of six stresses, N/mm²."""
    if s.shape[0] == 3:
        return math.sqrt(s[0] * s[0] + 3.0 * (s[1] * s[1] + s[2] * s[2]))
    normal = (s[0] - s[1]) ** 2 + (s[1] - s[2]) ** 2 + (s[2] - s[0]) ** 2
    return math.sqrt(0.5 * normal + 3.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]))


@njit(**KERNEL)
def direction(s: np.ndarray) -> np.ndarray:
    """∂σ/∂s of the equivalent stress σ, with which creep strain (engineering shear strains) grows; 0 without stress."""
    d, size = np.zeros_like(s), equivalent(s)
    if size == 0.0:
        return d
    normals = 1 if s.shape[0] == 3 else 3
    mean = 0.0 if normals == 1 else (s[0] + s[1] + s[2]) / 3.0
    for i in range(s.shape[0]):
        d[i] = (s[i] if normals == 1 else 1.5 * (s[i] - mean)) / size if i < normals else 3.0 * s[i] / size
    return d


@njit(**KERNEL)
def passes(q: np.ndarray, before: float) -> tuple[float, float]:
    """Increment of scaled time, and temperature at its end, of a point of the temperature `before`, K."""
    if q[ENERGY] == SCALED:
        return q[TIME], q[TEMPERATURE]
    return q[TIME] * math.exp(-q[ENERGY] * (1.0 / before - 1.0 / q[T0])), before


@njit(**KERNEL)
def rate(q: np.ndarray, stress: float) -> tuple[float, float]:
    """φ^(1/POWER) at an equivalent stress, and its slope."""
    x = stress / q[STRESS]
    if x <= 1e-12:
        return 0.0, 0.0
    exponent = q[EXPONENT] / q[POWER]
    if q[FORM] == 0.0:
        g = (q[STRAIN] ** (1.0 / q[POWER])) * x**exponent
        return g, g * exponent / stress
    g = (q[STRAIN] ** (1.0 / q[POWER])) * math.sinh(x) ** exponent
    return g, g * exponent / (math.tanh(x) * q[STRESS])


@njit(**KERNEL)
def flow(q: np.ndarray, s: np.ndarray, u0: float, h: float, x: np.ndarray, A: np.ndarray) -> float:
    """Creep strain under constant stress.

    Args:
        q: array of creep.
        s: stress.
        u0: u at the start.
        h: increment of time.
        x: written, creep strain, shape (n,).
        A: written, ∂x/∂s, shape (n, n).

    Returns:
        u at the end.
    """
    n, stress = s.shape[0], equivalent(s)
    g, slope = rate(q, stress)
    u = u0 + h * g
    if h * g == 0.0:
        x[:], A[:] = 0.0, 0.0
        return u0
    power = q[POWER]
    c = u**power - u0**power
    d, tangential = direction(s), c / stress
    normal = power * u ** (power - 1.0) * h * slope - tangential
    for i in range(n):
        x[i] = c * d[i]
        for j in range(n):
            A[i, j] = normal * d[i] * d[j]
    # ∂²σ/∂s² = (P − d dᵀ)/σ, σ² = s:P s
    if n == 3:
        A[0, 0] += tangential
    else:
        for i in range(3):
            for j in range(3):
                A[i, j] += tangential * (1.0 if i == j else -0.5)
    for i in range(1 if n == 3 else 3, n):
        A[i, i] += 3.0 * tangential
    return u


# Equivalent creep strain of a stage and its derivatives in σ, in u at its start and in the logarithm of its time; u at
# its end, and its derivatives in σ and in that logarithm.
Creep = namedtuple("Creep", "strain by_stress by_start by_time u u_by_stress u_by_time")


@njit(**KERNEL)
def creep_strain(q: np.ndarray, sigma: float, u0: float, h: float) -> Creep:
    """u^p − u₀^p under the constant equivalent stress σ, u = u₀ + h φ^(1/p)."""
    if h == 0.0:
        return Creep(0.0, 0.0, 0.0, 0.0, u0, 0.0, 0.0)
    g, slope = rate(q, sigma)
    power, u = q[POWER], u0 + h * g
    if not u > 0.0:
        return Creep(0.0, 0.0, 0.0, 0.0, u, 0.0, 0.0)
    c = u**power
    before = u0**power if u0 > 0.0 else 0.0
    d_c = power * c / u
    return Creep(
        c - before, d_c * h * slope, d_c - (power * before / u0 if u0 > 0.0 else 0.0), d_c * h * g, u, h * slope, h * g
    )
