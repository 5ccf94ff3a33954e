"""Creep of a point: the equivalent creep strain under constant stress, and its slopes.

The equivalent creep strain c grows under the equivalent stress σ (von Mises), in the direction of the stress deviator,

    c = φ(σ) t^p,   φ = c₀ (σ/σ₀)^N  (Norton-Bailey)   or   c₀ sinh(σ/σ₀)^N  (Garofalo's form),

with t in hours, scaled with temperature, see `creep.law`. When the stress changes, strain hardening uses the rate at
the current c, time hardening the rate at the current t. Both become smooth rates in other variables,

    strain hardening   u = c^(1/p),   du/dt = φ^(1/p)          time hardening   u = c,   du/d(t^p) = φ,

so that c(t) is exact under constant stress, even from t = 0, where dc/dt is infinite.
"""

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
