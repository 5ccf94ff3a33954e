"""Sections of a curved wire with three stresses: its fibres' lengths, and the shear that its transverse force leaves.

In a wire of curvature κ a fibre at the distance y from the axis, towards the centre of curvature, is shorter than the
axis by g = 1 − κ y. The section moves as a rigid disk with the strains Γ = (ε, γ2, γ3) and K = (φ′, κ2, κ3), and warps
along the wire as an elastic disk of radius r does under a transverse force that is constant along it,

    w = −3/7 (γ2 y + γ3 z) (ρ² − 2/3),   ρ² = (y² + z²)/r²,

which makes ∫ ½ |γ + ∇w|² dA least among all w that turn nothing, ∫ w y dA = ∫ w z dA = 0. The shear of the force then
ends at the rim as it must (a parabola over the height, 3/2 of the mean in the middle), and the wire gives way to it
with 6/7 G A. A curved wire's torsion comes with such a force: without w it is too stiff. With w constant along the wire
in its turning frame, and without its torsion τ,

    ε11 = (ε + κ2 z − κ3 y)/g,   γ12 = (γ2 − φ′ z + κ w)/g + ∂w/∂y,   γ13 = (γ3 + φ′ y)/g + ∂w/∂z,

and the virtual work is ∫ σ : δε g dA. Of a straight wire, κ = 0, this is Timoshenko's rod with its shear factor.
"""

import math
from collections.abc import Mapping

import numpy as np
from numba import njit

from coilset.model.material.kernel import INLINE, KERNEL
from coilset.model.section.chord import to_chord, to_section
from coilset.model.section.integration import SHAPE, section, update_points
from coilset.model.section.plane import PlaneSections, spoil_failed

WARPING = 3.0 / 7.0  # of the transverse shear strain
LEVEL = 2.0 / 3.0  # ρ² where the warping vanishes


class CurvedSections(PlaneSections):
    """All sections of a rod on this rank; arguments and state as in `PlaneSections`."""

    def update(
        self,
        strain: np.ndarray,
        start: Mapping[str, np.ndarray],
        trial: dict[str, np.ndarray],
        s: np.ndarray,
        D: np.ndarray,
        with_tangent: bool = True,
    ) -> bool:
        """Bring all sections to the end of the increment; as `PlaneSections.update`."""
        place, law = self.placement, self.law_over_time.over(start, trial)
        return bool(update_sections(
            law, self.y, self.z, self.weights, self.radius, place.curvature, strain - start["strain"],
            place.matrices, place.stretch, start["point_state"], trial["point_state"], s, D, with_tangent,
        ))  # fmt: skip

    def update_surface(self, strain: np.ndarray, start: Mapping[str, np.ndarray], trial: dict[str, np.ndarray]) -> None:
        """Bring the points on the wire's surface to the end of the increment; as `PlaneSections.update_surface`."""
        place, law = self.placement, self.law_over_time.over(start, trial)
        update_surface(
            law, self.rim_y, self.rim_z, self.radius, place.curvature, strain - start["strain"],
            place.matrices, start["surface_state"], trial["surface_state"],
        )  # fmt: skip


@njit(**INLINE)
def shear_by_force(y: float, z: float, bend: float, g: float) -> tuple[float, float, float, float]:
    """g ∂(γ12, γ13)/∂(γ2, γ3) at a point of the unit disk, by rows; `bend` is κ r."""
    across = WARPING * (y * y + z * z - LEVEL)
    mixed = 2.0 * WARPING * y * z
    return (
        1.0 - bend * y * across - g * (across + 2.0 * WARPING * y * y),
        -bend * z * across - g * mixed,
        -g * mixed,
        1.0 - g * (across + 2.0 * WARPING * z * z),
    )


@njit(**KERNEL)
def curved_shape(y: np.ndarray, z: np.ndarray, bend: float, shape: np.ndarray) -> None:
    """Write g, a22, a23, a32, a33 at the points of the unit disk, shape (5, points); see `integration`."""
    for k in range(len(y)):
        g = 1.0 - bend * y[k]
        a22, a23, a32, a33 = shear_by_force(y[k], z[k], bend, g)
        shape[0, k], shape[1, k], shape[2, k], shape[3, k], shape[4, k] = g, a22, a23, a32, a33


@njit(**KERNEL)
def update_sections(
    p: np.ndarray,
    y: np.ndarray,
    z: np.ndarray,
    w: np.ndarray,
    radius: np.ndarray,
    curvature: np.ndarray,
    de: np.ndarray,
    placement: np.ndarray,
    stretch: np.ndarray,
    old: np.ndarray,
    new: np.ndarray,
    s: np.ndarray,
    D: np.ndarray,
    with_tangent: bool,
) -> bool:
    """Bring all sections to the end of the increment; as `plane.update_sections`, and

    Args:
        curvature: κ of the wire, towards y, shape (cells, 2), 1/mm.
    """
    points = len(w)
    d, resultant, tangent, work = np.empty(6), np.empty(6), np.empty((6, 6)), np.empty((6, 6))
    strain, C, count = np.empty((3, points)), np.empty((9, points)), np.empty(points, np.int64)
    shape = np.empty((SHAPE, points))
    for c in range(len(radius)):
        R = radius[c]
        for g in range(2):
            to_section(placement[c, g], de[c, g], d)
            curved_shape(y, z, curvature[c, g] * R, shape)
            if not section(p, R * y, R * z, math.pi * R * R * w, shape, d, old[c, g], new[c, g], strain, C,
                           with_tangent, count, resultant, tangent):  # fmt: skip
                return False
            to_chord(placement[c, g], stretch[c, g], resultant, tangent, work, s[c, g], D[c, g], with_tangent)
    return True


@njit(**KERNEL)
def update_surface(
    p: np.ndarray,
    y: np.ndarray,
    z: np.ndarray,
    radius: np.ndarray,
    curvature: np.ndarray,
    de: np.ndarray,
    placement: np.ndarray,
    old: np.ndarray,
    new: np.ndarray,
) -> None:
    """Bring the points y, z of the unit circle to the end of the increment; arguments as in `update_sections`."""
    points, d, shape = len(y), np.empty(6), np.empty((SHAPE, len(y)))
    strain, C, count = np.empty((3, points)), np.empty((9, points)), np.empty(points, np.int64)
    for c in range(len(radius)):
        R = radius[c]
        for g in range(2):
            to_section(placement[c, g], de[c, g], d)
            curved_shape(y, z, curvature[c, g] * R, shape)
            update_points(p, R * y, R * z, shape, d, old[c, g], new[c, g], strain, C, False, count)
            spoil_failed(count, new[c, g])
