"""Natural frequencies of a clamped helical rod from the twelve first-order equations of its wire.

In the frame (t, n, b) of the centre line, which turns by Ω = (τ, 0, κ) per length s, a vector v changes by v′ + Ω × v.
With the displacement u, the small rotation θ, the force F and the moment M on the section, and the frequency ω,

    u′ + Ω × u = F/(EA, kGA, kGA) + θ × t,      F′ + Ω × F = −ρ A ω² u,
    θ′ + Ω × θ = M/(GJ, EI, EI),                M′ + Ω × M = −t × F − ρ (J, I, I) ω² θ,

the balance of momentum and of angular momentum of a slice of the wire. Curvature κ and torsion τ of a helix are
constant, so y′ = A(ω) y has the solution exp(A s) y₀. Clamped ends, u = θ = 0, leave the six forces and moments at the
start; those that bring u and θ back to zero at the end exist where the block of exp(A L) from (F, M) to (u, θ) is
singular. Its least singular value touches zero there without a change of sign where two frequencies are close, hence
the zeros are sought as minima of that value.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm, svdvals
from scipy.optimize import minimize_scalar


@dataclass(frozen=True)
class HelicalRod:
    """A rod of round wire whose centre line is a helix, or straight.

    Attributes:
        wire_diameter: mm.
        length: of the wire, mm.
        curvature, torsion: κ and τ, 1/mm.
        young, shear: moduli, MPa.
        density: kg/mm³.
        shear_factor: k, part of the area that takes the transverse force.
    """

    wire_diameter: float
    length: float
    curvature: float
    torsion: float
    young: float
    shear: float
    density: float
    shear_factor: float = 1.0

    @classmethod
    def coil(cls, d: float, D: float, turns: float, pitch: float, **others: float) -> "HelicalRod":
        """A coil of mean diameter D and so many turns of a pitch, mm."""
        radius, slope = 0.5 * D, pitch / (2.0 * np.pi)
        per_angle = np.hypot(radius, slope)
        bend, twist = radius / per_angle**2, slope / per_angle**2
        return cls(d, 2.0 * np.pi * turns * per_angle, bend, twist, **others)

    def operator(self, ω: float) -> np.ndarray:
        """A(ω) for (u, θ, F, M), shape (12, 12)."""
        r = 0.5 * self.wire_diameter
        area, moment = np.pi * r**2, 0.25 * np.pi * r**4
        ρ = 1e-3 * self.density  # t/mm³
        turning = _cross([self.torsion, 0.0, self.curvature])
        along = _cross([1.0, 0.0, 0.0])
        shear = self.shear_factor * self.shear * area
        A = np.kron(np.eye(4), -turning)
        A[0:3, 6:9] += np.diag([1.0 / (self.young * area), 1.0 / shear, 1.0 / shear])
        A[0:3, 3:6] -= along  # θ × t
        A[3:6, 9:12] += np.diag([0.5 / (self.shear * moment), *[1.0 / (self.young * moment)] * 2])
        A[6:9, 0:3] -= ρ * area * ω**2 * np.eye(3)
        A[9:12, 6:9] -= along
        A[9:12, 3:6] -= ρ * moment * ω**2 * np.diag([2.0, 1.0, 1.0])
        return A

    def least_singular_value(self, frequency: float) -> float:
        """Of the block from forces at the start to displacements at the end, in units that balance them; Hz."""
        r = self.wire_diameter
        stiffness = self.young * 0.25 * np.pi * (0.5 * r) ** 4
        reach = self.length
        force, moment = stiffness / reach**2, stiffness / reach
        scale = np.array([reach] * 3 + [1.0] * 3 + [force] * 3 + [moment] * 3)
        A = self.operator(2.0 * np.pi * frequency) * scale / scale[:, None]
        parts = max(1, int(np.ceil(np.linalg.norm(A * self.length, 1) / 500.0)))
        transfer = np.linalg.matrix_power(expm(A * self.length / parts), parts)
        block = transfer[0:6, 6:12]
        return float(svdvals(block / np.linalg.norm(block, axis=0))[-1])

    def frequencies(self, count: int, resolution: float, start: float = 0.0) -> np.ndarray:
        """The lowest natural frequencies, Hz, shape (count,).

        Args:
            count: of frequencies.
            resolution: of the search, Hz; two frequencies that are closer than it may be taken for one.
            start: where the search begins, Hz.
        """
        found: list[float] = []
        at = start + resolution * np.arange(1.0, 4.0)
        value = [self.least_singular_value(float(f)) for f in at]
        while len(found) < count:
            if value[1] <= value[0] and value[1] < value[2]:
                least = minimize_scalar(
                    self.least_singular_value, bounds=(at[0], at[2]), method="bounded", options={"xatol": 1e-7 * at[1]}
                )
                if least.fun < 1e-3 * max(value):
                    found.append(float(least.x))
            at = np.append(at[1:], at[-1] + resolution)
            value = [*value[1:], self.least_singular_value(float(at[-1]))]
        return np.array(found)


def _cross(v: list[float]) -> np.ndarray:
    """The matrix of v ×."""
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
