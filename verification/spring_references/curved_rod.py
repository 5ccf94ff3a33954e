"""Elastic springs as curved rods, solved independently: the yardstick for the elements."""

import numpy as np

from coilset.meshes.springs.ends import touching_pitch
from coilset.meshes.springs.spring import Spring


def clamped_rate(spring: Spring, E: float, G: float, curved: bool = False) -> float:
    """Initial rate between heads that move along the axis only, by Castigliano, N/mm.

    The complementary energy ∫ ½ s·D⁻¹ s ds of the true centre line, with the resultants s = (N, Q2, Q3, Mt, M2, M3)
    along the tangent, the normal and the binormal, gives the displacement of the top head by its six reactions; it is
    (0, 0, −1), and its rotations are 0.

    Args:
        spring: `Spring`.
        E: Young's modulus, MPa.
        G: shear modulus, MPa.
        curved: with sections of a curved wire, as `section_stiffness` has them; otherwise with those of a straight one
            that stay plane, EA, GA, GIp, EI.
    """
    t, weight = _points(spring)
    r, tangent, ds = spring.centre_line(t), spring.tangent(t), spring.speed(t) * weight
    bend = spring.curvature_vector(t)
    curvature = np.linalg.norm(bend, axis=1)
    # of a straight wire any normal is right
    normal = np.where(curvature[:, None] > 0, bend, np.cross(tangent, np.roll(tangent, 1, axis=1)))
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    axes = np.stack([tangent, normal, np.cross(tangent, normal)], axis=1)
    top = spring.centre_line(np.array([spring.turns]))[0]
    force = np.vstack([np.eye(3), np.zeros((3, 3))])
    moment = np.vstack([np.zeros((3, 3)), np.eye(3)])
    inner = moment[:, None] + np.cross(top - r, force[:, None])
    s = np.concatenate([np.einsum("nij,aj->nai", axes, force), np.einsum("nij,anj->nai", axes, inner)], axis=2)
    radius = 0.5 * spring.wire_diameter(t)
    D = section_stiffness(radius, curvature, E, G) if curved else plane_stiffness(radius, E, G)
    compliance = np.einsum("nai,nib,n->ab", s, np.linalg.solve(D, np.swapaxes(s, 1, 2)), ds)
    return np.linalg.solve(compliance, [0, 0, 1, 0, 0, 0])[2]


def plane_stiffness(radius: np.ndarray, E: float, G: float) -> np.ndarray:
    """EA, GA, GA, GIp, EI, EI on the diagonal, shape (n, 6, 6); arguments as of `section_stiffness`."""
    A, I = np.pi * radius**2, np.pi * radius**4 / 4
    return np.stack([E * A, G * A, G * A, 2 * G * I, E * I, E * I], axis=-1)[:, None] * np.eye(6)


def section_stiffness(radius: np.ndarray, curvature: np.ndarray, E: float, G: float) -> np.ndarray:
    """D = ∫ Bᵀ C B g dA of sections with three stresses that know of the wire's curvature, g = 1 − κ y.

    From ε, γ2, γ3, φ′, κ2, κ3 to N, Q2, Q3, Mt, M2, M3. Tension and bending have closed integrals over the disk of
    radius r, ∫ dA/g = 2 A/(1 + √(1 − (κ r)²)) and those with y and y² by y/g = (1/g − 1)/κ (Winkler's bar). Shear
    and torsion are integrated with the strains of the warping w that `shear_warping` finds,
    γ12 = (γ2 − φ′ z + κ w)/g + ∂w/∂y and γ13 = (γ3 + φ′ y)/g + ∂w/∂z.

    Args:
        radius: of the wire, mm, shape (n,).
        curvature: 1/mm, shape (n,).
        E, G: moduli, MPa.

    Returns:
        Shape (n, 6, 6), N, N mm and N mm².
    """
    A, k = np.pi * radius**2, curvature * radius
    root = np.sqrt(1.0 - k**2)
    D = np.zeros((len(A), 6, 6))
    D[:, 0, 0] = E * 2.0 * A / (1.0 + root)  # ∫ dA/g
    D[:, 0, 5] = D[:, 5, 0] = -E * A * radius * k / (1.0 + root) ** 2  # ∫ y dA/g
    D[:, 5, 5] = E * A * radius**2 / (1.0 + root) ** 2  # ∫ y² dA/g
    D[:, 4, 4] = E * A * radius**2 * (1.0 + 2.0 * root) / (3.0 * (1.0 + root) ** 2)  # ∫ z² dA/g
    y, z, weight = _disk()
    w, w_y, w_z = shear_warping()
    k, r = k[:, None], radius[:, None]
    g = 1.0 - k * y
    B = np.zeros((2, 3, *g.shape))  # of γ12, γ13 for γ2, γ3, φ′
    for i in range(2):
        B[0, i], B[1, i] = k * w[i] / g + w_y[i], w_z[i]
    B[0, 0] += 1.0 / g
    B[1, 1] += 1.0 / g
    B[0, 2], B[1, 2] = -r * z / g, r * y / g
    D[:, 1:4, 1:4] = G * np.einsum("ianp,ibnp,np,n->nab", B, B, weight * g, A)
    return D


def shear_warping() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Warping of the unit disk at unit shear strains γ2, γ3, with its slopes: each of shape (2, points of `_disk`).

    It minimises ∫ |γ + ∇w|² dA among all polynomials of degree 3 (the exact answer is one) that turn nothing,
    ∫ w y dA = ∫ w z dA = 0.
    """
    y, z, weight = _disk()
    powers = [(i, n - i) for n in (2, 3) for i in range(n + 1)]
    f = np.array([y**i * z**j for i, j in powers])
    f_y = np.array([i * y ** max(i - 1, 0) * z**j for i, j in powers])
    f_z = np.array([j * y**i * z ** max(j - 1, 0) for i, j in powers])
    turned = 4.0 * (f * weight) @ np.stack([y, z], axis=1)  # the parts along y and z, whose squares have the mean 1/4
    f, f_y, f_z = f - turned @ np.array([y, z]), f_y - turned[:, :1], f_z - turned[:, 1:]
    K = (f_y * weight) @ f_y.T + (f_z * weight) @ f_z.T
    a = np.linalg.solve(K, -np.stack([f_y @ weight, f_z @ weight], axis=1))
    return a.T @ f, a.T @ f_y, a.T @ f_z


def _disk() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """y, z on the unit disk and weights whose sum is 1: 12 rings of 48 points."""
    square, weight = np.polynomial.legendre.leggauss(12)
    radius, angle = np.sqrt(0.5 * (1.0 + square)), 2.0 * np.pi * np.arange(48) / 48
    y, z = np.outer(radius, np.cos(angle)).ravel(), np.outer(radius, np.sin(angle)).ravel()
    return y, z, np.repeat(0.5 * weight / 48, 48)


def torsion_characteristic(spring: Spring, G: float, forces: np.ndarray) -> np.ndarray:
    """Travel under axial forces if only torsion counts and a coil stops to give way once it lies on the next, mm.

    s(F) = ∫ min(64 F r³/(G d⁴), p − p_block) dt: each turn gives way as in the formula for cylinders, until its pitch
    is that of the block (E. Rodriguez, M. Paredes, M. Sartor, Journal of Mechanical Design 128, 2006, for cones of
    constant pitch).

    Args:
        spring: `Spring`.
        G: shear modulus, MPa.
        forces: N, shape (n,).

    Returns:
        Travels, shape (n,).
    """
    t, weight = _points(spring)
    d = spring.wire_diameter(t)
    way = 64 * np.asarray(forces)[:, None] * spring.mean_radius(t) ** 3 / (G * d**4)
    return np.minimum(way, spring.pitch(t) - touching_pitch(d, spring.slope(t))) @ weight


def _points(spring: Spring) -> tuple[np.ndarray, np.ndarray]:
    """Points and weights along the turns, Gauss's rule between the breaks of the spring's functions."""
    ξ, w = np.polynomial.legendre.leggauss(4)
    half = 0.5 * np.diff(spring.breaks)[:, None]
    return (spring.breaks[:-1, None] + half * (1 + ξ)).ravel(), (half * w).ravel()
