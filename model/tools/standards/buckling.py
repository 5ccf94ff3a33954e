"""Buckling of compression springs according to EN 13906-1, which is Haringx's solution."""

from math import inf, pi, sqrt

import numpy as np

from coilset.meshes.springs.geometry import Spring
from coilset.model.core.case import Case
from coilset.model.core.material.law.steel import STEEL
from coilset.model.tools.standards.rate import WireNumbers

SEATING = 0.5  # EN 13906-1: seating coefficient ν of ends guided by parallel seats
TILTING = {0: SEATING, 1: 0.7, 2: 1.0}  # ν by the number of ends that tilt freely; Euler's columns
SWAYING = {0: 1.0, 1: 2.0, 2: inf}  # the same if an end moves sideways, too; with two it gives way at once


def critical_travel(
    length: float, diameter: float, bending: float, seating: float = SEATING, shear: float | None = None
) -> float:
    """Travel at which a cylindrical spring buckles, mm; infinite if it never does.

        s_K = L0 · 0.5/(1 − G/E) · [1 − √(1 − (1 − G/E)/(0.5 + G/E) · (π D/(ν L0))²)]

    Derivation: a rod of length L0 (1 − ξ), ξ = s/L0, whose bending and shear rigidities decrease with its length,

        B = (1 − ξ) L0 d⁴ E G/(16 D n (2G + E)),   S = (1 − ξ) L0 d⁴ E/(8 D³ n),   F = C ξ,   C = L0 d⁴ G/(8 D³ n),

    buckles, after Haringx, when F (1 + F/S) = π² B/(ν L)². With C/S = G/E and B/C = D²/(4 (½ + G/E)) of the free spring
    this is (1 − G/E) ξ² − ξ + (π D/(ν L0))²/(4 (½ + G/E)) = 0, whose smaller root is the standard's, with the square.
    G/E stands twice for G J/(2 E I): with C/B = 4 (½ + G J/(2 E I₂))/D², where wire is bent across the plane of the
    coil, and with C/S = G J/(2 E I₃), where it is bent in that plane; of round wire J = 2 I.

    Args:
        length: free length L0, mm.
        diameter: mean diameter D, mm.
        bending: G/E, or G J/(2 E I₂) of wire that is not round.
        seating: ν of the standard, 0.5 for ends on parallel guided seats, 2 for one free end; see `seating_of`.
        shear: G J/(2 E I₃); None: as bending.
    """
    γ = 1 - (bending if shear is None else shear)
    under_root = 1 - γ / (0.5 + bending) * (pi * diameter / (seating * length)) ** 2
    return length * 0.5 / γ * (1 - sqrt(under_root)) if under_root >= 0 else inf


def seating_of(case: Case) -> float:
    """ν of a case's ends; an end that is held by a spring counts as free, which is on the safe side."""
    ends = case.clamps if case.ends == "clamped" else case.seats
    heads = (ends.bottom, ends.top)
    tilting = sum(head.tilt != "held" for head in heads)
    sways = any(head.sideways != "held" for head in heads)
    return (SWAYING if sways else TILTING)[tilting]


def buckling_travel(
    spring: Spring, modulus_ratio: float = STEEL.shear_modulus / STEEL.young_modulus, seating: float = SEATING
) -> float:
    """Travel at which a spring buckles by `critical_travel`, mm; infinite if it never does.

    Seats do not press a spring with hooks or arms: it is infinite.

    Args:
        spring: `Spring`; its minimum mean diameter is used.
        modulus_ratio: G/E.
        seating: ν of its ends.
    """
    if spring.has_tails:
        return inf
    diameter = 2 * float(np.min(spring.mean_radius(spring.breaks)))
    if spring.section is not None:
        wire = WireNumbers.of(spring.section, float(spring.wire_diameter(0.5 * spring.turns)), diameter)
        bending, shear = wire.buckling_ratios(modulus_ratio)
        return critical_travel(spring.free_length, diameter, bending, seating, shear)
    return critical_travel(spring.free_length, diameter, modulus_ratio, seating)
