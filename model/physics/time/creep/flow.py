"""Creep of a point: the equivalent creep strain under constant stress, and its slopes.

The equivalent creep strain c grows under the equivalent stress σ (von Mises), in the direction of the stress deviator,

    c = φ(σ) t^p,   φ = c₀ f(σ/σ₀)^N,

by one of the `forms` f, with t in hours, scaled with temperature, see `creep.law`. When the stress changes, strain
hardening uses the rate at the current c, time hardening the rate at the current t. Both become smooth rates in other
variables,

    strain hardening   u = c^(1/p),   du/dt = φ^(1/p)          time hardening   u = c,   du/d(t^p) = φ,

so that c(t) is exact under constant stress, even from t = 0, where dc/dt is infinite.
"""

import math
from collections import namedtuple
from collections.abc import Callable
from typing import Any

import numpy as np

from coilset.model.core.runtime.kernels import INLINE, KERNEL, njit
from coilset.model.physics.time.creep.forms import FORMS

# The array of creep. TIME: the increment of t, or of t^p for time hardening; POWER: p, or 1; FORM: number in FORMS;
# SPEED, STRESS, EXPONENT: c₀^(1/POWER), σ₀ in N/mm² and N/POWER of φ^(1/POWER); TEMPERATURE: at the increment's end, K.
# ENERGY: Q/R in K where each point has a temperature of its own, which stays during the increment, and TIME is hours,
# not yet scaled; else SCALED. T0: of the constants, K.
TIME, POWER, FORM, SPEED, STRESS, EXPONENT, TEMPERATURE, ENERGY, T0 = range(9)
SCALED = -1.0
MAX_ITERATIONS = 60
TOLERANCE = 1e-11  # of the creep strain's last correction, over the strain
FINE = 1e-6  # of log χ; after a correction by Newton's method of this size the next one would be of its square
MOST = 1e60  # χ c at the start, where the creep strain of the elastic stress is beyond all numbers
UNKEPT = {option: value for option, value in INLINE.items() if option != "cache"}  # with its caller instead


def _compiled(number: int, forms: list[Any]) -> Callable[[float, float], tuple[float, float]]:
    """`factor` of the form with a number, from this one on."""
    this = njit(**UNKEPT)(forms[number].factor)
    if number == len(forms) - 1:
        return njit(**UNKEPT)(lambda form, x: this(x))
    others = _compiled(number + 1, forms)
    return njit(**UNKEPT)(lambda form, x: this(x) if form == number else others(form, x))


factor = _compiled(0, [*FORMS.values()])


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
    f, slope = factor(q[FORM], x)
    g = q[SPEED] * f ** q[EXPONENT]
    return g, g * (q[EXPONENT] * slope) / stress


# Equivalent creep strain of a stage and its derivatives in σ, in u at its start and in the logarithm of its time; u at
# its end, and its derivatives in σ and in that logarithm.
Creep = namedtuple("Creep", "strain by_stress by_start by_time u u_by_stress u_by_time")


@njit(**KERNEL)
def creep_strain(q: np.ndarray, sigma: float, u0: float, h: float) -> Creep:
    """u^p − u₀^p under the constant equivalent stress σ, u = u₀ + h φ^(1/p)."""
    return _creep_strain(q, sigma, u0, u0 ** q[POWER] if u0 > 0.0 else 0.0, h)


@njit(**INLINE)
def _creep_strain(q: np.ndarray, sigma: float, u0: float, before: float, h: float) -> Creep:
    """`creep_strain`, with u₀^p."""
    if h == 0.0:
        return Creep(0.0, 0.0, 0.0, 0.0, u0, 0.0, 0.0)
    g, slope = rate(q, sigma)
    power, grown = q[POWER], h * g
    u = u0 + grown
    if not grown > 0.0:
        return Creep(0.0, 0.0, 0.0, 0.0, u, 0.0, 0.0)
    # without the rounding of a difference, however little grows
    c = before * math.expm1(power * math.log1p(grown / u0)) if u0 > 0.0 else grown**power
    d_c = power * (before + c) / u
    return Creep(c, d_c * h * slope, d_c - (power * before / u0 if u0 > 0.0 else 0.0), d_c * grown, u, h * slope, grown)


@njit(**KERNEL)
def crept(
    q: np.ndarray, squares: tuple[float, float], moduli: tuple[float, float], u0: float, h: float
) -> tuple[float, int]:
    """χ of χ σ = 1.5 Δc(σ, u₀) of a backward Euler step, and iterations, −1 if there is none.

    In logarithms the difference of both sides increases with log χ, linearly where creep is little and where it is
    much. Newton's method starts at the creep strain of the elastic stress, above the root, and is kept in a bracket.

    Args:
        q: array of creep.
        squares: parts of σ² without the step's creep, of the components with each of two moduli.
        moduli: c of these, T = c (ē − χ T), N/mm².
        u0: u at the start.
        h: the step's time.
    """
    (first, other), (first_c, c) = squares, moduli
    sigma, before = math.sqrt(first + other), u0 ** q[POWER] if u0 > 0.0 else 0.0
    of = _creep_strain(q, sigma, u0, before, h)
    if not of.strain > 0.0:  # nothing
        return 0.0, 0 if of.strain == of.strain else -1
    chi, strain = min(1.5 * of.strain / sigma, MOST / c), 1.5 * sigma / first_c
    low, high, last = 0.0, math.inf, 0.0
    for iteration in range(1, MAX_ITERATIONS):
        a, b = 1.0 / (1.0 + first_c * chi), 1.0 / (1.0 + c * chi)
        sa, sb = first * a * a, other * b * b
        sigma = math.sqrt(sa + sb)
        of = _creep_strain(q, sigma, u0, before, h)
        if of.strain > 0.0:
            falls = (first_c * chi * a * sa + c * chi * b * sb) / (sa + sb)  # −d log σ/d log χ
            step = math.log(1.5 * of.strain / (chi * sigma)) / (1.0 + (of.by_stress * sigma / of.strain - 1.0) * falls)
            if abs(step) <= FINE or abs(step) * chi * sigma <= TOLERANCE * (strain + of.strain) + 1e-16:
                return chi * (1.0 + step), iteration
        else:  # under so small a stress
            step = -math.inf
        low, high = (chi, high) if step > 0.0 else (low, chi)
        to = chi * math.exp(step)
        if not low < to < high or (step * last < 0.0 and abs(step) > 0.5 * abs(last)):
            to = math.sqrt(low * high) if low > 0.0 and high < math.inf else chi * (1e3 if step > 0.0 else 1e-3)
        last = math.log(to / chi)
        chi = to
    return 0.0, -1
