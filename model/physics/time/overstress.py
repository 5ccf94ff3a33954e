"""Yield that depends on the rate (P. Perzyna, Quart. Appl. Math. 20, 1963), a part of the point problem (`stage`).

The stress may lie beyond the static surface, |n| = v k, by as much as the plastic strain rate allows,

    ṗ = ṗ₀ (v − 1)^m,   v ≥ 1.

With the plastic strain p of a stage and ρ = ṗ₀ Δt of its time, p = ρ (v − 1)^m. Without deviation from normality p =
√⅔ D/(v k), D the stage's plastic work, so that v follows from D alone: log v + m log (v − 1) = log (√⅔ D/(ρ k)).
"""

import math

from coilset.model.core.runtime.kernels import KERNEL, njit

MAX_ITERATIONS = 40
ROOT = math.sqrt(2.0 / 3.0)


@njit(**KERNEL)
def of_work(reference: float, m: float, work: float, k: float) -> tuple[float, float]:
    """v, and d log v/d log(D/(ρ k)).

    Args:
        reference: ρ.
        m: exponent.
        work: D.
        k: size of the static surface.
    """
    wanted = math.log(ROOT * work / (reference * k))
    x = wanted / m if wanted < 0.0 else wanted / (m + 1.0)  # of log(v − 1); both are on the same side of the root
    for _ in range(MAX_ITERATIONS):
        above = math.exp(x)
        step = (wanted - math.log1p(above) - m * x) / (m + above / (1.0 + above))
        x += step
        if abs(step) <= 1e-14 * (1.0 + abs(x)):
            break
    above = math.exp(x)
    return 1.0 + above, 1.0 / (1.0 + m * (1.0 + above) / above)
