"""The geometrically exact elastic rod as a boundary value problem, solved by shooting.

A clamped rod under a dead force F and a moment at its free end (J. C. Simo, A finite strain beam formulation, CMAME 49
(1985) 55; S. S. Antman, Nonlinear problems of elasticity, chapter 8). With the triad R of the section, force n and
moment m in the fixed frame,

    r′ = R (e1 + Γ),   R′ = R [K0 + K]×,   n′ = 0,   m′ = −r′ × n,
    Γ = (n·d1/EA, n·d2/GA, n·d3/GA),   K = (m·d1/GJ, m·d2/EI, m·d3/EI).

The moment at the clamp is varied until the moment at the free end is the given one. Integrated with DOP853.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import solve_ivp
from scipy.optimize import root

ACCURACY = {"method": "DOP853", "rtol": 1e-9, "atol": 1e-11}


@dataclass(frozen=True)
class Stiffness:
    """Of a section: EA and GA in N, torsion GJ and bending EI in N mm²."""

    EA: float
    GA: float
    GJ: float
    EI: float

    @classmethod
    def of_round_wire(cls, radius: float, E: float, G: float) -> "Stiffness":
        """A round wire without shear factor; radius in mm, moduli in MPa."""
        area = np.pi * radius**2
        return cls(E * area, G * area, G * area * radius**2 / 2.0, E * area * radius**2 / 4.0)


def clamped_rod(
    stiffness: Stiffness,
    length: float,
    force: ArrayLike,
    moment: ArrayLike = (0.0, 0.0, 0.0),
    curvature: ArrayLike = (0.0, 0.0, 0.0),
    loads: int = 3,
) -> np.ndarray:
    """Position of the free end, the clamp at the origin with its triad along x, y, z, shape (3,), mm.

    Args:
        stiffness: of the section.
        length: mm.
        force: dead force at the free end, N.
        moment: at the free end, in the fixed frame, N mm.
        curvature: K0 of the stress-free rod in its triad (torsion, curvatures about d2 and d3), 1/mm.
        loads: number of equal parts in which the loads are raised, so that the root is the one that develops from rest.

    Raises:
        RuntimeError: if shooting finds no root.
    """
    force, moment, K0 = (np.asarray(vector, float) for vector in (force, moment, curvature))
    EI, scale = stiffness.EI, stiffness.EI / length

    def end(start: np.ndarray, part: float) -> np.ndarray:
        n = part * force

        def rates(s: float, y: np.ndarray) -> np.ndarray:
            R = y[3:12].reshape(3, 3)
            local, bent = R.T @ n, R.T @ y[12:] * scale
            slope = R @ (np.array([1.0, 0.0, 0.0]) + local / (stiffness.EA, stiffness.GA, stiffness.GA))
            k = K0 + bent / (stiffness.GJ, EI, EI)
            spin = np.array([[0.0, -k[2], k[1]], [k[2], 0.0, -k[0]], [-k[1], k[0], 0.0]])
            return np.concatenate([slope, (R @ spin).ravel(), -np.cross(slope, n) / scale])

        y0 = np.concatenate([np.zeros(3), np.eye(3).ravel(), start])
        return solve_ivp(rates, (0.0, length), y0, **ACCURACY).y[:, -1]

    start = np.zeros(3)
    for part in np.arange(1, loads + 1) / loads:
        found = root(lambda x, part=part: end(x, part)[12:] - part * moment / scale, start, tol=1e-10)
        if not np.abs(found.fun).max() < 1e-7:
            raise RuntimeError(f"shooting found no moment at the clamp: {found.message}")
        start = found.x
    return end(start, 1.0)[:3]
