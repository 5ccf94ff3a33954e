"""Sections of fibres with three stresses: plane ones of a straight wire, and those that include its curvature."""

import copy
import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from coilset.meshes.springs.placement import Placement
from coilset.model.core.base.package import package
from coilset.model.core.material.law.law import Law
from coilset.model.core.material.law.loop import PointLaw
from coilset.model.core.material.point.over_step import law_over_step
from coilset.model.core.runtime.kernels import KERNEL, njit
from coilset.model.core.runtime.threads import Threads
from coilset.model.core.section.chord import to_chord, to_section
from coilset.model.core.section.integration import FIBRES, section
from coilset.model.core.section.rules import DiskRule, rim
from coilset.model.core.section.sections import BEND, Sections
from coilset.model.core.section.shape import SHAPE, curved_shape, straight_shape

OUTLINES = "coilset.model.physics.outlines.ground"  # the door to sections that are no disks


class Ground(NamedTuple):
    """The sections of a rod that are no disks: what grinding has cut, and all of a wire that is not round.

    Attributes:
        which: number of each section among them, −1 if it is a disk, shape (cells, sections).
        fibres: y, z, u, v of the points, mm, and their areas, mm², see `integration`; shape (cut sections, 5, points).
        shape: g, a22, a23, a32, a33, see `shape`; shape (cut sections, 5, points).
    """

    which: np.ndarray
    fibres: np.ndarray
    shape: np.ndarray

    @classmethod
    def none(cls, shape: tuple[int, ...]) -> "Ground":
        """Of disks only, shape (cells, sections)."""
        return cls(np.full(shape, -1), np.empty((0, FIBRES, 0)), np.empty((0, SHAPE, 0)))

    def part(self, cells: slice) -> "Ground":
        """Those of some of the cells; the numbers, and what they stand for, stay."""
        return self._replace(which=self.which[cells])


class FibreSections(Sections):
    """All sections of a rod on this rank.

    Args:
        law: the material.
        parameters: of the law at the rod's temperature.
        rule: quadrature of the disk, or of the outline of a wire that is not round.
        radius: wire radius of each element, shape (cells,), mm.
        placement: Placement of the cells' sections.
        curved: whether they include the wire's curvature, see `shape`; else they are the thesis's, plane, of a straight
            wire.
        temperature: K, of the points at the start; None: the material's first.
        threads: Threads that advance them; None: the calling one alone.

    Attributes:
        components: names of the columns of a point's state.
    """

    passing: tuple[str, ...] = ("point_state",)

    components: tuple[str, ...] = ("s11", "t12", "t13", "B11", "B12", "B13", "b")

    def __init__(
        self,
        law: Law,
        parameters: np.ndarray,
        rule: DiskRule,
        radius: np.ndarray,
        placement: Placement,
        curved: bool,
        temperature: float | None = None,
        threads: Threads | None = None,
    ) -> None:
        self.threads = threads or Threads()
        self.radius, self.placement, self.weights, self.curved = radius, placement, rule.weights, curved
        self.law_over_step = law_over_step(law, parameters, temperature, 3)
        self.components += self.law_over_step.columns(self.components[3:6])
        self.y, self.z = np.ascontiguousarray(rule.points.T)
        self.rim_y, self.rim_z = np.ascontiguousarray(rim().T)
        self.ground = self.ground_rim = Ground.none(placement.stretch.shape)
        if rule.outline is not None or placement.is_cut:
            cut = package(OUTLINES, "wire that is ground or not round")
            self.ground, self.ground_rim = cut.points_and_rims(placement, radius, curved, rule)

    def part(self, cells: slice) -> "FibreSections":
        """The sections of some of the cells."""
        part = copy.copy(self)
        part.radius, part.placement = self.radius[cells], self.placement.part(cells)
        part.ground, part.ground_rim = self.ground.part(cells), self.ground_rim.part(cells)
        return part

    def cut_points(self, cell: int, g: int) -> tuple[np.ndarray, np.ndarray] | None:
        """`fibres` and `shape` (see `Ground`) of a section's points and of those on its surface; None: a disk."""
        k = self.ground.which[cell, g]
        if k < 0:
            return None
        both = self.ground, self.ground_rim
        return np.hstack([one.fibres[k] for one in both]), np.hstack([one.shape[k] for one in both])

    def initial_state(self) -> dict[str, np.ndarray]:
        """Unstressed points: `point_state` (cells, sections, points, n_state), and `surface_state` on the surface."""
        row = self.law_over_step.unstressed()
        shape = self.placement.stretch.shape
        return {
            "point_state": np.tile(row, (*shape, len(self.y), 1)),
            "surface_state": np.tile(row, (*shape, len(self.rim_y), 1)),
        }

    def _increment(
        self, strain: np.ndarray, start: Mapping[str, np.ndarray], trial: Mapping[str, np.ndarray]
    ) -> np.ndarray:
        """Increments of the chords' strains, with growth by temperature as fibres take it.

        A curved wire that grows evenly turns nowhere. The axis then has the strain α ΔT, the fibres, whose distance y
        from it stays in `shape`, have α ΔT/g, and the law takes off α ΔT: the rest, α ΔT κ y/g, is that of the bend
        −κ α ΔT, which is taken off here.
        """
        growth = self.law_over_step.growth(start, trial) if self.curved else 0.0
        increment = strain - start["strain"]
        if growth:
            place = self.placement
            bend = np.zeros((*place.curvature.shape, 6, 1))
            bend[..., BEND, 0] = growth * place.curvature
            increment += np.linalg.solve(place.matrices, bend)[..., 0]
        return increment

    def update(
        self,
        strain: np.ndarray,
        start: Mapping[str, np.ndarray],
        trial: dict[str, np.ndarray],
        s: np.ndarray,
        D: np.ndarray,
        with_tangent: bool = True,
    ) -> bool:
        """See Sections."""
        disk = self.y, self.z, self.weights
        states = start["point_state"], trial["point_state"]
        law = self.law_over_step.over(start, trial)
        return self._run(law, self.ground, disk, self._increment(strain, start, trial), states, s, D, with_tangent)

    def update_surface(self, strain: np.ndarray, start: Mapping[str, np.ndarray], trial: dict[str, np.ndarray]) -> None:
        """Advance the points on the wire's surface to the end of the increment; they have no weight in the section.

        If the law finds no solution the state becomes NaN.
        """
        rim = self.rim_y, self.rim_z, np.zeros(len(self.rim_y))
        states = start["surface_state"], trial["surface_state"]
        s = np.empty((*self.placement.stretch.shape, 6))
        D = np.empty((*s.shape, 6))  # never written
        law = self.law_over_step.over(start, trial)
        self._run(law, self.ground_rim, rim, self._increment(strain, start, trial), states, s, D, False, True)

    def _run(
        self,
        law: PointLaw,
        ground: Ground,
        points: tuple[np.ndarray, ...],
        increment: np.ndarray,
        states: tuple[np.ndarray, np.ndarray],
        s: np.ndarray,
        D: np.ndarray,
        with_tangent: bool,
        spoil: bool = False,
    ) -> bool:
        """Run `update_sections`, at points y, z of the unit disk with weights."""
        place = self.placement
        return self.threads.run(
            update_sections,
            len(self.radius),
            place.stretch.shape[1] * len(points[0]),
            law,
            tuple(ground),
            *points,
            self.radius,
            place.curvature,
            self.curved,
            increment,
            place.matrices,
            place.stretch,
            *states,
            s,
            D,
            with_tangent,
            spoil,
        )


@njit(**KERNEL, nogil=True)
def update_sections(
    ends: np.ndarray,
    part: int,
    law: PointLaw,
    ground: tuple[np.ndarray, np.ndarray, np.ndarray],
    y: np.ndarray,
    z: np.ndarray,
    w: np.ndarray,
    radius: np.ndarray,
    curvature: np.ndarray,
    curved: bool,
    de: np.ndarray,
    placement: np.ndarray,
    stretch: np.ndarray,
    old: np.ndarray,
    new: np.ndarray,
    s: np.ndarray,
    D: np.ndarray,
    with_tangent: bool,
    spoil: bool,
) -> bool:
    """Bring the sections of a part of the cells to the end of the increment.

    The strains of the chord axis are carried to the true section by `placement` (identity for a straight rod), the
    resultants back by its transpose; with ds/dx = `stretch` the virtual work is that of the true centre line.

    Args:
        ends: where the parts of all cells begin and end, shape (parts + 1,).
        part: number of the one that is brought there.
        law: of the points.
        ground: entries of Ground; as plain tuples they take numba 25 µs less.
        y, z, w: points of the unit disk and weights, shape (points,).
        radius: wire radius of each element, shape (cells,), mm.
        curvature: κ of the wire, towards y, shape (cells, sections), 1/mm; curved: is it known to the sections?
        de: increments of the section strains ε, γ12, γ13, φ′, κ2 = −w″, κ3 = v″, shape (cells, sections, 6).
        placement: shape (cells, sections, 6, 6), stretch: ds/dx, shape (cells, sections).
        old: state at the last equilibrium, shape (cells, sections, points, n_state); not changed.
        new: written, the state at the end of the increment; of the last section only, in the place of the part, if it
            has not room for all.
        s: written, N, Q2, Q3 in N and Mt, M2, M3 in N mm, shape (cells, sections, 6), about the chord axis.
        D: written if `with_tangent`, section tangent ds/de, shape (cells, sections, 6, 6).
        spoil: make states NaN where the law found no solution, and go on.

    Returns:
        False if the law found no solution at some point or the strains are no numbers, and `spoil` is False: then the
        step must be cut.
    """
    points, (cut, cut_fibres, cut_shape) = len(w), ground
    d, resultant, tangent, work = np.empty(6), np.empty(6), np.empty((6, 6)), np.empty((6, 6))
    strain, C, count = np.empty((3, points)), np.empty((9, points)), np.empty(points, np.int64)
    disk, disk_shape = np.empty((FIBRES, points)), np.empty((SHAPE, points))
    straight_shape(disk_shape)
    last, last_bend, kept = 0.0, math.nan, len(new) == len(radius)
    for c in range(ends[part], ends[part + 1]):
        R, at = radius[c], c if kept else part
        if last != R:
            last = R
            round_fibres(y, z, w, R, disk)
        for g in range(de.shape[1]):
            to_section(placement[c, g], de[c, g], d)
            fibres, shape = disk, disk_shape
            if cut[c, g] >= 0:
                fibres, shape = cut_fibres[cut[c, g]], cut_shape[cut[c, g]]
            elif curved and curvature[c, g] * R != last_bend:
                last_bend = curvature[c, g] * R
                curved_shape(y, z, last_bend, disk_shape)
            if not section(
                law, fibres, shape, d, old[c, g], new[at, g], strain, C, with_tangent, count, resultant, tangent
            ):
                if not spoil:
                    return False
                spoil_failed(count, new[at, g])
            to_chord(placement[c, g], stretch[c, g], resultant, tangent, work, s[c, g], D[c, g], with_tangent)
    return True


@njit(**KERNEL)
def round_fibres(y: np.ndarray, z: np.ndarray, w: np.ndarray, radius: float, fibres: np.ndarray) -> None:
    """Write y, z, u, v and areas of a disk's points, see `integration`, shape (5, points)."""
    for k in range(len(y)):
        fibres[0, k] = fibres[2, k] = radius * y[k]
        fibres[1, k] = fibres[3, k] = radius * z[k]
        fibres[4, k] = math.pi * radius * radius * w[k]


@njit(**KERNEL)
def spoil_failed(count: np.ndarray, new: np.ndarray) -> None:
    """Make states NaN where the law found no solution."""
    for k in range(len(count)):
        if count[k] < 0:
            new[k, :] = math.nan
