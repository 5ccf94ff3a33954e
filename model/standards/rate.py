"""The rate of a spring from its wire's torsion alone."""

import numpy as np

from coilset.meshes import functions
from coilset.meshes.geometry import Spring


def torsion_rate(spring: Spring, shear_modulus: float) -> float:
    """Initial rate if only the wire's torsion counts and the pitch is small, N/mm.

    Castigliano's `1/R = 64/G ∫ r³/d⁴ dt` over the active turns: R = G d⁴/(8 D³ n) of EN 13906-1 for a cylinder, and
    R = G d⁴/(2 n (D1 + D2)(D1² + D2²)) for a cone (Wahl, Mechanical Springs, chapter on conical springs).

    Args:
        spring: `Spring`.
        shear_modulus: G, MPa.
    """
    start, end = spring.bottom.end_turns, spring.turns - spring.top.end_turns
    breaks = np.concatenate([[start], spring.breaks[(spring.breaks > start) & (spring.breaks < end)], [end]])
    compliance = functions.integral(lambda t: spring.mean_radius(t) ** 3 / spring.wire_diameter(t) ** 4, breaks).sum()
    return float(shear_modulus / (64 * compliance))
