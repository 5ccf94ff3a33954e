"""Torque that is left of a round bar whose twist is held while it creeps, virgin and preset.

In pure shear with time hardening, γ = A τ^N t^p, each radius relaxes by itself. With x = τ/τR, where τR = 2 M₀/(π R³)
is the nominal stress of the torque M₀ at the start, ρ = r/R and z = (N − 1) G A t^p τR^(N−1),

    x = x₀ (1 + z |x₀|^(N−1))^(−1/(N−1)),     M/M₀ = 4 ∫ x ρ² dρ.

A virgin bar starts from x₀ = ρ. A preset bar without hardening was twisted until it would have had the stress beyond
yield b ρ, and bears min(b ρ, y); released and twisted to M₀ it is elastic, so that x₀ = min(b ρ, y) − (m − 1) ρ with m
= 4 ∫ min(b ρ, y) ρ² dρ. The same holds for a slender spring, with F in the place of M.
"""

import numpy as np
from scipy.integrate import quad
from scipy.special import hyp2f1


def virgin(exponent: float, z: np.ndarray) -> np.ndarray:
    """M/M₀ of a virgin bar, ₂F₁(1/(N−1), 4/(N−1); 1 + 4/(N−1); −z); shape as z."""
    n = exponent - 1.0
    return hyp2f1(1.0 / n, 4.0 / n, 1.0 + 4.0 / n, -np.asarray(z))


def preset(exponent: float, z: np.ndarray, limit: float, beyond: float) -> np.ndarray:
    """M/M₀ of a preset bar.

    Args:
        exponent: N.
        z: shape (times,), with the nominal stress of M₀.
        limit: y, the yield stress over that nominal stress.
        beyond: b, the stress at the surface if the greatest twist had been elastic, over that nominal stress.

    Raises:
        ValueError: if the bar does not yield when it is preset, or yields again when it is released or loaded.
    """
    core = limit / beyond
    torque = limit * (4.0 - core**3) / 3.0  # m
    if not 0.0 < core < 1.0 or not 1.0 <= torque <= 2.0 * limit:
        raise ValueError("the bar must yield when it is preset, and only then")

    def start(rho: float) -> float:
        return min(beyond * rho, limit) - (torque - 1.0) * rho

    def left(at: float) -> float:
        def share(rho: float) -> float:
            x = start(rho)
            return 4.0 * rho**2 * x * (1.0 + at * abs(x) ** (exponent - 1.0)) ** (-1.0 / (exponent - 1.0))

        return sum(quad(share, *part, epsabs=0, epsrel=1e-10)[0] for part in ((0.0, core), (core, 1.0)))

    return np.array([left(at) for at in z])
