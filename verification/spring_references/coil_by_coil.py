"""Presetting by hand: each coil a straight wire in torsion that flows, and stops to give way once it lies on the next.

It knows nothing of elements, frames, contact or iteration; bending, direct shear, the wire's curvature, and what heads
and seats do to the end coils are left out. Only the law's curve in simple shear is taken from the code.
"""

import numpy as np

from coilset.meshes.springs.ends import touching_pitch
from coilset.meshes.springs.spring import Spring
from coilset.model.core.material.law.law import Law
from coilset.model.tools.identification import programs
from coilset.verification.spring_references.curved_rod import _points

REACH, INCREMENTS = 0.05, 500  # shear strain of the flow curve


def shear_curve(law: Law) -> tuple[np.ndarray, np.ndarray]:
    """Shear strain and stress, MPa, of a point in simple shear up to REACH."""
    step = {"to": {"gamma12": REACH}, "increments": INCREMENTS}
    history = programs.run(law, programs.Program.model_validate({"name": "simple shear", "steps": [step]}))
    return history.strain[:, 1], history.stress[:, 1]


class CoilByCoil:
    """A spring whose turns twist one by one.

    A rise that is lower by δ mm per turn twists the wire by κ = δ/(2π r²) per length, so that its surface is sheared by
    γ = κ d/2; it bears the torque T = (d/2)³ m(γ), m(γ) = 2π ∫₀¹ τ(γ x) x² dx, of the axial force F = T/r.

    Args:
        spring: Spring.
        law: Law of its material.
    """

    def __init__(self, spring: Spring, law: Law) -> None:
        turns, self.weight = _points(spring)
        self.r, self.a, self.G = spring.mean_radius(turns), 0.5 * spring.wire_diameter(turns), law.G
        self.way = np.maximum(spring.pitch(turns) - touching_pitch(2 * self.a, spring.slope(turns)), 0.0)
        self.shear, stress = shear_curve(law)
        x, w = np.polynomial.legendre.leggauss(40)
        x, w = 0.5 * (x + 1), 0.5 * w
        self.moment = 2 * np.pi * np.interp(np.outer(self.shear, x), self.shear, stress) @ (w * x**2)
        if (self.way * self.a / (2 * np.pi * self.r**2)).max() > REACH:
            raise ValueError(f"the wire is sheared by more than {REACH} at block, where the flow curve ends")

    def travel(self, forces: np.ndarray) -> np.ndarray:
        """Travel under rising axial forces, shape (n,): s(F) = ∫ min(2π r² κ, p − p_block) dt, mm."""
        shear = np.interp(np.asarray(forces)[:, None] * self.r / self.a**3, self.moment, self.shear)
        return np.minimum(2 * np.pi * self.r**2 / self.a * shear, self.way) @ self.weight

    def force(self, travels: np.ndarray) -> np.ndarray:
        """The reverse of `travel`, by interpolation between 2000 forces, N; the maximum from block on."""
        at_block = self.a**3 * self._moment_at_block() / self.r
        forces = np.linspace(0.0, at_block.max(), 2000)
        return np.interp(travels, self.travel(forces), forces)

    def block_travel(self) -> float:
        """Travel at which every coil lies on the next, mm."""
        return float(self.way @ self.weight)

    def spring_back(self) -> float:
        """What comes back from block, elastically: ∫ 2π r² T/(G I_p) dt with the torque of each coil at block, mm."""
        torque = self.a**3 * self._moment_at_block()
        return float((2 * np.pi * self.r**2 * torque / (self.G * 0.5 * np.pi * self.a**4)) @ self.weight)

    def _moment_at_block(self) -> np.ndarray:
        """m at the places along the wire when all coils lie on each other, MPa."""
        return np.interp(self.way * self.a / (2 * np.pi * self.r**2), self.shear, self.moment)
