"""The material functions k²(b*, T), ζ(b*, T), κ(b*, T) of chapter 3, compiled, and the array of their constants.

The kernels take one 1-D array `p`: a head of `ROWS_START` entries, then one row of `ROW_LENGTH` constants for every
temperature of the material's table. Between two temperatures the values of the functions are interpolated linearly.
The rows are followed by the curves of k² that are given by points (`coilset.model.core.material.law.hardening_curves`).
"""

import math

import numpy as np

from coilset.model.core.material.law.exponential import exp
from coilset.model.core.runtime.kernels import INLINE, KERNEL, njit

# k², ∂k²/∂b*, ζ, ∂ζ/∂b*, κ, ∂κ/∂b*.
Functions = tuple[float, float, float, float, float, float]

# Head of the parameter array.
SPIN = 0  # 1: with the spin terms (5.2.33), 0: without
TEMPERATURE = 1  # K, of points whose state holds none, at the end of the increment
HEATING = 2  # K mm²/N: rise of temperature per plastic work b*; 0: isothermal
CHANGE = 3  # K: prescribed change of temperature over the increment; 0: isothermal or adiabatic
N_ROWS = 4  # number of temperatures
RATE = 5  # 1/(ṗ₀ Δt) of an increment that takes the time Δt; 0: yield does not depend on the rate
EXPONENT = 6  # m of rate-dependent yield, see `overstress`; 0: yield never depends on the rate
HELD = 7  # 1: tangents hold the place where κ sets in, and the κ of neutral loading; 0: they follow them
ROWS_START = 8

# A row: temperature, elastic constants, then the constants of 6.2.2 by their names there; KAPPA is a/(2G). CURVE is
# where in `p` the points of k² begin, NODES their number, 0 if k² is that of 6.2.2.
ROW_T, YOUNG, SHEAR, ALPHA, K0, A1, A2, A3, B1, K1, KINF, A4, A5, A6, A7, KAPPA, CURVE, NODES = range(18)
ROW_LENGTH = 18


@njit(**KERNEL)
def curve(p: np.ndarray, o: int, b: float) -> tuple[float, float]:
    """k², dk²/db* between the points of a curve, whose row starts at `o`: cubic with their slopes, constant beyond.

    The points are b*, k² and dk²/db*, one array after the other.
    """
    start, n = int(p[o + CURVE]), int(p[o + NODES])
    low, high = 0, n - 1
    if b >= p[start + high]:
        return p[start + n + high], 0.0
    while high - low > 1:
        middle = (low + high) // 2
        if b < p[start + middle]:
            high = middle
        else:
            low = middle
    at = start + low
    h = p[at + 1] - p[at]
    t = (b - p[at]) / h
    k, k_up, m, m_up = p[at + n], p[at + n + 1], h * p[at + 2 * n], h * p[at + 2 * n + 1]
    square, cubic = 3.0 * (k_up - k) - 2.0 * m - m_up, 2.0 * (k - k_up) + m + m_up
    return k + t * (m + t * (square + t * cubic)), (m + t * (2.0 * square + 3.0 * t * cubic)) / h


@njit(**INLINE)
def row_functions(p: np.ndarray, o: int, b: float) -> Functions:
    """k², ∂k²/∂b*, ζ, ∂ζ/∂b*, κ, ∂κ/∂b* of the temperature whose row starts at `o` of `p`, (6.2.2)."""
    if p[o + NODES] > 0.0:
        k2, dk2 = curve(p, o, b)
    else:
        k2, dk2 = hardening(p, o, b)
    return with_deviation(p, o, b, k2, dk2)


@njit(**INLINE)
def hardening(p: np.ndarray, o: int, b: float) -> tuple[float, float]:
    """k² and ∂k²/∂b* by the constants of (6.2.2)."""
    # all constants are read before anything branches, so that loops over points can take several of them at once
    k0, a1, a2, a3, b1 = p[o + K0], p[o + A1], p[o + A2], p[o + A3], p[o + B1]
    k1, kinf, a4 = p[o + K1], p[o + KINF], p[o + A4]
    first = b < b1
    e = exp(-a3 * b if first else -a4 * (b - b1))
    rest = (kinf - k1) * e
    low, high = k0 + a1 * (1.0 + a2 * b - e), kinf - rest
    low_slope, high_slope = a1 * (a2 + a3 * e), a4 * rest
    return low if first else high, low_slope if first else high_slope


@njit(**INLINE)
def with_deviation(p: np.ndarray, o: int, b: float, k2: float, dk2: float) -> Functions:
    """All functions, from k² and its slope."""
    a5, a6, a7 = p[o + A5], p[o + A6], p[o + A7]
    e = a7 * exp(-a7 * b)
    scale = a5 * math.sqrt(6.0 * k2) if a5 != 0.0 else 0.0  # k² may be infinite
    zeta = (a6 + e) * scale
    dzeta = zeta * (0.5 * dk2 / k2) - a7 * e * scale
    kappa = p[o + KAPPA] * b * b * b
    return k2, dk2, zeta, dzeta, kappa, 3.0 * p[o + KAPPA] * b * b


@njit(**INLINE)
def table_place(p: np.ndarray, temperature: float) -> tuple[int, float]:
    """Row below `temperature` (its offset in `p`) and the weight of the row above; see `inside_table`."""
    last = int(p[N_ROWS]) - 2
    row = 0
    while row < last and temperature > p[ROWS_START + (row + 1) * ROW_LENGTH]:
        row += 1
    o = ROWS_START + row * ROW_LENGTH
    return o, (temperature - p[o]) / (p[o + ROW_LENGTH] - p[o])


@njit(**INLINE)
def functions(p: np.ndarray, b: float, temperature: float) -> Functions:
    """k², ζ, κ and their slopes at plastic work `b` and `temperature`.

    With adiabatic heating the slopes are total ones along b*, d/db* = ∂/∂b* + HEATING ∂/∂T, because there the
    temperature is a function of b*.

    Returns:
        k² (N²/mm⁴), dk²/db* (N/mm²), ζ (N/mm²), dζ/db* (1), κ (mm²/N), dκ/db* (mm⁴/N²).
    """
    if p[N_ROWS] == 1.0:
        return row_functions(p, ROWS_START, b)
    o, w = table_place(p, temperature)
    k2, dk2, zeta, dzeta, kappa, dkappa = row_functions(p, o, b)
    if k2 == math.inf:
        return k2, dk2, zeta, dzeta, kappa, dkappa
    k2_up, dk2_up, zeta_up, dzeta_up, kappa_up, dkappa_up = row_functions(p, o + ROW_LENGTH, b)
    slope = p[HEATING] / (p[o + ROW_LENGTH] - p[o])
    return (
        k2 + w * (k2_up - k2),
        dk2 + w * (dk2_up - dk2) + slope * (k2_up - k2),
        zeta + w * (zeta_up - zeta),
        dzeta + w * (dzeta_up - dzeta) + slope * (zeta_up - zeta),
        kappa + w * (kappa_up - kappa),
        dkappa + w * (dkappa_up - dkappa) + slope * (kappa_up - kappa),
    )


@njit(**INLINE)
def inside_table(p: np.ndarray, temperature: float) -> bool:
    """Whether the material's table covers `temperature`."""
    last = ROWS_START + (int(p[N_ROWS]) - 1) * ROW_LENGTH
    return p[ROWS_START] <= temperature <= p[last]


@njit(**KERNEL)
def many(p: np.ndarray, works: np.ndarray, temperature: float, values: np.ndarray) -> None:
    """`functions` at many plastic works; `values` has shape (6, works)."""
    for i in range(works.shape[0]):
        values[0, i], values[1, i], values[2, i], values[3, i], values[4, i], values[5, i] = functions(
            p, works[i], temperature
        )


@njit(**INLINE)
def elasticity(p: np.ndarray, temperature: float) -> tuple[float, float, float]:
    """E, G in N/mm² and the coefficient of thermal expansion in 1/K at `temperature`."""
    o = ROWS_START
    if p[N_ROWS] == 1.0:
        return p[o + YOUNG], p[o + SHEAR], p[o + ALPHA]
    o, w = table_place(p, temperature)
    u = o + ROW_LENGTH
    return (
        p[o + YOUNG] + w * (p[u + YOUNG] - p[o + YOUNG]),
        p[o + SHEAR] + w * (p[u + SHEAR] - p[o + SHEAR]),
        p[o + ALPHA] + w * (p[u + ALPHA] - p[o + ALPHA]),
    )
