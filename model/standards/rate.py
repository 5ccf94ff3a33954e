"""The rate of a spring from the torsion of its wire alone."""

from typing import Literal

import numpy as np

from coilset.meshes.springs import functions
from coilset.meshes.springs.geometry import Spring
from coilset.model.section.outline import Outlined


def torsion_rate(spring: Spring, shear_modulus: float) -> float:
    """Initial rate for torsion of the wire alone and small pitch, N/mm.

    Castigliano's `1/R = 64/G ∫ r³/d⁴ dt` over the active turns: R = G d⁴/(8 D³ n) of EN 13906-1 for a cylinder, and
    R = G d⁴/(2 n (D1 + D2)(D1² + D2²)) for a cone (Wahl, Mechanical Springs, chapter on conical springs). Of wire that
    is not round π d⁴/32 is its torsion constant.

    Args:
        spring: `Spring`.
        shear_modulus: G, MPa.
    """
    start, end = spring.bottom.end_turns, spring.turns - spring.top.end_turns
    breaks = np.concatenate([[start], spring.breaks[(spring.breaks > start) & (spring.breaks < end)], [end]])
    compliance = functions.integral(lambda t: spring.mean_radius(t) ** 3 / spring.wire_diameter(t) ** 4, breaks).sum()
    rate = float(shear_modulus / (64 * compliance))
    if spring.section is None:
        return rate
    return rate * Outlined(spring.section).warping().torsion / (0.5 * np.pi)  # J of a disk of radius 1


def pitch_compliance(angle: float, nu: float, ends: Literal["turning", "held"] = "turning") -> float:
    """Compliance of a cylindrical spring over that of R = G d⁴/(8 D³ n), due to the wire's pitch angle.

    An axial force F on a helix of radius r and pitch angle α twists the wire by F r cos α and bends it by F r sin α,
    over the length 2π r n/cos α. With EI = (1 + ν) G Ip of round wire, Castigliano gives for ends that may turn

        cos α (1 + tan²α/(1 + ν)) = 1 + tan²α (1 − ν)/(2 (1 + ν)) + O(α⁴).

    Fixed ends add a couple T about the axis, which makes the rotation zero; the moments are F r cos α + T sin α
    and F r sin α − T cos α, and the result is 1/[cos α (cos²α + (1 + ν) sin²α)] = 1 + tan²α (½ − ν) + O(α⁴).

    Args:
        angle: pitch angle α, rad; tan α = pitch/(π D).
        nu: Poisson's ratio.
        ends: whether the ends may turn about the axis.
    """
    s, c = np.sin(angle), np.cos(angle)
    if ends == "turning":
        return float(c + s**2 / ((1 + nu) * c))
    return float(1 / (c * (c**2 + (1 + nu) * s**2)))
