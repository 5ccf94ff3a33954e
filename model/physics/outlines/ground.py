"""Section points of the sections that grinding has cut, as the loops over all sections take them."""

import math
from collections.abc import Callable

import numpy as np

from coilset.meshes.springs.placement import Placement
from coilset.model.core.section.fibres import Ground
from coilset.model.core.section.integration import FIBRES
from coilset.model.core.section.rules import DiskRule
from coilset.model.physics.outlines.outlined_section import WHOLE, Outlined, Section, Segment

BENDS, NODES = 16, 5  # intervals of κ r in a unit, and nodes in each, between which the warping is interpolated
DIGITS = 12  # of κ r, to which sections must agree to be the same


def cut_sections(placement: Placement, outline: Outlined | None = None) -> tuple[np.ndarray, list[Section]]:
    """Number of each section among those that are cut, −1 if it is whole, and what is left of these."""
    flat, cut = placement.flat, placement.flat[..., 0] < WHOLE
    planes = [(float(level), (float(y), float(z))) for level, y, z in flat[cut]]
    if outline is None:
        left: list[Section] = [Segment(*plane) for plane in planes]
    else:
        parts = [outline.cut(*plane) for plane in planes]
        cut[cut] = [part is not outline for part in parts]
        left = [part for part in parts if part is not outline]
    return np.where(cut, np.cumsum(cut.ravel()).reshape(cut.shape) - 1, -1), left


def cut_points(rule: DiskRule, placement: Placement) -> list[tuple[int, int, np.ndarray, np.ndarray]]:
    """Element, section, points in wire radii and shares of the disk of the sections that grinding has cut."""
    which, cut = cut_sections(placement, rule.outline)
    rules = [section.rule(len(rule)) for section in cut]
    places = np.argwhere(which >= 0)
    return [(int(k), int(g), left.points, left.weights) for left, (k, g) in zip(rules, places, strict=True)]


def points_and_rims(placement: Placement, radius: np.ndarray, curved: bool, rule: DiskRule) -> tuple[Ground, Ground]:
    """The sections that are no disks, by the points of a rule and by those on the surface.

    Args:
        placement: of all sections.
        radius: wire radius of each element, shape (cells,), mm.
        curved: whether the sections account for the wire's curvature.
        rule: of the whole section.
    """
    whole, given = rule.outline, (placement, radius, curved, rule.outline)
    points = ground_sections(*given, lambda left: rule if left is whole else left.rule(len(rule)))
    return points, ground_sections(*given, rim_rule)


def ground_sections(
    placement: Placement,
    radius: np.ndarray,
    curved: bool,
    outline: Outlined | None,
    rule_of: Callable[[Section], DiskRule],
) -> Ground:
    """The sections that are no disks; arguments as above, with the points and weights that a section gets."""
    which, cut = cut_sections(placement, outline)
    bend = placement.curvature * radius[:, None] if curved else np.zeros(which.shape)
    parts = [
        cut_section(section, rule_of(section), float(radius[cell]), float(bend[cell, g]))
        for section, (cell, g) in zip(cut, np.argwhere(which >= 0), strict=True)
    ]
    if outline is not None:
        whole = which < 0
        of_radius = np.broadcast_to(radius[:, None], which.shape)[whole]
        kinds, number = np.unique(np.stack([of_radius, bend[whole].round(DIGITS)]), axis=1, return_inverse=True)
        which[whole] = len(cut) + number.ravel()
        parts += whole_sections(outline, rule_of(outline), *kinds)
    if not parts:
        return Ground.none(which.shape)
    return Ground(which, *(np.array(part) for part in zip(*parts, strict=True)))


def whole_sections(
    outline: Outlined, rule: DiskRule, radius: np.ndarray, bend: np.ndarray
) -> list[tuple[np.ndarray, np.ndarray]]:
    """`cut_section` of an outline for many radii and κ r, shapes (n,), by polynomials in κ r between every BENDS."""
    from scipy.interpolate import BarycentricInterpolator  # takes a third of a second, and whole round wire needs none

    found, tables = [], {}
    for r, b in zip(radius.tolist(), bend.tolist(), strict=True):
        cell = int(b * BENDS)
        if cell not in tables:
            nodes = (cell + 0.5 - 0.5 * np.cos(np.pi * np.arange(NODES) / (NODES - 1))) / BENDS
            both = np.array([np.concatenate(cut_section(outline, rule, 1.0, float(node))) for node in nodes])
            tables[cell] = BarycentricInterpolator(nodes, both)
        fibres, shape = np.split(tables[cell](b), [FIBRES])
        found.append((fibres * np.array([r, r, r, r, r * r])[:, None], shape))
    return found


def cut_section(section: Section, rule: DiskRule, radius: float, bend: float) -> tuple[np.ndarray, np.ndarray]:
    """`Ground.fibres` and `Ground.shape` of one section.

    Args:
        section: Section.
        rule: its points and weights.
        radius: of the wire, mm.
        bend: κ r, 0 for a section that ignores it.
    """
    y, z = rule.points.T
    (a22, a23, by_twist_12), (a32, a33, by_twist_13) = section.warping(bend).shear(rule.points)
    levers = radius * np.array([y, z, by_twist_13, -by_twist_12])
    areas = math.pi * radius**2 * rule.weights
    return np.array([*levers, areas]), np.array([1.0 - bend * y, a22, a23, a32, a33])


def rim_rule(section: Section) -> DiskRule:
    """Points on a section's surface; they weigh nothing."""
    places = section.rim()
    return DiskRule(places, np.zeros(len(places)), "surface")
