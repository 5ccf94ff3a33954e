"""Buckling of compression springs after EN 13906-1."""

import numpy as np

from coilset.meshes.geometry import Spring
from coilset.model.standards.steel import STEEL

SEATING = 0.5  # EN 13906-1: seating coefficient ν of ends guided by parallel seats


def buckling_travel(
    spring: Spring, modulus_ratio: float = STEEL.shear_modulus / STEEL.young_modulus, seating: float = SEATING
) -> float:
    """Travel at which a spring buckles, after EN 13906-1, mm; infinite if it never does.

    Args:
        spring: `Spring`; its least mean diameter counts.
        modulus_ratio: G/E.
        seating: ν of the standard, 0.5 for ends on parallel guided seats, 2 for one free end.
    """
    length, diameter = spring.free_length, 2 * np.min(spring.mean_radius(spring.breaks))
    γ = 1 - modulus_ratio
    under_root = 1 - γ / (0.5 + modulus_ratio) * (np.pi * diameter / (seating * length)) ** 2
    return float(length * 0.5 / γ * (1 - np.sqrt(under_root))) if under_root >= 0 else np.inf
