"""Known solutions: the curved wire under an axial force, the straight wire in elastic-plastic torsion and bending."""

from collections.abc import Sequence
from typing import TypeVar

import numpy as np

Number = TypeVar("Number", float, np.ndarray)


def wahl_factor(index: Number) -> Number:
    """Wahl's factor of the shear stress at the inside of a coil over 8 F D / (π d³).

    A. M. Wahl, Mechanical Springs, 2nd ed., McGraw-Hill 1963: (4C − 1)/(4C − 4) + 0.615/C, with C = D/d.
    """
    return (4 * index - 1) / (4 * index - 4) + 0.615 / index


def goehner_series(index: Number) -> Number:
    """Göhner's factor as a series, 1 + 5/4 C⁻¹ + 7/8 C⁻² + C⁻³.

    O. Göhner, Ing.-Arch. 1 (1930) 619; in this form in DIN 2089, and to C⁻² in Timoshenko and Goodier, Theory of
    Elasticity, 3rd ed., art. 140.
    """
    return 1 + 1.25 / index + 0.875 / index**2 + 1 / index**3


def goehner_exact(index: float, degree: int = 14, places: Sequence[float] = (-1.0, 1.0)) -> tuple[float, ...]:
    """Shear stress on the diameter through the coil's axis, from Göhner's boundary value problem, solved to rounding.

    A sector of a ring of circular section with radius R under opposite forces along its axis (pitch → 0) has the
    stresses r² τ_θz = ∂φ/∂r, r² τ_rθ = −∂φ/∂z, and compatibility asks for

        ∂/∂r (r⁻³ ∂φ/∂r) + ∂/∂z (r⁻³ ∂φ/∂z) = −2c r⁻³,    φ = 0 on the circle

    (Timoshenko and Goodier, art. 140, multiplied by r⁻³). Here by Galerkin's method, (1 − x² − z²) times polynomials.

    Args:
        index: spring index D/d.
        degree: of the polynomials; 10 and 14 agree to 1e-11.
        places: on the diameter, outwards from the wire's centre, in wire radii; the surface's inside and outside.

    Returns:
        |τ| at the places over 8 F D / (π d³), a tuple.
    """
    t, w = np.polynomial.legendre.leggauss(40)
    ρ, w = 0.5 * (t + 1), 0.25 * w * (t + 1)
    φ = 2 * np.pi * np.arange(96) / 96
    x, z = np.outer(ρ, np.cos(φ)).ravel(), np.outer(ρ, np.sin(φ)).ravel()  # wire radius 1, coil radius C
    w = np.repeat(w, 96) * 2 * np.pi / 96
    powers = [(i, 2 * j) for i in range(degree + 1) for j in range(degree // 2 + 1) if i + 2 * j <= degree]

    def gradients(x: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        value, d_dx, d_dz = [], [], []
        for i, j in powers:
            bubble, m = 1 - x * x - z * z, x**i * z**j
            value.append(bubble * m)
            d_dx.append(bubble * i * x ** max(i - 1, 0) * z**j - 2 * x * m)
            d_dz.append(bubble * j * x**i * z ** max(j - 1, 0) - 2 * z * m)
        return np.array(value), np.array(d_dx), np.array(d_dz)

    value, d_dx, d_dz = gradients(x, z)
    weight = w / (index + x) ** 3
    a = np.linalg.lstsq((d_dx * weight) @ d_dx.T + (d_dz * weight) @ d_dz.T, value @ (2 * weight), rcond=1e-14)[0]
    force = np.sum(w * (a @ d_dx) / (index + x) ** 2)
    factors = []
    for place in places:
        slope = a @ gradients(np.array([place]), np.zeros(1))[1]
        factors.append(float(abs(slope[0] / (index + place) ** 2) * np.pi / (2 * index * abs(force))))
    return tuple(factors)


def nadai_torque(yield_shear: float, radius: float, ratio: Number) -> Number:
    """Torque of a straight round wire without hardening, N mm.

    A. Nadai, Plasticity, McGraw-Hill 1931: (2π/3) τ_y R³ (1 − ¼ (θ_y/θ)³) for a twist θ beyond θ_y = τ_y/(G R).

    Args:
        yield_shear: τ_y, MPa.
        radius: R, mm.
        ratio: θ/θ_y, from 1.
    """
    return 2 * np.pi / 3 * yield_shear * radius**3 * (1 - 0.25 / ratio**3)


def plastic_bending_moment(yield_stress: float, radius: float, ratio: float) -> float:
    """Bending moment of a straight round wire without hardening after beam theory, N mm.

    ∫ σ y dA with σ = σ_y y / h in the elastic core |y| < h = R / ratio, ± σ_y beyond; 4/3 σ_y R³ at the limit.

    Args:
        yield_stress: σ_y, MPa.
        radius: R, mm.
        ratio: curvature over that of first yield, from 1.
    """
    h, half = 1 / ratio, np.arcsin(1 / ratio)
    core = (half / 8 - np.sin(4 * half) / 32) * ratio  # ∫₀ʰ y² √(1 − y²) dy / h
    return 4 * yield_stress * radius**3 * (core + (1 - h * h) ** 1.5 / 3)
