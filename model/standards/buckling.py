"""Buckling of compression springs according to EN 13906-1, which is Haringx's solution."""

from math import inf, pi, sqrt

import numpy as np

from coilset.meshes.springs.geometry import Spring
from coilset.model.standards.wires.steel import STEEL

SEATING = 0.5  # EN 13906-1: seating coefficient ν of ends guided by parallel seats


def critical_travel(length: float, diameter: float, modulus_ratio: float, seating: float = SEATING) -> float:
    """Travel at which a cylindrical spring buckles, mm; infinite if it never does.

        s_K = L0 · 0.5/(1 − G/E) · [1 − √(1 − (1 − G/E)/(0.5 + G/E) · (π D/(ν L0))²)]

    Derivation: a rod of length L0 (1 − ξ), ξ = s/L0, whose bending and shear rigidities decrease with its length,

        B = (1 − ξ) L0 d⁴ E G/(16 D n (2G + E)),   S = (1 − ξ) L0 d⁴ E/(8 D³ n),   F = C ξ,   C = L0 d⁴ G/(8 D³ n),

    buckles, after Haringx, when F (1 + F/S) = π² B/(ν L)². With C/S = G/E and B/C = D²/(4 (½ + G/E)) of the free spring
    this is (1 − G/E) ξ² − ξ + (π D/(ν L0))²/(4 (½ + G/E)) = 0, whose smaller root is the standard's, with the square.

    Args:
        length: free length L0, mm.
        diameter: mean diameter D, mm.
        modulus_ratio: G/E.
        seating: ν of the standard, 0.5 for ends on parallel guided seats, 2 for one free end.
    """
    γ = 1 - modulus_ratio
    under_root = 1 - γ / (0.5 + modulus_ratio) * (pi * diameter / (seating * length)) ** 2
    return length * 0.5 / γ * (1 - sqrt(under_root)) if under_root >= 0 else inf


def buckling_travel(
    spring: Spring, modulus_ratio: float = STEEL.shear_modulus / STEEL.young_modulus, seating: float = SEATING
) -> float:
    """Travel at which a spring buckles by `critical_travel`, mm; infinite if it never does.

    Args:
        spring: `Spring`; its minimum mean diameter is used.
        modulus_ratio: G/E.
        seating: ν of the standard, 0.5 for ends on parallel guided seats, 2 for one free end.
    """
    diameter = 2 * float(np.min(spring.mean_radius(spring.breaks)))
    return critical_travel(spring.free_length, diameter, modulus_ratio, seating)
