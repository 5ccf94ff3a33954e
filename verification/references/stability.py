"""Critical loads by closed or transcendental equations: the twisted rod, the compressed helical spring."""

import numpy as np
from scipy.optimize import brentq


def twisted_rod(tension: float) -> float:
    """Critical torque T L/EI of a rod whose ends are clamped, one of them free to move and turn along the axis.

    For the deflection w = y + i z of the straight rod under torque T and tension P, A. G. Greenhill's equation
    (Proc. Inst. Mech. Eng. 1883; A. E. H. Love, chapter 19) is

        EI w⁗ − i T w‴ − P w″ = 0,    w = a + b s + c exp(i β1 s) + d exp(i β2 s),   EI β² − T β + P = 0.

    With w = w′ = 0 at both ends, x = β1 L/2, y = β2 L/2, the determinant vanishes for

        sin(x − y)/(x − y) = (sin x/x) (sin y/y),    x + y = T L/2EI,   x y = P L²/4EI.

    Without tension y = 0, and the limit is tan x = x, x = T L/2EI = 4.4934.

    Args:
        tension: P over the clamped rod's Euler load 4π² EI/L².

    Raises:
        ValueError: for a compression.
    """
    if tension < 0.0:
        raise ValueError("a rod under compression has other roots; give a tension")
    if tension == 0.0:
        return 2.0 * brentq(lambda x: np.sin(x) - x * np.cos(x), np.pi, 1.5 * np.pi, xtol=1e-14)

    def determinant(d: float) -> float:  # in d = (x − y)/2, the mean m of x and y follows from m² − d² = x y
        m = np.sqrt(np.pi**2 * tension + d**2)
        x, y = m + d, m - d
        return np.sin(2.0 * d) * x * y - 2.0 * d * np.sin(x) * np.sin(y)

    # d = 0 is a spurious root; the next one is sought from there
    grid = np.linspace(1e-2, 4.0, 4000)
    values = np.array([determinant(d) for d in grid])
    k = int(np.flatnonzero(values[:-1] * values[1:] < 0.0)[0])
    d = brentq(determinant, grid[k], grid[k + 1], xtol=1e-14)
    return 4.0 * np.sqrt(np.pi**2 * tension + d**2)


def clamped_spring(
    wire: float, diameter: float, turns: float, free_length: float, E: float, G: float
) -> tuple[float, float]:
    """Travel and force at which a spring between clamped heads buckles, mm and N.

    J. A. Haringx, On highly compressible helical springs and rubber rods, Philips Research Reports 3 (1948) 401 and 4
    (1949) 49, 206; the formula of EN 13906-1. The spring is a straight rod whose stiffnesses fall with its length L,

        bending B = 2 L/(π D n (1/EI + 1/GJ)),   shear S = 8 EI L/(π n D³),   F = c s,  c = 4 GJ/(π n D³),

    and buckles at F (1 + F/S) = 4π² B/L². With F/S = (G/E) s/L and L = L0 − s this is quadratic in s:

        s = L0/(2 (1 − G/E)) [1 − √(1 − (1 − G/E)/(½ + G/E) (2π D/L0)²)].

    It neglects the pitch angle. All lengths in mm, moduli in MPa.

    Raises:
        ValueError: for a spring that does not buckle.
    """
    ratio = G / E
    inside = 1.0 - (1.0 - ratio) / (0.5 + ratio) * (2.0 * np.pi * diameter / free_length) ** 2
    if inside < 0.0:
        raise ValueError("this spring is too stout to buckle")
    travel = free_length / (2.0 * (1.0 - ratio)) * (1.0 - np.sqrt(inside))
    return travel, travel * G * wire**4 / (8.0 * diameter**3 * turns)
