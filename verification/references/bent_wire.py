"""A torsion spring by hand: a straight wire of its length that one moment bends beyond yield and releases.

It knows nothing of elements, frames or iteration; the wire's curvature, its pitch and what the heads do are left out. A
fibre follows the tensile curve of the law, alike in compression, and the springback is elastic.
"""

import numpy as np

from coilset.model.core.material.law.law import Law
from coilset.model.tools.identification import programs

REACH, INCREMENTS = 0.05, 500  # strain of the tensile curve
SLICES = 2000  # of the section's half height


def tensile_curve(law: Law) -> tuple[np.ndarray, np.ndarray]:
    """Strain and stress, MPa, of a point in tension up to REACH."""
    step = {"to": {"eps11": REACH}, "increments": INCREMENTS}
    history = programs.run(law, programs.Program.model_validate({"name": "tension", "steps": [step]}))
    return history.strain[:, 0], history.stress[:, 0]


class BentWire:
    """A wire of a law, its diameter and its length, mm."""

    def __init__(self, law: Law, diameter: float, length: float) -> None:
        self.length, self.radius = length, 0.5 * diameter
        self.stiffness = law.E * np.pi * self.radius**4 / 4.0
        self._strain, self._stress = tensile_curve(law)

    def torque(self, turn: float) -> float:
        """M = ∫ σ(κ y) y dA at a rotation, rad, with κ = turn over length, N mm."""
        y = self.radius * (np.arange(SLICES) + 0.5) / SLICES
        width = 2.0 * np.sqrt(self.radius**2 - y**2)
        stress = np.interp(abs(turn) / self.length * y, self._strain, self._stress)
        return float(np.copysign(2.0 * np.sum(stress * y * width) * self.radius / SLICES, turn))

    def set(self, turn: float) -> float:
        """Rotation that remains after the release, rad."""
        return turn - self.torque(turn) * self.length / self.stiffness
