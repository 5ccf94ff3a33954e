"""A creeping ring of round wire whose turns are held apart along its axis: a spring without pitch, as a solid.

With the displacements u_z = aθ and u_θ = r ψ(r, z, t), wire radius 1, the strains are γ_θz = r ∂ψ/∂z + a/r and γ_rθ = r
∂ψ/∂r; all other components vanish. With time hardening, x = τ/τR, the nominal stress τR = 2 F C/π at the start (C: coil
radius) and z = (N − 1) G A t^p τR^(N−1) in place of time, each point follows

    dx/dz = dγ/dz − |x|^(N−1) x/(N − 1),   γ in units of τR/G,

and ψ is such that ∫ τ : δγ r dr dz = 0 at all times. Of a straight wire, C → ∞, γ stays as it is.
"""

import numpy as np
from scipy.integrate import solve_ivp

DEGREE = 10  # of the polynomials ψ


def relaxation(index: float, exponent: float, z: np.ndarray, redistributed: bool = True) -> np.ndarray:
    """F/F₀ of the ring at constant distance between its turns.

    Args:
        index: spring index D/d.
        exponent: N.
        z: increasing, above 0, shape (times,); that of the nominal stress.
        redistributed: otherwise each point relaxes independently at its initial strain.

    Returns:
        Shape (times,).
    """
    r, area, slopes = _ring(index)
    weight = np.tile(area * r, 2)
    stiffness = (slopes * weight) @ slopes.T
    around = np.concatenate([np.zeros(len(r)), 1.0 / r])  # γ of a = 1: γ_rθ, γ_θz

    def force(x: np.ndarray) -> float:
        return float(area @ x[len(r) :])

    def compatible(strain: np.ndarray) -> np.ndarray:
        """The strains that displacements with a = 0 can produce."""
        return slopes.T @ np.linalg.solve(stiffness, slopes @ (weight * strain))

    def rate(_: float, x: np.ndarray) -> np.ndarray:
        size = np.tile(np.hypot(x[: len(r)], x[len(r) :]), 2)
        creep = size ** (exponent - 1.0) * x / (exponent - 1.0)
        return compatible(creep) - creep if redistributed else -creep

    start = around - compatible(around)
    start /= 2.0 * index / np.pi * force(start)
    path = solve_ivp(rate, (0.0, z[-1]), start, t_eval=z, method="DOP853", rtol=1e-8, atol=1e-10)
    if redistributed:
        return np.array([force(x) for x in path.y.T]) / force(start)
    return (path.y.T * start) @ weight / (start * start @ weight)  # F is what works on a, and γ has the shape of x


def _ring(index: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """r and area of points of the section; r ∂/∂r and r ∂/∂z of the ψ_k there, shape (k, 2 points)."""
    nodes, w = np.polynomial.legendre.leggauss(14)
    rho, w = 0.5 * (nodes + 1), 0.25 * w * (nodes + 1)
    angle = 2 * np.pi * (np.arange(32) + 0.5) / 32
    x, z = np.outer(rho, np.cos(angle)).ravel(), np.outer(rho, np.sin(angle)).ravel()
    r, area = index + x, np.repeat(w, 32) * 2 * np.pi / 32
    powers = [(i, j) for i in range(DEGREE + 1) for j in range(1, DEGREE + 1 - i, 2)]  # odd in z
    in_r = np.array([i * x ** max(i - 1, 0) * z**j for i, j in powers])
    in_z = np.array([j * x**i * z ** (j - 1) for i, j in powers])
    return r, area, np.hstack([r * in_r, r * in_z])
