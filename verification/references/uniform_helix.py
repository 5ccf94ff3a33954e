"""The elastic rod that is a uniform helix before and after: two nonlinear equations (Kirchhoff and Cosserat).

A helix of radius R and rise h per radian (j² = R² + h²) becomes one of radius R̄ and rise h̄, with λ radians for each
radian; its section has the inclination ϑ (A. E. H. Love, Mathematical theory of elasticity, § 271, with shear and
extension after S. S. Antman). In the section's triad d1 = cos ϑ eθ + sin ϑ ez, d3 = −sin ϑ eθ + cos ϑ ez,

    x′ = (λ R̄ eθ + h̄ ez)/j,   Γ1 = x′·d1 − 1,  Γ3 = x′·d3,   K1 = λ sin ϑ/j − h/j²,  K3 = λ cos ϑ/j − R/j²,

and the energy per length ½ (EA Γ1² + GA Γ3² + GJ K1² + EI K3²) is stationary in R̄ and ϑ. Its derivative by the rise
per length of wire is the axial force F, by λ the axial torque M.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import root

from coilset.verification.references.rod_shooting import Stiffness


@dataclass(frozen=True)
class Helix:
    """The deformed helix: radius and rise per radian in mm, inclination in rad, N and N mm, resultants of the section.

    `force` is negative under compression; `resultants` are N, Q2, Q3, Mt, M2, M3 with d2 towards the axis.
    """

    radius: float
    rise: float
    inclination: float
    force: float
    torque: float
    resultants: np.ndarray


def deformed(stiffness: Stiffness, radius: float, rise: float, new_rise: float, turn: float = 1.0) -> Helix:
    """The helix of a new rise per radian, mm, and λ = `turn`.

    Raises:
        RuntimeError: if the two equations have no root near the helix at rest.
    """
    j, begin = np.hypot(radius, rise), np.arctan2(rise, radius)

    def inner(unknown: np.ndarray) -> tuple[float, ...]:
        R, ϑ = unknown[0] * radius, unknown[1]
        s, c, x, z = np.sin(ϑ), np.cos(ϑ), turn * unknown[0] * radius / j, new_rise / j
        N, Q = stiffness.EA * (x * c + z * s - 1.0), stiffness.GA * (z * c - x * s)
        T, M = stiffness.GJ * (turn * s / j - rise / j**2), stiffness.EI * (turn * c / j - radius / j**2)
        return R, ϑ, s, c, x, z, N, Q, T, M

    def equations(unknown: np.ndarray) -> np.ndarray:
        _, _, s, c, x, z, N, Q, T, M = inner(unknown)
        radial = (N * c - Q * s) * radius  # by R̄
        tilt = N * (z * c - x * s) * j - Q * (z * s + x * c) * j + turn * (T * c - M * s)  # by ϑ
        return np.array([radial, tilt]) / (stiffness.EI / j)

    found = root(equations, [1.0, begin], tol=1e-13)
    if not np.abs(found.fun).max() < 1e-8:
        raise RuntimeError(f"no uniform helix: {found.message}")
    R, ϑ, s, c, _, _, N, Q, T, M = inner(found.x)
    torque = (N * c - Q * s) * R + T * s + M * c
    return Helix(R, new_rise, ϑ, N * s + Q * c, torque, np.array([N, 0.0, Q, T, 0.0, M]))
