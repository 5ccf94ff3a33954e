"""The kinds of sections: how a wire's cross-section deforms, and whether it includes the wire's curvature.

- plane: the thesis's; it stays plane and neglects the curvature,
- curved: it has the fibre lengths of the curved wire, and warps under its transverse force,
- warping: it warps freely with the curved and twisted wire, and has all six stresses.
"""

import numpy as np

from coilset.meshes.springs.placement import Placement
from coilset.model.core.base.package import package
from coilset.model.core.material.law.law import Law
from coilset.model.core.runtime.threads import Threads
from coilset.model.core.section.fibres import OUTLINES, FibreSections
from coilset.model.core.section.rules import DiskRule
from coilset.model.core.section.sections import Sections

KINDS = ("plane", "curved", "warping")
WARPING = "coilset.model.physics.warping.warping"  # the door to sections that warp freely


def make_sections(
    kind: str,
    law: Law,
    parameters: np.ndarray,
    rule: DiskRule,
    radius: np.ndarray,
    placement: Placement,
    temperature: float | None = None,
    degree: int = 3,
    threads: Threads | None = None,
) -> Sections:
    """The sections of a kind; arguments as in `FibreSections` and, for the degree, `WarpingSections`.

    Raises:
        ValueError: if there is no such kind.
        InputError: if its package is missing.
    """
    if kind not in KINDS:
        raise ValueError(f"kind '{kind}' is none of {', '.join(KINDS)}")
    if kind == "warping":
        sections = package(WARPING, "a section that warps", "mesh.section.kind").WarpingSections
        found: Sections = sections(law, parameters, rule, radius, placement, temperature, degree, threads)
        return found
    return FibreSections(law, parameters, rule, radius, placement, kind == "curved", temperature, threads)


def section_points(rule: DiskRule, placement: Placement) -> tuple[np.ndarray, np.ndarray]:
    """Points of all sections in wire radii, (n, g, points, 2), and their shares of the disk, (n, g, points).

    Raises:
        InputError: if the package of wire that is ground or not round is missing.
    """
    if rule.outline is not None or placement.is_cut:
        outlines = package(OUTLINES, "wire that is ground or not round")
        points: tuple[np.ndarray, np.ndarray] = outlines.section_points(rule, placement)
        return points
    sections = placement.curvature.shape
    places = np.broadcast_to(rule.points, (*sections, *rule.points.shape)).copy()
    return places, np.broadcast_to(rule.weights, (*sections, len(rule))).copy()
