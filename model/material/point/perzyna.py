"""Yield that depends on the rate (P. Perzyna, Quart. Appl. Math. 20, 1963), in the same local problem as without it.

The stress may lie beyond the static surface, |n| = k v, by as much as the plastic strain rate allows,

    ṗ = ṗ₀ (v − 1)^m,   v ≥ 1,   ṗ = ḃ*/(√1.5 |n|).

An increment of length Δt ends with its mean rate: b* − b*₀ = √1.5 k(b*) v ṗ₀ Δt (v − 1)^m. For a given v the local
problem is that of `local` with k² v² in the place of k². Its b* decreases with v, the right-hand side increases: there
is one root between the static surface, v = 1, and the elastic response, v = |n₀ + e|/k. It is found by Newton's method,
kept in a bracket, for the logarithms of both sides over z = log((v − 1)/(v_elastic − v)), where they are nearly linear
at both ends. Without time, or where 1/(ṗ₀ Δt) is 0, this is the rate-independent law. The error in time is of first
order.
"""

import math

import numpy as np
from numba import njit

from coilset.model.base.kernel import KERNEL
from coilset.model.material.law.functions import EXPONENT, RATE, Functions, functions
from coilset.model.material.point.local import FAILED, MAX_ITERATIONS, Local, Start, axial_products, solve

CLOSE = 1e-12  # of v, by which Newton's last correction changes it
FURTHEST = 34.0  # |z|, where v − 1 or the rest is rounding


@njit(**KERNEL)
def solve_at_rate(p: np.ndarray, start: Start, values: Functions) -> Local:
    """`local.solve`, with the overstress of the increment's rate if yield depends on it; arguments as there."""
    static = solve(p, start, values, 1.0)
    if p[RATE] == 0.0 or static.iterations < 0 or static.b <= start.b:
        return static
    a = axial_products(start, start.b)
    trial = a[0] + 2.0 * a[1] + a[2] + start.nn + 2.0 * start.ne + start.ee
    room, m = math.sqrt(trial / values[0]) - 1.0, p[EXPONENT]
    time = math.sqrt(1.5) / p[RATE]
    low, high = -FURTHEST, FURTHEST
    first = ((static.b - start.b) / (time * math.sqrt(values[0]))) ** (1.0 / m)
    z = math.log(first / (room - first)) if first < 0.999 * room else 0.0
    z = min(max(z, 0.5 * low), 0.5 * high)
    for _ in range(MAX_ITERATIONS):
        rest = math.exp(-z)
        above = room / (1.0 + rest)
        v = 1.0 + above
        local = solve(p, start, values, v * v)
        if local.iterations < 0:
            return local
        gain = local.b - start.b
        k2, dk2, _, _, _, _ = functions(p, local.b, start.temperature + start.heating * gain)
        ended = high - low < 1e-9
        if gain <= 0.0 and not ended:
            high = z
            z = 0.5 * (low + high)
            continue
        gain = max(gain, 1e-300)
        off = math.log(time * math.sqrt(k2) * v) + m * math.log(above) - math.log(gain)
        growth = 1.0 / gain - 0.5 * dk2 / k2  # of log(b* − b*₀)/k along b*
        own = 1.0 / v + m / above
        slope = own - 2.0 * k2 * v * local.r2l * growth  # by v; db*/dv from the local problem
        noise = 1e-11 + 1e-14 * (local.b + k2 / start.cc) / gain  # of log(b* − b*₀), see `local.is_last`
        if abs(off) <= CLOSE * slope * v + noise or ended:
            return _with_slope(local, 2.0 * k2 * v * growth / own)
        if off > 0.0:
            high = z
        else:
            low = z
        z -= off / (slope * above * rest / (1.0 + rest))
        if not low < z < high:
            z = 0.5 * (low + high)
    return Local(FAILED, False, start.b, 0.0, 0.0, static.a, static.c, 0.0, 0.0, 0.0, 0.0)


@njit(**KERNEL)
def _with_slope(at: Local, slope: float) -> Local:
    """The Jacobian of the local equations where k² v² also grows by `slope` with b*, through the rate."""
    determinant = 1.0 / (at.r1b * at.r2l - at.r1l * at.r2b)
    r1b, r1l, r2b, r2l = at.r1b * determinant - slope, at.r1l * determinant, at.r2b * determinant, at.r2l * determinant
    inverse = 1.0 / (r1b * r2l - r1l * r2b)
    return Local(
        at.iterations,
        at.neutral,
        at.b,
        at.zeta,
        at.dzeta,
        at.a,
        at.c,
        r1b * inverse,
        r1l * inverse,
        r2b * inverse,
        r2l * inverse,
    )
