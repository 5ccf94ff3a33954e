"""Springs by other ways than formulas of the standard: roots, vectors and eigenvalues instead of closed solutions."""

import numpy as np
from catalogue import G
from scipy.optimize import brentq

from coilset.model.tools.standards import en13906

E, ν = 206000.0, 206000.0 / 163000.0 - 1


def haringx(length, D, seating, d=1.0, n=10.0):
    """Travel at which F (1 + F/S) = π² B/(ν L)², by its rigidities and a root of this equation alone."""
    C = en13906.rate(G, d, D, n) * length
    inertia, polar = np.pi * d**4 / 64, np.pi * d**4 / 32
    per_length = length / (np.pi * D * n)  # height for a length of wire
    B = per_length * 2 / (1 / (E * inertia) + 1 / (G * polar))  # half of the turns is bent, half is twisted
    # a coil that is pushed sideways bends in its own plane: ∫ (r cos φ)² r dφ/(EI) = π r³/(EI) a turn
    S = length / n / (np.pi * (D / 2) ** 3 / (E * inertia))

    def excess(ξ):
        F, b, s = C * ξ, B * (1 - ξ), S * (1 - ξ)
        return F * (1 + F / s) - np.pi**2 * b / (seating * length * (1 - ξ)) ** 2

    return length * brentq(excess, 1e-9, 0.5 / (1 - G / E))


def helix_compliance(angle, held):
    """Travel for a force of 1 of a helix of radius 1, by the moments of force and couple along the wire, as vectors."""
    φ = np.linspace(0, 2 * np.pi, 2001)
    zero = np.zeros_like(φ)
    tangent = np.stack([-np.cos(angle) * np.sin(φ), np.cos(angle) * np.cos(φ), np.sin(angle) + zero], axis=1)
    arm = np.stack([np.cos(φ), np.sin(φ), zero], axis=1)
    axis = np.array([0.0, 0.0, 1.0])
    ds = (φ[1] - φ[0]) / np.cos(angle)

    def work(first, second):
        """∫ (Mt Mt′/G Ip + Mb Mb′/EI) ds with G Ip = 1, EI = 1 + ν."""
        t1, t2 = (first * tangent).sum(1), (second * tangent).sum(1)
        integrand = t1 * t2 + ((first * second).sum(1) - t1 * t2) / (1 + ν)
        return 0.5 * (integrand[1:] + integrand[:-1]).sum() * ds

    by_force, by_couple = np.cross(arm, axis), np.broadcast_to(axis, arm.shape)
    travel = work(by_force, by_force)
    if held:
        travel -= work(by_force, by_couple) ** 2 / work(by_couple, by_couple)
    return travel


def closed_helix(d, D, m, nu):
    """Mean diameter of a helix of pitch m when a turn rises by d, its ends free to turn, by the rod's exact equations.

    Love: a helix of radius r and angle α has the curvature cos²α/r and the torsion sin α cos α/r; an axial force F
    without couple twists it by F r cos α and bends it by F r sin α. The wire keeps its length.
    """
    start = np.arctan(m / (np.pi * D))
    κ, τ = 2 * np.cos(start) ** 2 / D, 2 * np.sin(start) * np.cos(start) / D

    def out_of_balance(radius):
        α = np.arctan(d / (2 * np.pi * radius))
        untwist, bend = τ - np.sin(α) * np.cos(α) / radius, np.cos(α) ** 2 / radius - κ
        return untwist * np.tan(α) - (1 + nu) * bend  # EI = (1 + ν) G Ip

    return 2 * brentq(out_of_balance, 0.4 * D, 0.7 * D)


def half_wave(stiffness, mass, masses=400):
    """Lowest frequency of a chain of equal masses and springs between fixed ends, Hz; N/mm and kg."""
    links = np.diag(np.full(masses, 2.0)) - np.eye(masses, k=1) - np.eye(masses, k=-1)
    lowest = np.linalg.eigvalsh(links)[0] * (1e3 * stiffness * (masses + 1)) / (mass / (masses + 1))
    return np.sqrt(lowest) / (2 * np.pi)


def torus_volume(d, D, turns):
    """Of wire without pitch, mm³: ∫ 2π r h(r) dr over its height h at the distance r from the axis, Gauss-Legendre."""
    x, w = np.polynomial.legendre.leggauss(200)
    φ = 0.5 * np.pi * x  # r = D/2 + d/2 sin φ
    return turns * np.sum(0.5 * np.pi * w * 2 * np.pi * (D / 2 + d / 2 * np.sin(φ)) * d * np.cos(φ) * d / 2 * np.cos(φ))


def polygon_length(D, turns, sides=100000):
    """Length of a polygon inscribed in circles, mm."""
    angle = np.linspace(0.0, 2 * np.pi * turns, sides + 1)
    return np.hypot(*np.diff(0.5 * D * np.array([np.cos(angle), np.sin(angle)]))).sum()
