"""One section of an endless helix under an axial force, without a mesh."""

import numpy as np

from coilset.meshes.springs.placement import straight
from coilset.model.core.material.law.law import Law
from coilset.model.core.results.surface import component, nominal_shear
from coilset.model.core.section.kinds import make_sections
from coilset.model.core.section.rules import DiskRule, polar

WIRE = 5.0  # mm


class HelixSection:
    """A section of a helix, from the unstressed state on.

    Args:
        law: material.
        kind: of the section.
        index: D/d.
        pitch_angle: degrees.
        rule: quadrature of the disk.
        degree: of the polynomials of a section that warps.
    """

    def __init__(
        self, law: Law, kind: str, index: float, pitch_angle: float, rule: DiskRule | None = None, degree: int = 3
    ) -> None:
        angle, R = np.radians(pitch_angle), 0.5 * index * WIRE
        self.law, self.coil_radius, self.speed = law, R, R / np.cos(angle)
        curved = np.full((1, 2), np.cos(angle) ** 2 / R)
        self.placement = straight(1)._replace(curvature=curved, torsion=curved * np.tan(angle))
        self.rule = rule or polar()
        self.sections = make_sections(
            kind, law, law.parameters(), self.rule, np.array([0.5 * WIRE]), self.placement, None, degree
        )
        self.start = self.sections.initial_state() | {"strain": np.zeros((1, 2, 6))}
        self.trial = self.sections.initial_state()
        # N, Q2, Q3, Mt, M2, M3 under the unit force e_z = sin α t + cos α b on the axis, R n away
        sin, cos = np.sin(angle), np.cos(angle)
        self.load = np.array([sin, 0.0, cos, R * cos, 0.0, -R * sin])

    def update(self, e: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Resultants and section tangent at the section strains `e`."""
        s, D = np.empty((1, 2, 6)), np.empty((1, 2, 6, 6))
        strain = np.tile(e, (1, 2, 1))
        if not self.sections.update(strain, self.start, self.trial, s, D):
            raise ValueError(f"no stress at {e}")
        self.sections.update_surface(strain, self.start, self.trial)
        return s[0, 0], D[0, 0]

    def inside_shear(self) -> float:
        """τ13 on the surface at the inside of the coil at the last update, MPa."""
        return float(component(self.trial["surface_state"][0, 0, 0], self.sections.components, "t13"))

    def factors(self) -> tuple[float, float]:
        """Elastic shear stress at the inside and at the outside over 8 F D/(π d³), at the force 1 N."""
        self.update(np.linalg.solve(self.update(np.zeros(6))[1], self.load))
        around = component(self.trial["surface_state"][0, 0], self.sections.components, "t13")
        nominal = nominal_shear(1.0, 2.0 * self.coil_radius, WIRE)
        return float(around[0] / nominal), float(-around[len(around) // 2] / nominal)

    def rate(self) -> float:
        """Axial stiffness of a turn over G d⁴/(8 D³), elastic, at its start."""
        D = self.update(np.zeros(6))[1]
        travel = 2.0 * np.pi * self.speed * self.load @ np.linalg.solve(D, self.load)
        return 8.0 * (2.0 * self.coil_radius) ** 3 / (self.law.G * WIRE**4 * travel)
