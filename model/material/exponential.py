"""exp(x) and exp(x) − 1 without branches and calls, so that compilers can vectorise over points.

x = n ln 2 + r with an integer n and |r| ≤ ½ ln 2. The Taylor series of exp(r) − 1 up to r¹³ is exact to rounding, and
2ⁿ is written into the exponent of a number. Errors are below 3e-16 of exp(x), and of exp(x) − 1 for |x| ≤ ½ ln 2.
"""

from typing import Any

from llvmlite import ir
from numba import njit, types
from numba.extending import intrinsic

from coilset.model.material.kernel import INLINE

LEAST, GREATEST = -700.0, 700.0  # arguments are limited to these: results 1e-304 and 1e304
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
    """2ⁿ and exp(r) − 1."""
    x = x if x > LEAST else LEAST
    x = x if x < GREATEST else GREATEST
    shifted = x * LOG2_E + ROUND
    n = shifted - ROUND
    r = (x - n * LN2_HIGH) - n * LN2_LOW
    tail = 1.0 / 479001600.0 + r * (1.0 / 6227020800.0)
    for k in (39916800.0, 3628800.0, 362880.0, 40320.0, 5040.0, 720.0, 120.0, 24.0, 6.0, 2.0):
        tail = 1.0 / k + r * tail
    return _number((_bits(shifted) + BIAS) << 52), r + r * r * tail


@njit(**INLINE)
def exp(x: float) -> float:
    """exp(x)."""
    scale, rest = _reduced(x)
    return scale + scale * rest


@njit(**INLINE)
def expm1(x: float) -> float:
    """exp(x) − 1, exact to rounding also for small x."""
    scale, rest = _reduced(x)
    return (scale - 1.0) + scale * rest
