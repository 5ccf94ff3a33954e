"""What the 3D solid of `coilset.verification.solid_study.pressing` found, recorded: its runs take minutes."""

from dataclasses import dataclass

import numpy as np

from coilset.verification.solid_study.pressing import PressedSection


@dataclass(frozen=True)
class Solid:
    """One turn between clamped heads, compressed in 12 steps to nine tenths of the way to block, and released.

    Attributes:
        material: of the library.
        index: D/d.
        unknowns: of the solid.
        force: at full travel, N.
        set: travel at which the force is zero again, mm.
        shear: τ at the inside of the coil after release, at 0.9 of the wire's radius, MPa.
        elastic: force after the first step, which is elastic, N; None where it is not, or was not kept.
        gap: of `PressedSection`.
        carried: factors of force, set and shear from the law's integration by backward Euler, with which these solids
            were computed, to the present one of second order: those by which force and set of a clamped turn of rods
            and the slice's shear have changed. A solid of 4,719 unknowns, D/d = 8, run both ways, has 1.001052 and
            0.99964; with 14,844 unknowns and the present law it has 185.8083 N, 4.474470 mm and −39.94 MPa. Ones:
            computed with the present law.
    """

    material: str
    index: float
    unknowns: int
    force: float
    set: float
    shear: float
    elastic: float | None = None
    gap: float = 1.0
    carried: tuple[float, float, float] = (1.0, 1.0, 1.0)

    @property
    def case(self) -> PressedSection:
        """The turn, and how it is pressed; the grid is that of 14,844 unknowns."""
        return PressedSection(self.index, 3, 24, 12, self.material, self.gap)

    @property
    def numbers(self) -> np.ndarray:
        """Force, set and residual shear, as of the present law."""
        return np.array([self.force, self.set, self.shear]) * self.carried


# Ck 15: docs/solid.md, "The rod against it". Linear hardening: `PressedSection(index, 3, 24, 12, "linear_isotropic")`.
# Meshes of these sizes agree with finer ones within 0.03 % in force (docs/solid.md).
RECORDED = (
    Solid("ck15", 4.0, 14844, 368.78, 1.1323, -61.9, carried=(1.001049, 0.999593, 0.997810)),
    Solid("ck15", 6.0, 14844, 247.20, 2.5263, -47.2, carried=(1.000995, 0.999626, 0.997935)),
    Solid("ck15", 8.0, 33987, 185.68, 4.4760, -40.2, carried=(1.001051, 0.999638, 0.997906)),
    Solid("ck15", 12.0, 14844, 123.63, 10.0377, -33.0, carried=(1.001298, 0.999641, 0.997670)),
    Solid("ck15", 8.0, 14844, 199.6724, 10.6019, -40.3294, gap=2.0, carried=(1.003744, 0.999403, 0.994814)),
    Solid("linear_isotropic", 4.0, 14844, 721.1852, 0.6760, -129.3991, 107.0794, carried=(1.0, 0.999998, 0.999981)),
    Solid("linear_isotropic", 6.0, 14844, 486.6464, 1.462635, -98.9564, 70.57158),
    Solid("linear_isotropic", 8.0, 14844, 366.1226, 2.558526, -84.0038, 52.79588),
    Solid("linear_isotropic", 12.0, 14844, 243.9230, 5.661565, -69.5428, 35.29365),
)
