"""Springs of round wire according to EN 13906: one function per formula, with its source or derivation.

Compression springs (part 1), extension springs (part 2), whose body is the same, and torsion springs (part 3).

Symbols of the standard: d wire diameter, D mean coil diameter, w = D/d, n active and n_t all turns, s travel, F force,
L0 free and Lc block length. N, mm, MPa, kg; frequency in Hz.
"""

from math import degrees, pi, sqrt

HOT_COILED = 20.0  # mm; wire above it is coiled hot: EN 15800 ends at 20 mm with its annex A
DYNAMIC_GAPS = 1.5  # EN 13906-1: Sa of cold coiled springs under alternating load over that under static load


def rate(shear_modulus: float, d: float, D: float, n: float) -> float:
    """Spring rate R = G d⁴/(8 D³ n), N/mm.

    Castigliano for the wire's torsion alone: the moment F D/2 over the length π D n with G π d⁴/32.
    """
    return shear_modulus * d**4 / (8 * D**3 * n)


def stress(force: float, d: float, D: float) -> float:
    """Uncorrected shear stress τ = 8 D F/(π d³), MPa: that of the moment F D/2 at the surface of a straight wire."""
    return 8 * D * force / (pi * d**3)


def stress_correction(w: float) -> float:
    """Stress correction k = (w + 0.5)/(w − 0.75) for the curvature of the wire and the direct shear (Bergsträsser).

    τk = k τ is the stress at the inside of the coil. The factors of Wahl and of Göhner agree to 2 % for w of 4 to 20.
    """
    return (w + 0.5) / (w - 0.75)


def is_hot_coiled(d: float) -> bool:
    """Whether wire of a diameter, mm, is coiled hot."""
    return d > HOT_COILED


def block_length(ends: str, turns: float, maximum_d: float, hot: bool = False) -> float | None:
    """Upper bound of the block length, mm; None where no formula was found.

    Cold coiled: Lc = n_t d_max for closed and ground ends, (n_t + 1.5) d_max for closed ends that are not ground; the
    standard has none for open ends. Hot coiled: (n_t − 0.3) d_max for closed and ground ends.

    Args:
        ends: form of the ends.
        turns: n_t, all turns.
        maximum_d: d_max, wire diameter with its tolerance, mm.
        hot: whether it is coiled hot.
    """
    beyond = {"closed and ground": -0.3} if hot else {"closed and ground": 0.0, "closed": 1.5}
    return (turns + beyond[ends]) * maximum_d if ends in beyond else None


def gap_sum(d: float, D: float, n: float, dynamic: bool = False) -> float:
    """Minimum sum of the gaps between the active coils, mm, which remains at the smallest length Ln = Lc + Sa.

    Cold coiled: Sa = n (0.0015 D²/d + 0.1 d), and 1.5 times as much under alternating load. Hot coiled: Sa = 0.02 n
    (D + d); what alternating load adds to it was not found.
    """
    if is_hot_coiled(d):
        return 0.02 * n * (D + d)
    return n * (0.0015 * D**2 / d + 0.1 * d) * (DYNAMIC_GAPS if dynamic else 1.0)


def energy(spring_rate: float, travel: float) -> float:
    """Work stored in a linear spring, W = R s²/2, N mm."""
    return 0.5 * spring_rate * travel**2


def wire_length(D: float, turns: float) -> float:
    """Length of the wire, neglecting the pitch, l = π D n_t, mm; a helix is longer by the factor 1/cos α."""
    return pi * D * turns


def mass(density: float, d: float, length: float) -> float:
    """Mass of the wire, m = ρ π d² l/4, kg, with ρ in kg/mm³."""
    return density * 0.25 * pi * d**2 * length


def natural_frequency(shear_modulus: float, density: float, d: float, D: float, n: float) -> float:
    """First natural frequency of a spring with both ends fixed, f = d/(2π n D²) √(G/(2ρ)), Hz.

    A standing half wave: f = ½ √(R/m) with the mass m of the active turns. With G in MPa, ρ in kg/dm³ and
    mm this is the standard's f = 3560 d/(n D²) √(G/ρ): 10⁶ √10⁻³ /(2√2 π) = 3559.

    Args:
        shear_modulus: G, MPa.
        density: ρ, kg/mm³.
        d: wire diameter, mm.
        D: mean diameter, mm.
        n: active turns.
    """
    return d / (2 * pi * n * D**2) * sqrt(1e3 * shear_modulus / (2 * density))  # MPa mm²/kg · mm = 10³ mm²/s²


def outer_diameter_growth(d: float, D: float, pitch: float, nu: float = 0.25) -> float:
    """Growth of the coil diameter from the free spring to block if the ends may turn, mm.

    Derivation: twisting changes the pitch angle from α0 = m/(π D) to α = d/(π D), with the force F r² = G Ip (α0 − α);
    its moment F r sin α bends the wire by F r α/(EI). From κ = cos²α/r it follows, to second order,

        ΔD = [m² − m d/(1 + ν) − d² ν/(1 + ν)]/(π² D).

    The standard's ΔDe = 0.1 (m² − 0.8 m d − 0.2 d²)/D is this with ν = ¼ and 1/π² ≈ 0.1.

    Args:
        d: wire diameter, mm.
        D: mean diameter, mm.
        pitch: m of the free spring, mm.
        nu: Poisson's ratio.
    """
    return (pitch**2 - pitch * d / (1 + nu) - d**2 * nu / (1 + nu)) / (pi**2 * D)


def turn_rate(young_modulus: float, d: float, D: float, n: float) -> float:
    """Rate of a torsion spring, R = E d⁴/(3667 D n), N mm/°.

    The bending moment M is the same along the wire: M π D n/(E I) is the rotation, I = π d⁴/64; 64 · 180/π = 3667.
    """
    return young_modulus * d**4 / (64.0 * degrees(1.0) * D * n)


def bending_stress(torque: float, d: float) -> float:
    """Uncorrected bending stress σ = 32 M/(π d³), MPa: that at the surface of a straight wire."""
    return 32.0 * torque / (pi * d**3)


def bending_correction(w: float) -> float:
    """Stress factor q at the inside of a curved wire in bending, (4 w² − w − 1)/(4 w (w − 1)) (Wahl).

    By Winkler's curved beam of circular section; the fit for q in part 3 of the standard was found in no open source.
    """
    return (4.0 * w**2 - w - 1.0) / (4.0 * w * (w - 1.0))


def turned_diameter(D: float, n: float, turn: float) -> float:
    """Mean diameter of a torsion spring after a rotation, degrees, positive in the winding direction, mm.

    The length of the wire stays: D n = D′ (n + α/360°).
    """
    return D * n / (n + turn / 360.0)
