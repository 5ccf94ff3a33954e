"""The constitutive law of the rod: σ11, τ12, τ13 from ε11, γ12, γ13, with σ22 = σ33 = τ23 = 0 (5.2.32).

A point's state is a row of σ11, τ12, τ13, B11, B12, B13 (N/mm²), b* (N/mm²) and, with adiabatic heating, the
temperature (K). The active deviator is n11 = ⅔σ11 − B11, n1j = τ1j − B1j, and n:n = 3/2 n11² + 2 n12² + 2 n13²
(5.2.28).
"""

from collections import namedtuple

import numpy as np
from numba import njit

from coilset.model.base.kernel import INLINE, KERNEL
from coilset.model.material.law.functions import (
    CHANGE,
    EXPONENT,
    HEATING,
    SPIN,
    TEMPERATURE,
    elasticity,
    functions,
)
from coilset.model.material.point.local import surface, yield_crossing
from coilset.model.material.point.perzyna import solve_at_rate
from coilset.model.material.point.rod_plastic import Plastic, active, add, begin, end, inner, scaled, softening
from coilset.model.material.point.spin import WHOLE, Crossing, Vector, spun

# Where the increment starts, and by columns how its spin changes that with ε11, γ12, γ13.
Point = namedtuple("Point", "stress back spin_stress spin_back")
NOTHING = (0.0, 0.0, 0.0)


@njit(**INLINE)
def crossing_of_spin(s: Vector, B: Vector, k2: float, E: float, G: float, e: Vector) -> Crossing:
    """Where the elastic path leaves the yield surface; e is the increment of the active deviator."""
    n = active(s, B)
    nn, ne, ee = inner(n, n), inner(n, e), inner(e, e)
    if nn + 2.0 * ne + ee <= k2 * (1.0 + 1e-12):
        return WHOLE
    beta = yield_crossing(nn, ne, ee, k2)
    at = add(n, scaled(e, beta))
    slope = inner(at, e)
    if beta <= 0.0 or beta >= 1.0 or slope <= 0.0:
        return Crossing(beta, NOTHING)
    f = -beta / slope
    return Crossing(beta, (f * E * at[0], 2.0 * f * G * at[1], 2.0 * f * G * at[2]))


@njit(**INLINE)
def _start(
    p: np.ndarray, old: np.ndarray, k2: float, E: float, G: float, de11: float, dg12: float, dg13: float
) -> Point:
    """Stress and back stress from which Hooke's law gives the elastic response: those of `old`, or with its spin."""
    s, B = (old[0], old[1], old[2]), (old[3], old[4], old[5])
    if p[SPIN] == 0.0:
        nothing = (NOTHING, NOTHING, NOTHING)
        return Point(s, B, nothing, nothing)
    crossing = crossing_of_spin(s, B, k2, E, G, (E * de11 / 1.5, G * dg12, G * dg13))
    turned = spun(s, B, E, G, de11, dg12, dg13, crossing)
    return Point(turned.stress, turned.back, turned.d_stress, turned.d_back)


@njit(**KERNEL)
def return_map(
    p: np.ndarray, old: np.ndarray, de11: float, dg12: float, dg13: float, new: np.ndarray, C: np.ndarray
) -> int:
    """One increment of the rod's law, of second order (see `local`), with its consistent tangent.

    Args:
        p: parameter array of the law, `Law.parameters()`.
        old: the point's state at the start, shape (7,) or, with adiabatic heating, (8,); not written.
        de11, dg12, dg13: increments of ε11, γ12 = 2ε12, γ13.
        new: the state at the end; always fully written.
        C: d(σ11, τ12, τ13)/d(ε11, γ12, γ13), shape (3, 3), N/mm²; written.

    Returns:
        Number of local iterations, 0 for an elastic increment, -1 if there was no convergence, -2 if the point heated
        itself out of the material's table (then `new` is `old`, C elastic).
    """
    temperature = old[7] if old.shape[0] > 7 else p[TEMPERATURE]
    heating = p[HEATING] if old.shape[0] > 7 else 0.0
    E, G, alpha = elasticity(p, temperature - 0.5 * p[CHANGE])
    values = functions(p, old[6], temperature)
    point = _start(p, old, values[0], E, G, de11, dg12, dg13)
    s = (point.stress[0] + E * de11, point.stress[1] + G * dg12, point.stress[2] + G * dg13)
    _elastic(old, s, point, E, G, new, C)
    n0 = active(point.stress, point.back)
    trial = active(s, point.back)
    if inner(trial, trial) <= values[0] * (1.0 + 1e-12):
        return 0

    e = (E * de11 / 1.5, G * dg12, G * dg13)
    k2, growth = surface(p, old[6], temperature, values[0])
    outside = p[EXPONENT] > 0.0 and inner(n0, n0) > k2
    beginning = begin(old[6], temperature, heating, alpha, E, G, n0, e, k2, growth, outside)
    local = solve_at_rate(p, beginning.start, values)
    if local.iterations < 0:
        for i in range(new.shape[0]):
            new[i] = old[i]
        return local.iterations
    if local.neutral:
        heating = 0.0
    plastic = end(beginning, local, heating, alpha * heating)
    pl = plastic.p
    rise = plastic.heating * (local.b - old[6])
    new[0] = s[0] - E * (pl[0] + alpha * rise)
    new[1] = s[1] - 2.0 * G * pl[1]
    new[2] = s[2] - 2.0 * G * pl[2]
    for i in range(3):
        new[3 + i] = point.back[i] + local.zeta * pl[i]  # (3.1.8)
    new[6] = local.b
    if old.shape[0] > 7:
        new[7] = temperature + rise
    _tangent(p[SPIN] != 0.0, plastic, point, E, G, alpha * plastic.heating, C)
    return local.iterations


@njit(**INLINE)
def _elastic(old: np.ndarray, s: Vector, point: Point, E: float, G: float, new: np.ndarray, C: np.ndarray) -> None:
    for i in range(3):
        new[i] = s[i]
        new[3 + i] = point.back[i]
    for i in range(6, old.shape[0]):
        new[i] = old[i]
    for i in range(3):
        C[i, 0] = point.spin_stress[0][i]
        C[i, 1] = point.spin_stress[1][i]
        C[i, 2] = point.spin_stress[2][i]
    C[0, 0] += E
    C[1, 1] += G
    C[2, 2] += G


@njit(**INLINE)
def _tangent(spins: bool, plastic: Plastic, point: Point, E: float, G: float, expansion: float, C: np.ndarray) -> None:
    """Subtract the effect of the plastic strain from the elastic tangent in C; `expansion` is thermal strain per b*."""
    taken = softening(plastic, plastic.beta, E, G, expansion)
    for i in range(3):
        C[i, 0] -= taken[0][i] * (E / 1.5)
        C[i, 1] -= taken[1][i] * G
        C[i, 2] -= taken[2][i] * G
    if spins:  # which changes n₀ with ε11, γ12, γ13
        taken = softening(plastic, 1.0, E, G, expansion)
        for j in range(3):
            dn = active(point.spin_stress[j], point.spin_back[j])
            for i in range(3):
                C[i, j] -= taken[0][i] * dn[0] + taken[1][i] * dn[1] + taken[2][i] * dn[2]
