"""The inextensible cantilever without shear under a transverse dead force, by elliptic integrals.

EI φ″ = −P cos φ with φ(0) = 0, φ′(L) = 0 and the tip's slope φ1 (A. E. H. Love, Mathematical theory of elasticity,
chapter 19; K. Mattiasson, Int. J. Num. Meth. Eng. 17 (1981) 145). With k² = (1 + sin φ1)/2, sin θ0 = 1/(k √2):

    √(PL²/EI) = K(k) − F(θ0, k),   v/L = 1 − 2 (E(k) − E(θ0, k))/√(PL²/EI),   1 − u/L = √(2 sin φ1/(PL²/EI)).
"""

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipe, ellipeinc, ellipk, ellipkinc


def cantilever(load: float) -> tuple[float, float]:
    """Shortening u/L and deflection v/L of the tip at the load PL²/EI."""

    def parts(slope: float) -> tuple[float, float]:
        m = 0.5 * (1.0 + np.sin(slope))
        return m, np.arcsin(1.0 / np.sqrt(2.0 * m))

    def reached(slope: float) -> float:
        m, start = parts(slope)
        return ellipk(m) - ellipkinc(start, m) - np.sqrt(load)

    slope = brentq(reached, 1e-9, 0.5 * np.pi - 1e-9, xtol=1e-15)
    m, start = parts(slope)
    deflection = 1.0 - 2.0 * (ellipe(m) - ellipeinc(start, m)) / np.sqrt(load)
    return 1.0 - np.sqrt(2.0 * np.sin(slope) / load), deflection
