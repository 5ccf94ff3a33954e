"""The thesis's sections: they stay plane, in a straight wire, with three stresses at their points (5.2.4), (5.2.42)."""

import math
from collections.abc import Mapping

import numpy as np
from numba import njit

from coilset.meshes.placement import Placement
from coilset.model.material.functions import INLINE
from coilset.model.material.law import Law
from coilset.model.material.point_law import rod_point
from coilset.model.section.chord import to_chord, to_section
from coilset.model.section.law_over_time import LawOverTime
from coilset.model.section.rules import DiskRule, rim


class PlaneSections:
    """All sections of a rod on this rank.

    Args:
        law: the material.
        parameters: of the law at the rod's temperature.
        rule: quadrature of the disk.
        radius: wire radius of each element, shape (cells,), mm.
        placement: Placement of the cells' sections.
        temperature: K, of the points at the start; None: the material's first.

    Attributes:
        components: names of the columns of a point's state.
    """

    components: tuple[str, ...] = ("s11", "t12", "t13", "B11", "B12", "B13", "b")

    def __init__(
        self,
        law: Law,
        parameters: np.ndarray,
        rule: DiskRule,
        radius: np.ndarray,
        placement: Placement,
        temperature: float | None = None,
    ) -> None:
        self.radius, self.placement, self.weights = radius, placement, rule.weights
        self.law_over_time = LawOverTime(law, parameters, temperature)
        self.components += self.law_over_time.columns
        self.y, self.z = np.ascontiguousarray(rule.points.T)
        self.rim_y, self.rim_z = np.ascontiguousarray(rim().T)

    def initial_state(self) -> dict[str, np.ndarray]:
        """Unstressed points: `point_state`, shape (cells, 2, points, n_state), and `surface_state` on the surface."""
        row = self.law_over_time.unstressed(3)
        shape = (len(self.radius), 2)
        return {
            "point_state": np.tile(row, (*shape, len(self.y), 1)),
            "surface_state": np.tile(row, (*shape, len(self.rim_y), 1)),
        }

    def update(
        self,
        strain: np.ndarray,
        start: Mapping[str, np.ndarray],
        trial: dict[str, np.ndarray],
        s: np.ndarray,
        D: np.ndarray,
    ) -> bool:
        """Bring all sections to the end of the increment.

        Args:
            strain: ε, γ12, γ13, φ′, κ2, κ3 of the chords, shape (cells, 2, 6).
            start: state at the last equilibrium, with its `strain`; not changed.
            trial: state at the end of the increment; written.
            s: written, resultants about the chords, shape (cells, 2, 6), N and N mm.
            D: written, ds/de, shape (cells, 2, 6, 6).

        Returns:
            False if the law found no solution at some point or the strains are no numbers.
        """
        place, law = self.placement, self.law_over_time.over(start, trial)
        status = update_sections(
            law, self.y, self.z, self.weights, self.radius, strain - start["strain"], place.matrices,
            place.stretch, start["point_state"], trial["point_state"], s, D,
        )  # fmt: skip
        return status == 0

    def update_surface(self, strain: np.ndarray, start: Mapping[str, np.ndarray], trial: dict[str, np.ndarray]) -> None:
        """Bring the points on the wire's surface to the end of the increment; they bear no weight in the section.

        Where the law finds no solution the state becomes NaN.
        """
        place, law = self.placement, self.law_over_time.over(start, trial)
        update_surface(
            law, self.rim_y, self.rim_z, self.radius, strain - start["strain"], place.matrices,
            start["surface_state"], trial["surface_state"],
        )  # fmt: skip


@njit(cache=True)
def update_sections(
    p: np.ndarray,
    y: np.ndarray,
    z: np.ndarray,
    w: np.ndarray,
    radius: np.ndarray,
    de: np.ndarray,
    placement: np.ndarray,
    stretch: np.ndarray,
    old: np.ndarray,
    new: np.ndarray,
    s: np.ndarray,
    D: np.ndarray,
) -> int:
    """Bring all sections to the end of the increment.

    The strains of the chord axis are carried to the true section by `placement` (identity for a straight rod), the
    resultants back by its transpose; with ds/dx = `stretch` the virtual work is that of the true centre line.

    Args:
        p: parameters of the material law.
        y, z, w: points of the unit disk and weights, shape (points,).
        radius: wire radius of each element, shape (cells,), mm.
        de: increments of the section strains ε, γ12, γ13, φ′, κ2 = −w″, κ3 = v″, shape (cells, 2, 6).
        placement: shape (cells, 2, 6, 6), stretch: ds/dx, shape (cells, 2).
        old: state at the last equilibrium, shape (cells, 2, points, n_state); not changed.
        new: written, the state at the end of the increment.
        s: written, N, Q2, Q3 in N and Mt, M2, M3 in N mm, shape (cells, 2, 6), about the chord axis.
        D: written, section tangent ds/de, shape (cells, 2, 6, 6).

    Returns:
        0, or -1 if the law found no solution at some point or the strains are no numbers: then the step must be cut.
    """
    d = np.empty(6)
    C = np.empty((3, 3))
    resultant = np.empty(6)
    tangent = np.empty((6, 6))
    work = np.empty((6, 6))
    for c in range(len(radius)):
        R = radius[c]
        area = math.pi * R * R
        for g in range(2):
            P = placement[c, g]
            to_section(P, de[c, g], d)
            resultant[:] = 0.0
            tangent[:] = 0.0
            for k in range(len(w)):
                if not integrate_point(
                    p, R * y[k], R * z[k], area * w[k], d, old[c, g, k], new[c, g, k], C, resultant, tangent
                ):
                    return -1
            if not math.isfinite(resultant.sum()):
                return -1
            to_chord(P, stretch[c, g], resultant, tangent, work, s[c, g], D[c, g])
    return 0


@njit(**INLINE)
def strain_point(
    p: np.ndarray, y: float, z: float, d: np.ndarray, old: np.ndarray, new: np.ndarray, C: np.ndarray
) -> int:
    """The law at one point: ε11 = ε + κ2 z − κ3 y, γ12 = γ2 − φ′ z, γ13 = γ3 + φ′ y (5.2.4)."""
    return rod_point(p, old, d[0] + d[4] * z - d[5] * y, d[1] - d[3] * z, d[2] + d[3] * y, new, C)


@njit(**INLINE)
def integrate_point(
    p: np.ndarray,
    y: float,
    z: float,
    dA: float,
    d: np.ndarray,
    old: np.ndarray,
    new: np.ndarray,
    C: np.ndarray,
    resultant: np.ndarray,
    tangent: np.ndarray,
) -> bool:
    """Add one point's share to the section."""
    if strain_point(p, y, z, d, old, new, C) < 0:
        return False
    sigma, t2, t3 = new[0] * dA, new[1] * dA, new[2] * dA
    resultant[0] += sigma
    resultant[1] += t2
    resultant[2] += t3
    resultant[3] += t3 * y - t2 * z
    resultant[4] += sigma * z
    resultant[5] -= sigma * y
    # tangent = Zᵀ C Z dA with Z = ∂(ε11, γ12, γ13)/∂e; only the entries of Z that are not zero
    for i in range(3):
        c0, c1, c2 = C[i, 0] * dA, C[i, 1] * dA, C[i, 2] * dA
        row3 = c2 * y - c1 * z
        row4 = c0 * z
        row5 = -c0 * y
        if i == 0:
            a, b, fa, fb = 4, 5, z, -y
        elif i == 1:
            a, b, fa, fb = 3, 3, -z, 0.0
        else:
            a, b, fa, fb = 3, 3, y, 0.0
        for row, f in ((i, 1.0), (a, fa), (b, fb)):
            tangent[row, 0] += f * c0
            tangent[row, 1] += f * c1
            tangent[row, 2] += f * c2
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
    de: np.ndarray,
    placement: np.ndarray,
    old: np.ndarray,
    new: np.ndarray,
) -> None:
    """Bring the points y, z of the unit circle to the end of the increment; arguments as in `update_sections`."""
    d = np.empty(6)
    C = np.empty((3, 3))
    for c in range(len(radius)):
        R = radius[c]
        for g in range(2):
            to_section(placement[c, g], de[c, g], d)
            for k in range(len(y)):
                if strain_point(p, R * y[k], R * z[k], d, old[c, g, k], new[c, g, k], C) < 0:
                    new[c, g, k, :] = math.nan
