"""Section points of the sections that grinding has cut, as the loops over all sections take them."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from coilset.meshes.springs.placement import Placement
from coilset.model.section.integration import FIBRES
from coilset.model.section.outline import WHOLE, Segment
from coilset.model.section.rules import DiskRule
from coilset.model.section.shape import SHAPE


class Ground(NamedTuple):
    """The cut sections of a rod.

    Attributes:
        which: number of each section among them, −1 if it is whole, shape (cells, sections).
        fibres: y, z, u, v of the points, mm, and their areas, mm², see `integration`; shape (cut sections, 5, points).
        shape: g, a22, a23, a32, a33, see `shape`; shape (cut sections, 5, points).
    """

    which: np.ndarray
    fibres: np.ndarray
    shape: np.ndarray

    def part(self, cells: slice) -> "Ground":
        """Those of some of the cells; the numbers, and what they stand for, stay."""
        return self._replace(which=self.which[cells])


def segments(placement: Placement) -> tuple[np.ndarray, list[Segment]]:
    """`Ground.which`, and what is left of the sections that are cut."""
    flat = placement.flat
    cut = flat[..., 0] < WHOLE
    which = np.where(cut, np.cumsum(cut.ravel()).reshape(cut.shape) - 1, -1)
    return which, [Segment(float(level), (float(y), float(z))) for level, y, z in flat[cut]]


def section_points(rule: DiskRule, placement: Placement) -> tuple[np.ndarray, np.ndarray]:
    """Points of all sections in wire radii, (n, g, points, 2), and their shares of the disk, (n, g, points)."""
    which, cut = segments(placement)
    places = np.broadcast_to(rule.points, (*which.shape, *rule.points.shape)).copy()
    weights = np.broadcast_to(rule.weights, (*which.shape, len(rule))).copy()
    for segment, at in zip(cut, np.argwhere(which >= 0), strict=True):
        left = segment.rule(len(rule))
        places[*at], weights[*at] = left.points, left.weights
    return places, weights


def ground_sections(
    placement: Placement, radius: np.ndarray, curved: bool, rule_of: Callable[[Segment], DiskRule]
) -> Ground:
    """The cut sections.

    Args:
        placement: of all sections.
        radius: wire radius of each element, shape (cells,), mm.
        curved: whether the sections know the wire's curvature.
        rule_of: points and weights that a segment gets.
    """
    which, cut = segments(placement)
    if not cut:
        return Ground(which, np.empty((0, FIBRES, 0)), np.empty((0, SHAPE, 0)))
    parts = []
    for segment, (cell, g) in zip(cut, np.argwhere(which >= 0), strict=True):
        bend = placement.curvature[cell, g] * radius[cell] if curved else 0.0
        parts.append(cut_section(segment, rule_of(segment), float(radius[cell]), float(bend)))
    return Ground(which, *(np.array(part) for part in zip(*parts, strict=True)))


def cut_section(segment: Segment, rule: DiskRule, radius: float, bend: float) -> tuple[np.ndarray, np.ndarray]:
    """`Ground.fibres` and `Ground.shape` of one section.

    Args:
        segment: what is left of it.
        rule: its points and weights.
        radius: of the wire, mm.
        bend: κ r, 0 for a section that ignores it.
    """
    y, z = rule.points.T
    (a22, a23, by_twist_12), (a32, a33, by_twist_13) = segment.warping(bend).shear(rule.points)
    levers = radius * np.array([y, z, by_twist_13, -by_twist_12])
    areas = math.pi * radius**2 * rule.weights
    return np.array([*levers, areas]), np.array([1.0 - bend * y, a22, a23, a32, a33])


def rim_rule(segment: Segment) -> DiskRule:
    """Points on a segment's surface; they weigh nothing."""
    places = segment.rim()
    return DiskRule(places, np.zeros(len(places)), "surface")
