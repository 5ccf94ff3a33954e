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

from coilset.model.material.functions import INLINE
from coilset.model.material.point_law import rod_point
from coilset.model.section.chord import to_chord, to_section
from coilset.model.section.plane import PlaneSections

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
    ) -> bool:
        """Bring all sections to the end of the increment; as `PlaneSections.update`."""
        place, law = self.placement, self.law_over_time.over(start, trial)
        status = update_sections(
            law, self.y, self.z, self.weights, self.radius, place.curvature, strain - start["strain"],
            place.matrices, place.stretch, start["point_state"], trial["point_state"], s, D,
        )  # fmt: skip
        return status == 0

    def update_surface(self, strain: np.ndarray, start: Mapping[str, np.ndarray], trial: dict[str, np.ndarray]) -> None:
        """Bring the points on the wire's surface to the end of the increment; as `PlaneSections.update_surface`."""
        place, law = self.placement, self.law_over_time.over(start, trial)
        update_surface(
            law, self.rim_y, self.rim_z, self.radius, place.curvature, strain - start["strain"],
            place.matrices, start["surface_state"], trial["surface_state"],
        )  # fmt: skip


@njit(cache=True)
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
) -> int:
    """Bring all sections to the end of the increment; as `plane.update_sections`, and

    Args:
        curvature: κ of the wire, towards y, shape (cells, 2), 1/mm.
    """
    d, C = np.empty(6), np.empty((3, 3))
    resultant, tangent, work = np.empty(6), np.empty((6, 6)), np.empty((6, 6))
    for c in range(len(radius)):
        R = radius[c]
        area = math.pi * R * R
        for g in range(2):
            P = placement[c, g]
            to_section(P, de[c, g], d)
            resultant[:] = 0.0
            tangent[:] = 0.0
            for k in range(len(w)):
                if not integrate_point(p, R, y[k], z[k], area * w[k], curvature[c, g] * R, d, old[c, g, k],
                                       new[c, g, k], C, resultant, tangent):  # fmt: skip
                    return -1
            if not math.isfinite(resultant.sum()):
                return -1
            to_chord(P, stretch[c, g], resultant, tangent, work, s[c, g], D[c, g])
    return 0


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


@njit(**INLINE)
def strains(
    y: float, z: float, g: float, shear: tuple[float, float, float, float], d: np.ndarray
) -> tuple[float, float, float]:
    """ε11, γ12, γ13 at y, z, mm, of the section strains `d`; `shear` as `shear_by_force` gives it."""
    a22, a23, a32, a33 = shear
    return (
        (d[0] + d[4] * z - d[5] * y) / g,
        (a22 * d[1] + a23 * d[2] - d[3] * z) / g,
        (a32 * d[1] + a33 * d[2] + d[3] * y) / g,
    )


@njit(**INLINE)
def integrate_point(
    p: np.ndarray,
    radius: float,
    y: float,
    z: float,
    dA: float,
    bend: float,
    d: np.ndarray,
    old: np.ndarray,
    new: np.ndarray,
    C: np.ndarray,
    resultant: np.ndarray,
    tangent: np.ndarray,
) -> bool:
    """Add one point's share to the section; y, z on the unit disk, `bend` is κ r."""
    g = 1.0 - bend * y
    shear = shear_by_force(y, z, bend, g)
    a22, a23, a32, a33 = shear
    y, z = radius * y, radius * z
    e11, g12, g13 = strains(y, z, g, shear, d)
    if rod_point(p, old, e11, g12, g13, new, C) < 0:
        return False
    sigma, t2, t3 = new[0] * dA, new[1] * dA, new[2] * dA
    resultant[0] += sigma
    resultant[1] += t2 * a22 + t3 * a32
    resultant[2] += t2 * a23 + t3 * a33
    resultant[3] += t3 * y - t2 * z
    resultant[4] += sigma * z
    resultant[5] -= sigma * y
    # tangent = Zᵀ C Z dA/g with Z = g ∂(ε11, γ12, γ13)/∂e; only the entries of Z that are not zero
    dA /= g
    for i in range(3):
        c0, c1, c2 = C[i, 0] * dA, C[i, 1] * dA, C[i, 2] * dA
        row1, row2, row3 = c1 * a22 + c2 * a32, c1 * a23 + c2 * a33, c2 * y - c1 * z
        row4, row5 = c0 * z, -c0 * y
        if i == 0:
            rows = ((0, 1.0), (4, z), (5, -y))
        elif i == 1:
            rows = ((1, a22), (2, a23), (3, -z))
        else:
            rows = ((1, a32), (2, a33), (3, y))
        for row, f in rows:
            tangent[row, 0] += f * c0
            tangent[row, 1] += f * row1
            tangent[row, 2] += f * row2
            tangent[row, 3] += f * row3
            tangent[row, 4] += f * row4
            tangent[row, 5] += f * row5
    return True


@njit(cache=True)
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
    d, C = np.empty(6), np.empty((3, 3))
    for c in range(len(radius)):
        R = radius[c]
        for g in range(2):
            to_section(placement[c, g], de[c, g], d)
            for k in range(len(y)):
                length = 1.0 - curvature[c, g] * R * y[k]
                shear = shear_by_force(y[k], z[k], curvature[c, g] * R, length)
                e11, g12, g13 = strains(R * y[k], R * z[k], length, shear, d)
                if rod_point(p, old[c, g, k], e11, g12, g13, new[c, g, k], C) < 0:
                    new[c, g, k, :] = math.nan
