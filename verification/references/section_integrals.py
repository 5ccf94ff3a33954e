"""Sections of plastic wire by integrals over the radius or the height, and points by a high-order integration in time.

Nothing here knows of section rules, return maps or rods. Of the program only the material's functions k²(b*), ζ(b*),
κ(b*) are used (`Law.functions`, tested separately).
"""

import numpy as np
from scipy.integrate import quad, solve_ivp

from coilset.model.core.material.law.law import Law

ACCURACY = {"method": "DOP853", "rtol": 1e-8, "atol": 1e-8}


def plastic_path(law: Law, start: np.ndarray, strains: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Stress of a point in plastic loading under a constant rate of strain, without spin.

    The rates (3.1.6) to (3.1.8) of a round bar in tension and torsion, in σ = σ11, τ = τ12 with the active deviator
    n = (⅔σ − B11, τ − B12), n:Ť = n1 σ̇ + 2 n2 τ̇ and m = (2 − κ k²′)/((2ζ + k²′) k²):

        ε̇p = (κ ⅔σ̇ + m (n:Ť) n1)/(1 + κζ),   γ̇p = 2 (κ τ̇ + m (n:Ť) n2)/(1 + κζ),
        σ̇ = E (ε̇ − ε̇p),  τ̇ = G (γ̇ − γ̇p),  Ḃ11 = ζ ε̇p,  Ḃ12 = ½ ζ γ̇p,  ḃ* = 3/2 n1 ε̇p + n2 γ̇p.

    Args:
        law: material law.
        start: σ, τ, B11, B12, b* on the yield surface, shape (5,), MPa.
        strains: ε̇, γ̇.
        times: at which the state is wanted, increasing from 0.

    Returns:
        The states, shape (times, 5), MPa.

    Raises:
        ValueError: for a material that does not harden, whose rates are 0/0 here.
    """
    if law.functions(0.0)[1] == 0.0 and law.functions(0.0)[2] == 0.0:
        raise ValueError(f"{law.name} does not harden; its sections have closed forms")

    def rates(t: float, y: np.ndarray) -> list[float]:
        σ, τ, B1, B2, work = y
        k2, dk2, ζ, _, κ, _ = law.functions(work)
        n1, n2 = 2.0 / 3.0 * σ - B1, τ - B2
        m, c = (2.0 - κ * dk2) / ((2.0 * ζ + dk2) * k2), 1.0 + κ * ζ
        flow = np.array(
            [
                [(2.0 / 3.0 * κ + m * n1 * n1) / c, 2.0 * m * n2 * n1 / c],
                [2.0 * m * n1 * n2 / c, 2.0 * (κ + 2.0 * m * n2 * n2) / c],
            ]
        )
        stress = np.linalg.solve(np.diag([1.0 / law.E, 1.0 / law.G]) + flow, strains)
        ep, gp = flow @ stress
        return [*stress, ζ * ep, 0.5 * ζ * gp, 1.5 * n1 * ep + n2 * gp]

    return solve_ivp(rates, (0.0, times[-1]), start, t_eval=times, **ACCURACY).y.T


def shear_curve(law: Law, shears: np.ndarray) -> np.ndarray:
    """τ at increasing shear angles γ from rest, in pure shear; yield at 2τ² = k0², shape as given, MPa."""
    shears = np.asarray(shears, float)
    limit = np.sqrt(0.5 * law.functions(0.0)[0]) / law.G
    stress = law.G * shears
    beyond = shears > limit
    if beyond.any():
        start = np.array([0.0, law.G * limit, 0.0, 0.0, 0.0])
        times = np.append(0.0, shears[beyond] - limit)
        stress[beyond] = plastic_path(law, start, np.array([0.0, 1.0]), times)[1:, 1]
    return stress


def torque(law: Law, radius: float, twist: float) -> float:
    """Torque 2π ∫ τ(ϑ r) r² dr of a round bar at the twist ϑ per length (A. Nadai, Theory of flow and fracture), N mm.

    By Gauss's rule with 40 points over the plastic ring, where τ is smooth; the elastic core has a closed form.
    """
    limit = min(radius, float(np.sqrt(0.5 * law.functions(0.0)[0])) / law.G / twist)
    elastic = 0.5 * np.pi * law.G * twist * limit**4
    ξ, w = np.polynomial.legendre.leggauss(40)
    r = limit + 0.5 * (radius - limit) * (1.0 + ξ)
    return elastic + 0.5 * (radius - limit) * float(w @ (2.0 * np.pi * shear_curve(law, twist * r) * r**2))


def nadai_torque(yield_shear: float, G: float, radius: float, twist: float) -> float:
    """Torque of an ideally plastic round bar, 2π/3 τy (R³ − c³/4) with the core's radius c = τy/(G ϑ), N mm."""
    core = min(radius, yield_shear / (G * twist))
    if core == radius:
        return 0.5 * np.pi * G * twist * radius**4
    return 2.0 * np.pi / 3.0 * yield_shear * (radius**3 - core**3 / 4.0)


def bending_moment(yield_stress: float, E: float, radius: float, curvature: float) -> float:
    """Moment of an ideally plastic round bar: ∫ σ z dA with σ = min(E κ z, σy), N mm; the same about any axis."""

    def height(z: float) -> float:
        return min(E * curvature * z, yield_stress) * z * 4.0 * np.sqrt(radius**2 - z**2)

    core = min(radius, yield_stress / (E * curvature))
    return sum(quad(height, a, b, epsabs=0.0, epsrel=1e-12)[0] for a, b in ((0.0, core), (core, radius)) if b > a)


def tube_shear(yield_stress: float, E: float, G: float, angle: float) -> float:
    """Shear angle γ of an ideally plastic thin tube, stretched beyond yield and then twisted at constant length.

    On the yield surface σ = σ0 cos θ, τ = σ0/√3 sin θ, and the rates above integrate to (R. Hill, The mathematical
    theory of plasticity, IV.2, there for an incompressible tube)

        γ = σ0/(√3 G) [sin θ + 3G/E (ln(sec θ + tan θ) − sin θ)].
    """
    sine = min(np.sin(angle), 1.0 - np.finfo(float).epsneg)  # finite at the end of the path, too
    return yield_stress / (np.sqrt(3.0) * G) * (sine + 3.0 * G / E * (np.arctanh(sine) - sine))
