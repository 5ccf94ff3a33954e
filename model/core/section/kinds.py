"""The kinds of sections: how a wire's cross-section deforms, and whether it includes the wire's curvature.

- plane: the thesis's; it stays plane and neglects the curvature,
- curved: it has the fibre lengths of the curved wire, and warps under its transverse force,
- warping: it warps freely with the curved and twisted wire, and has all six stresses.
"""

from collections.abc import Sequence
from typing import Any

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


def cut_points(rule: DiskRule, placement: Placement) -> Sequence[tuple[int, int, np.ndarray, np.ndarray]]:
    """Element, section, points and weights of the sections that grinding has cut, as `spread` takes them.

    Raises:
        InputError: if the package of wire that is ground is missing.
    """
    if not placement.is_cut and rule.outline is None:
        return ()
    found: Sequence[Any] = package(OUTLINES, "wire that is ground or not round").cut_points(rule, placement)
    return found
