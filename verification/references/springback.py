"""Round wire bent beyond yield and released: moments and residual stress, closed forms and integrals over the height.

A fibre follows the curve of the tensile test, E up to σy and E_t beyond; no fibre is first stretched and then
compressed, and the springback is elastic.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq, fsolve

from coilset.verification.references.section_integrals import bending_moment


@dataclass(frozen=True)
class Bar:
    """Yield stress, moduli E and E_t (N/mm²) and the wire's radius (mm)."""

    yield_stress: float
    E: float
    hardening: float
    radius: float

    def stress(self, strain: np.ndarray) -> np.ndarray:
        """σ = E_t ε + (1 − E_t/E) σ_ideal(ε), and alike in compression; shape as `strain`."""
        ideal = np.clip(self.E * strain, -self.yield_stress, self.yield_stress)
        return self.hardening * strain + (1.0 - self.hardening / self.E) * ideal

    def moment(self, curvature: float) -> float:
        """M = E_t I κ + (1 − E_t/E) M_ideal(κ), with ε = κ y, N mm."""
        ideal = bending_moment(self.yield_stress, self.E, self.radius, curvature)
        return self.hardening * self._inertia * curvature + (1.0 - self.hardening / self.E) * ideal

    @property
    def _inertia(self) -> float:
        return np.pi * self.radius**4 / 4.0

    def straight(self, curvature: float) -> tuple[float, float, float]:
        """For a given residual curvature, with ε = κ y and the springback M/(E I).

        Returns:
            Curvature (1/mm) and moment before it springs back, and the residual stress at the inside, N/mm².
        """
        EI = self.E * self._inertia
        tight = brentq(lambda k: k - self.moment(k) / EI - curvature, curvature, 3.0 * curvature, xtol=1e-15)
        stays = self.moment(tight) / EI * self.E * self.radius - self.stress(tight * self.radius)
        return tight, self.moment(tight), float(stays)

    def curved(self, curvature: float) -> tuple[float, float, float]:
        """The same with logarithmic strains of fibres as long as λ − θ y, y towards the inside, and no axial force."""
        nodes, w = np.polynomial.legendre.leggauss(400)
        y = self.radius * np.sin(0.5 * np.pi * nodes)
        area = np.pi * w * (self.radius**2 - y * y)

        def bent(turned: float) -> tuple[float, np.ndarray]:
            """λ and the stress at θ."""
            stretch = brentq(lambda s: area @ self.stress(np.log(s - turned * y)), 0.9, 1.1, xtol=1e-15)
            return stretch, self.stress(np.log(stretch - turned * y))

        def released(turned: float) -> tuple[float, np.ndarray]:
            """Curvature and stress without moment."""
            stretch, start = bent(turned)

            def stress(end: np.ndarray) -> np.ndarray:
                return start + self.E * np.log((end[0] - end[1] * y) / (stretch - turned * y))

            def forces(end: np.ndarray) -> np.ndarray:
                return np.array([area @ stress(end), area @ (stress(end) * y) / self.radius])

            end = fsolve(forces, [stretch, turned], xtol=1e-13)
            return end[1] / end[0], stress(end)

        turned = brentq(lambda t: released(t)[0] - curvature, curvature, 2.0 * curvature, xtol=1e-13)
        stretch, stress = bent(turned)
        return turned / stretch, float(-area @ (stress * y)), float(released(turned)[1][-1])
