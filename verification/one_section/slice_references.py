"""Known solutions for the slice: torsion of a ring's sector by displacements, and Saint-Venant's torsion constants."""

import numpy as np


def ring_sector(index: float, degree: int = 16) -> tuple[float, float, float]:
    """Round wire of a ring whose turns are pulled apart along its axis, without pitch, by displacements.

    With u_z = aθ and u_θ = r ψ(r, z) the strains are γ_θz = r ψ,z + a/r and γ_rθ = r ψ,r; all other components vanish.
    Equilibrium, ∂(r³ ψ,r)/∂r + ∂(r³ ψ,z + a r)/∂z = 0 with no traction on the surface, is the minimum of

        ∫ ½ G [ (r ψ,r)² + (r ψ,z + a/r)² ] r dr dz

    over ψ, here polynomials on the disk. It is the counterpart of Göhner's equation for the stress function, which has
    this as its condition of compatibility: this one approaches the rate from above, the other from below.

    Args:
        index: spring index D/d.
        degree: of the polynomials.

    Returns:
        Rate over G d⁴/(8 D³) per turn; shear stress at the inside and at the outside over 8 F D/(π d³).
    """
    nodes, w = np.polynomial.legendre.leggauss(40)
    ρ, w = 0.5 * (nodes + 1), 0.25 * w * (nodes + 1)
    φ = 2 * np.pi * np.arange(96) / 96
    x, z = np.outer(ρ, np.cos(φ)).ravel(), np.outer(ρ, np.sin(φ)).ravel()  # wire radius 1, coil radius C
    w = np.repeat(w, 96) * 2 * np.pi / 96
    powers = [(i, j) for i in range(degree + 1) for j in range(1, degree + 1 - i, 2)]  # odd in z

    def slopes(x: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        in_r = np.array([i * x ** max(i - 1, 0) * z**j for i, j in powers])
        return in_r, np.array([j * x**i * z ** (j - 1) for i, j in powers])

    r, a, G = index + x, 1.0, 1.0
    in_r, in_z = slopes(x, z)
    A = (in_r * w * r**3) @ in_r.T + (in_z * w * r**3) @ in_z.T
    ψ = np.linalg.lstsq(A, -(in_z * w * r) @ np.full(len(r), a), rcond=1e-15)[0]
    shear = G * (r * (ψ @ in_z) + a / r)
    force = np.sum(w * shear)  # of ∫ τ_θz over the section: what moves along the axis, and not about it
    D, d = 2 * index, 2.0
    rate = force / (2 * np.pi * a) / (G * d**4 / (8 * D**3))
    factors = []
    for side in (-1.0, 1.0):
        at = slopes(np.array([side]), np.zeros(1))[1][:, 0]
        factors.append(float(((index + side) * (ψ @ at) + a / (index + side)) * np.pi * d**3 / (8 * force * D)))
    return float(rate), factors[0], factors[1]


def torsion_constant_ellipse(width: float, height: float) -> float:
    """π a³ b³/(a² + b²), mm⁴ (Timoshenko and Goodier, Theory of Elasticity, 3rd ed., art. 106)."""
    a, b = 0.5 * width, 0.5 * height
    return np.pi * a**3 * b**3 / (a * a + b * b)


def torsion_constant_rectangle(width: float, height: float) -> float:
    """⅓ l t³ [1 − 192/π⁵ t/l Σ tanh(n π l/2t)/n⁵], n = 1, 3, …, mm⁴ (Timoshenko and Goodier, art. 109)."""
    length, thick = max(width, height), min(width, height)
    n = np.arange(1, 400, 2)
    series = np.sum(np.tanh(0.5 * np.pi * n * length / thick) / n**5)
    return length * thick**3 / 3 * (1 - 192 / np.pi**5 * thick / length * series)
