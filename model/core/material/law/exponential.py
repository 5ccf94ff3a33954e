"""exp(x), and how n decays, without branches and calls, so that compilers can vectorise over points.

x = n ln 2 + r with an integer n and |r| ≤ ½ ln 2, and 2ⁿ is written into the exponent of a number. With
exp(r) = 1 + r + r² (½ + r S(r)), S is a polynomial that agrees with its series Σ rᵏ/(k + 3)! at Chebyshev's points of
the interval: that leaves an error of 3e-17 of exp(r), and of 8e-17 of exp(r) − 1. Its terms are summed in pairs
(Estrin's scheme), so that few of them wait for each other. Errors of exp(x) and φ are below 2e-16 of them, of ψ below
4e-16.
"""

from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from coilset.model.core.runtime.kernels import INLINE, njit

LEAST = -700.0  # smaller arguments are taken for this one, exp(x) = 1e-304; none are greater than 700
LOG2_E = 1.4426950408889634
LN2_HIGH, LN2_LOW = 0.6931471803691238, 1.9082149292705877e-10  # 33 bits of ln 2, and the rest
ROUND = 6755399441055744.0  # 1.5 · 2⁵²: a number added to it is rounded to an integer, found in its last bits
BIAS = 1023  # bias and shift of a number's exponent, which starts at bit 52


@intrinsic
def _bits(context: Any, x: Any) -> Any:
    """The bits of a number, as a whole number."""
    return types.int64(types.float64), lambda context, builder, signature, arguments: builder.bitcast(
        arguments[0], ir.IntType(64)
    )


@intrinsic
def _number(context: Any, bits: Any) -> Any:
    """The number that has these bits."""
    return types.float64(types.int64), lambda context, builder, signature, arguments: builder.bitcast(
        arguments[0], ir.DoubleType()
    )


@njit(**INLINE)
def _reduced(x: float) -> tuple[float, float]:
    """2ⁿ and r."""
    x = x if x > LEAST else LEAST
    shifted = x * LOG2_E + ROUND
    n = shifted - ROUND
    return _number((_bits(shifted) + BIAS) << 52), (x - n * LN2_HIGH) - n * LN2_LOW


@njit(**INLINE)
def _rest(r: float) -> float:
    """½ + r S(r)."""
    r2 = r * r
    low = (0.16666666666666666 + r * 0.041666666666651364) + r2 * (0.008333333333332157 + r * 0.0013888888905871355)
    high = (1.9841269854330778e-4 + r * 2.4801536409043718e-5) + r2 * (2.755728008266902e-6 + r * 2.761379556582631e-7)
    r4 = r2 * r2
    return 0.5 + r * (low + r4 * (high + r4 * 2.5095545990395195e-8))


@njit(**INLINE)
def exp(x: float) -> float:
    """exp(x)."""
    scale, r = _reduced(x)
    return scale + scale * (r + r * r * _rest(r))


@njit(**INLINE)
def decay(z: float) -> tuple[float, float, float]:
    """φ = exp(−z), ψ = (1 − φ)/z and dψ/dz, exact to rounding also for small z."""
    scale, r = _reduced(-z)
    rest = _rest(r)
    psi = 1.0 + r * rest  # of −r, as are φ = 1 + r ψ and dψ/dz = (φ − ψ)/z = rest − ψ where n = 0
    fallen, inverse = scale * (r * psi), 1.0 / z
    phi, far, near = scale + fallen, ((1.0 - scale) - fallen) * inverse, scale == 1.0
    return phi, psi if near else far, rest - psi if near else (phi - far) * inverse
