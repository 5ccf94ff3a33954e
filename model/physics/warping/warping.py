"""Sections that warp: all six stresses of a curved and twisted wire, its warping condensed at each section.

The wire's axis has the tangent t, the normal n, the binormal b, curvature κ and torsion τ. A point of the section is
r = y n + z b, and g = 1 − κ y is the length of its fibre over that of the axis. To the rigid motion with the section
strains Γ, K comes a warping w(y, z), constant along the wire in the frame that turns with Ω = τ t + κ b. The columns of
the displacement's gradient along t, n, b are

    H_t = [Γ + K × r + Ω × w + τ (z w,y − y w,z)] / g,     H_n = w,y,     H_b = w,z,     ε = sym H.

Nothing works on w, so that ∫ σ : δε g dA = s · δe for all δe, δw. w is a polynomial w = r Σ a_k f_k(y/r, z/r) without
the six rigid modes, which would only rename Γ and K: ∫ w dA = 0, ∫ r × w dA = 0. Newton's method finds the a at given
e, and the section tangent follows by condensation, D = D_ee − D_ea D_aa⁻¹ D_ae. The spin of the increment is left out.

The iteration begins where the slope da/de of the last equilibrium leads, or that of the last trial, whichever has the
nearer strains. Stresses and resultants are a function of the state at the last
equilibrium and of the strains, whatever was tried in between, but for the tolerance of the warping.
"""

import copy
import math
from collections.abc import Mapping, Sequence

import numpy as np

from coilset.meshes.springs.placement import Placement
from coilset.model.core.material.law.functions import ROWS_START, SHEAR, YOUNG
from coilset.model.core.material.law.law import Law
from coilset.model.core.material.law.loop import PointLaw, flow_points
from coilset.model.core.material.point.groups import hooke
from coilset.model.core.material.point.over_step import law_over_step
from coilset.model.core.runtime.kernels import KERNEL, njit
from coilset.model.core.runtime.threads import Threads
from coilset.model.core.section.chord import to_chord, to_section
from coilset.model.core.section.fibres import spoil_failed
from coilset.model.core.section.rules import DiskRule, rim
from coilset.model.core.section.sections import Sections
from coilset.model.physics.outlines.ground import cut_sections
from coilset.model.physics.warping.condensation import (
    Elastic,
    Tables,
    elastic_stiffness,
    find_warping,
    place,
    slopes,
    strains,
    work_space,
)
from coilset.model.physics.warping.polynomials import Basis

KNOWN = "warping_strain"  # section strains to which the trial warping and its slope belong
DECIMALS = 12  # of κ r and τ r, to which sections of one geometry agree


class WarpingSections(Sections):
    """All sections of a rod on this rank; arguments as in `FibreSections`.

    Args:
        degree: of the polynomials.

    Attributes:
        components: names of the columns of a point's state.
        unknowns: number of warping unknowns of a section.
    """

    iterate: tuple[str, ...] = (KNOWN,)
    components: tuple[str, ...] = (
        "s11",
        "s22",
        "s33",
        "t12",
        "t13",
        "t23",
        "B11",
        "B22",
        "B33",
        "B12",
        "B13",
        "B23",
        "b",
    )

    def __init__(
        self,
        law: Law,
        parameters: np.ndarray,
        rule: DiskRule,
        radius: np.ndarray,
        placement: Placement,
        temperature: float | None,
        degree: int,
        threads: Threads | None,
    ) -> None:
        self.threads = threads or Threads()
        self.radius, self.placement = radius, placement
        self.law_over_step = law_over_step(law, parameters, temperature, 6)
        self.components += self.law_over_step.columns(self.components[6:12])
        outline = rule.outline
        basis = Basis.of_disk(degree) if outline is None else outline.basis(degree)
        which, cut = cut_sections(placement, outline)
        left, bases = [one.rule(len(rule)) for one in cut], [one.basis(degree) for one in cut]
        points = _with_polynomials([rule.points, *(one.points for one in left)], [basis, *bases])
        self.weights = np.array([rule.weights, *(one.weights for one in left)])
        whole = rim() if outline is None else outline.rim()
        rims = _with_polynomials([whole, *(one.rim() for one in cut)], [basis, *bases])
        geometry = _geometry(which, radius, placement)
        self.inside = Tables._make((*geometry, *points, self.weights))
        self.rim = Tables._make((*geometry, *rims, np.zeros(rims[0].shape)))
        C = np.empty((6, 6))
        hooke(parameters[ROWS_START + YOUNG], parameters[ROWS_START + SHEAR], C)
        self.elastic = Elastic(elastic_stiffness(C, self.inside), C)
        self.unknowns = 3 + points[2].shape[1]
        # of each thread: sections brought up to date, local iterations on the way
        self.iterations = np.zeros((self.threads.number, 2), dtype=np.int64)

    def part(self, cells: slice) -> "WarpingSections":
        """The sections of some of the cells."""
        part = copy.copy(self)
        part.radius, part.placement = self.radius[cells], self.placement.part(cells)
        part.inside, part.rim = (one._replace(number=one.number[cells]) for one in (self.inside, self.rim))
        return part

    def initial_state(self) -> dict[str, np.ndarray]:
        """Unstressed points, `point_state` and `surface_state` as in `FibreSections`, and the warping.

        `warping` are the a, shape (cells, sections, unknowns), and `warping_slope` is da/de, shape (cells, sections,
        unknowns, 6); `warping_strain` are the section strains at which they were found, shape (cells, sections, 6).
        """
        row = self.law_over_step.unstressed()
        shape = self.placement.stretch.shape
        return {
            "point_state": np.tile(row, (*shape, self.weights.shape[1], 1)),
            "surface_state": np.tile(row, (*shape, self.rim.y.shape[1], 1)),
            "warping": np.zeros((*shape, self.unknowns)),
            "warping_slope": np.zeros((*shape, self.unknowns, 6)),
            KNOWN: np.zeros((*shape, 6)),
        }

    def update(
        self,
        strain: np.ndarray,
        start: Mapping[str, np.ndarray],
        trial: dict[str, np.ndarray],
        s: np.ndarray,
        D: np.ndarray,
        with_tangent: bool = True,
    ) -> bool:
        """See Sections; always with the tangent. Without `warping_strain` in `trial` the iteration begins at the last
        equilibrium."""
        place, law, known = self.placement, self.law_over_step.over(start, trial), trial.get(KNOWN, np.array(np.nan))
        good = self.threads.run(
            update_sections,
            len(self.radius),
            self.placement.stretch.shape[1] * self.weights.shape[1],
            law,
            self.inside,
            self.elastic,
            strain - start["strain"],
            strain - known,
            place.matrices,
            place.stretch,
            start["point_state"],
            start["warping"],
            start["warping_slope"],
            trial["point_state"],
            trial["warping"],
            trial["warping_slope"],
            s,
            D,
            self.iterations,
        )
        known[...] = strain if good and KNOWN in trial else np.nan
        return good

    def update_surface(self, strain: np.ndarray, start: Mapping[str, np.ndarray], trial: dict[str, np.ndarray]) -> None:
        """Bring the points on the wire's surface to the end of the increment; as `FibreSections.update_surface`."""
        place, law = self.placement, self.law_over_step.over(start, trial)
        self.threads.run(
            update_surface,
            len(self.radius),
            self.placement.stretch.shape[1] * self.rim.y.shape[1],
            law,
            self.rim,
            strain - start["strain"],
            place.matrices,
            start["surface_state"],
            trial["warping"] - start["warping"],
            trial["surface_state"],
        )


def _with_polynomials(points: Sequence[np.ndarray], bases: Sequence[Basis]) -> tuple[np.ndarray, ...]:
    """y, z, and the polynomials and their slopes there, of the whole disk and of each section that is ground."""
    y, z = np.ascontiguousarray(np.moveaxis(np.array(points), -1, 0))
    values = [np.concatenate(np.swapaxes(basis(one), 1, 2)) for basis, one in zip(bases, points, strict=True)]
    return y, z, np.ascontiguousarray(values)


def _geometry(which: np.ndarray, radius: np.ndarray, placement: Placement) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """`number`, `wire` and `which` of Tables; sections are the same if they differ by rounding."""
    R = np.broadcast_to(radius[:, None], which.shape)
    bends = (np.round(value * R, DECIMALS) / R for value in (placement.curvature, placement.torsion))
    rows = np.stack([R, *bends, which + 1.0], axis=-1).reshape(-1, 4)
    found, number = np.unique(rows, axis=0, return_inverse=True)
    return number.reshape(which.shape), np.ascontiguousarray(found[:, :3]), found[:, 3].astype(np.int64)


@njit(cache=True, nogil=True)
def update_sections(
    ends: np.ndarray,
    part: int,
    law: PointLaw,
    at: Tables,
    elastic: Elastic,
    de: np.ndarray,
    way: np.ndarray,
    placement: np.ndarray,
    stretch: np.ndarray,
    old: np.ndarray,
    old_a: np.ndarray,
    old_slope: np.ndarray,
    new: np.ndarray,
    a: np.ndarray,
    slope: np.ndarray,
    s: np.ndarray,
    D: np.ndarray,
    count: np.ndarray,
) -> bool:
    """Bring the sections of a part of the cells to the end of the increment.

    Args:
        ends, part: as in `fibres.update_sections`.
        law: of the points.
        at: geometry of the sections.
        elastic: stiffness of elastic sections, and of elastic points.
        de, placement, stretch, s, D: as in `fibres.update_sections`.
        way: increments from the section strains to which `a` and `slope` belong, shape as `de`; NaN if to none.
        old, old_a, old_slope: state of the points with all six stresses, warping, and its slope da/de in the section's
            own strains, at the last equilibrium, shapes (cells, sections, points, n_state), (cells, sections, unknowns)
            and (cells, sections, unknowns, 6); not changed.
        new, a, slope: written, the same at the end of the increment.
        count: sections and local iterations are added to the row of the part, shape (parts, 2).

    Returns:
        False if the law or the warping found no solution, or the strains are no numbers.
    """
    n, points = a.shape[2], at.w.shape[1]
    w = work_space(points, n)
    inverse, dA, work = np.empty(points), np.empty(points), np.empty((6, 6))
    near = np.empty(6)
    for c in range(ends[part], ends[part + 1]):
        for g in range(de.shape[1]):
            P, of = placement[c, g], place(at, at.number[c, g], inverse, dA)
            to_section(P, de[c, g], w.step)
            to_section(P, way[c, g], near)
            good, first = False, 0 if _length(of.bend.R, near) < _length(of.bend.R, w.step) else 1
            # from where the slope of the last trial leads, else that of the last equilibrium, else from there itself
            for attempt in range(first, 3):
                if attempt == 0:
                    _lead(slope[c, g], near, a[c, g])
                else:
                    for m in range(n):
                        a[c, g, m] = old_a[c, g, m]
                if attempt == 1:
                    _lead(old_slope[c, g], w.step, a[c, g])
                good = find_warping(law, of, elastic, old[c, g], old_a[c, g], a[c, g], new[c, g], w, count[part])
                if good:
                    break
            if not good:
                return False
            slopes(w, slope[c, g])
            if not math.isfinite(w.rest[:6].sum()):
                return False
            to_chord(P, stretch[c, g], w.rest[:6], w.K[:6], work, s[c, g], D[c, g])
            count[part, 0] += 1
    return True


@njit(**KERNEL)
def _length(R: float, e: np.ndarray) -> float:
    """Square of a change of section strains: of stretches, and of strains at the wire's surface."""
    return e[0] ** 2 + e[1] ** 2 + e[2] ** 2 + R * R * (e[3] ** 2 + e[4] ** 2 + e[5] ** 2)


@njit(**KERNEL)
def _lead(slope: np.ndarray, way: np.ndarray, a: np.ndarray) -> None:
    """Add da/de times a change of the section strains to the warping."""
    for m in range(len(a)):
        for j in range(6):
            a[m] += slope[m, j] * way[j]


@njit(cache=True, nogil=True)
def update_surface(
    ends: np.ndarray,
    part: int,
    law: PointLaw,
    at: Tables,
    de: np.ndarray,
    placement: np.ndarray,
    old: np.ndarray,
    da: np.ndarray,
    new: np.ndarray,
) -> None:
    """Bring points on the surface of a part to the end of the increment `de`, `da` of strains and warping."""
    n, points = da.shape[2], at.w.shape[1]
    w, inverse, dA = work_space(points, n), np.empty(points), np.empty(points)
    for c in range(ends[part], ends[part + 1]):
        for g in range(de.shape[1]):
            of = place(at, at.number[c, g], inverse, dA)
            to_section(placement[c, g], de[c, g], w.step)
            for j in range(n):
                w.step[6 + j] = da[c, g, j]
            strains(of, w.step, w.strain)
            flow_points(law, 6, old[c, g], w.strain, new[c, g], w.C.reshape((-1, 36)), True, w.flow)
            spoil_failed(w.flow, new[c, g])
