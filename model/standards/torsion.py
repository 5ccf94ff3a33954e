"""Round wires that stand for one that is not round: of the same rate, stress or mass.

EN 13906-1 reads the factors of rectangular wire off diagrams. Here they are computed for any section: its torsion
constant J and section modulus W of a straight wire (Saint-Venant), and the greatest shear on the surface of a coil,
without pitch, over F D/(2 W). With d⁴ = 32 J/π, d³ = 16 W/π and d² = 4 A/π the formulas of round wire hold.
"""

from dataclasses import dataclass
from math import pi

import numpy as np

from coilset.meshes.boundary import Boundary
from coilset.model.section.outline import Outlined, Section

AROUND = 720  # points on the surface at which the greatest shear is sought


@dataclass(frozen=True)
class WireNumbers:
    """Of a wire that is not round; lengths in mm.

    Attributes:
        width: across the coil's axis.
        torsion: J, mm⁴.
        modulus: W, torque over the greatest shear stress of a straight wire, mm³.
        area: A, mm².
        correction: greatest shear stress in the coil over F D/(2 W).
        out_of_plane, in_plane: second moments of area ∫ z² dA and ∫ y² dA about the middle, mm⁴.
    """

    width: float
    torsion: float
    modulus: float
    area: float
    correction: float
    out_of_plane: float
    in_plane: float

    @classmethod
    def of(cls, boundary: Boundary, height: float, mean_diameter: float) -> "WireNumbers":
        """Of a section in half its height, a height and a mean diameter of the coil, mm."""
        section, r = Outlined(boundary), 0.5 * height
        places, weights = section.fine
        second = pi * r**4 * weights @ (places - weights @ places / weights.sum()) ** 2
        straight = _greatest(section, boundary, 0.0, np.array([0.0, 0.0, 1.0]))
        bend = height / mean_diameter
        coiled = _greatest(section, boundary, bend, np.array([0.0, bend, 1.0]))
        return cls(
            width=r * float(np.ptp(boundary.polygon[:, 0])),
            torsion=section.warping().torsion * r**4,
            modulus=r**3 / straight,
            area=r**2 * boundary.area,
            correction=coiled / straight,
            out_of_plane=float(second[1]),
            in_plane=float(second[0]),
        )

    @property
    def of_rate(self) -> float:
        """Diameter of the round wire of the same torsional stiffness, mm."""
        return float((32.0 * self.torsion / pi) ** 0.25)

    @property
    def of_stress(self) -> float:
        """That of the same stress by a torque, mm."""
        return float((16.0 * self.modulus / pi) ** (1.0 / 3.0))

    @property
    def of_mass(self) -> float:
        """That of the same area, mm."""
        return float((4.0 * self.area / pi) ** 0.5)

    def buckling_ratios(self, modulus_ratio: float) -> tuple[float, float]:
        """G J/(2 E I) of bending across and in the plane of the coil, each G/E of round wire; see `critical_travel`."""
        half = 0.5 * modulus_ratio * self.torsion
        return half / self.out_of_plane, half / self.in_plane


def _greatest(section: Section, boundary: Boundary, bend: float, load: np.ndarray) -> float:
    """Greatest shear on the surface for Q2, Q3 and Mt/r, with r = 1."""
    warping, places = section.warping(bend), boundary.points(AROUND)
    strain = np.linalg.solve(pi * warping.stiffness, load)
    shear = np.einsum("ijp,j->ip", warping.shear(places), strain) / (1.0 - bend * places[:, 0])
    return float(np.hypot(*shear).max())
