"""Elastic springs as curved rods, solved by hand: what the elements are measured by."""

import numpy as np

from coilset.meshes.ends import touching_pitch
from coilset.meshes.spring import Spring


def clamped_rate(spring: Spring, E: float, G: float) -> float:
    """Initial rate between heads that move along the axis only, by Castigliano, N/mm.

    The complementary energy ∫ N²/EA + Q²/GA + T²/GIp + M²/EI ds of the true centre line gives the displacement of the
    top head by its six reactions; it is (0, 0, −1), and its turns are 0.

    Args:
        spring: `Spring`.
        E: Young's modulus, MPa.
        G: shear modulus, MPa.
    """
    t, weight = _points(spring)
    r, tangent, ds = spring.centre_line(t), spring.tangent(t), spring.speed(t) * weight
    d = spring.wire_diameter(t)
    A, I = np.pi * d**2 / 4, np.pi * d**4 / 64
    top = spring.centre_line(np.array([spring.turns]))[0]
    force = np.vstack([np.eye(3), np.zeros((3, 3))])
    moment = np.vstack([np.zeros((3, 3)), np.eye(3)])
    inner = moment[:, None] + np.cross(top - r, force[:, None])
    N, T = force @ tangent.T, np.einsum("ank,nk->an", inner, tangent)
    compliance = (N * ds / (E * A)) @ N.T - (N * ds / (G * A)) @ N.T + force @ force.T * np.sum(ds / (G * A))
    compliance += np.einsum("ank,bnk,n->ab", inner, inner, ds / (E * I))
    compliance += (T * ds / (2 * G * I)) @ T.T - (T * ds / (E * I)) @ T.T
    return np.linalg.solve(compliance, [0, 0, 1, 0, 0, 0])[2]


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
