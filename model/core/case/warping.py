"""Whether the sections of a case warp as they should, and whether it can be estimated what they lack."""

from coilset.meshes.springs.geometry import Spring
from coilset.model.core.case.case import Case
from coilset.model.core.material.law.law import Law


def keeps_elastic_warping(case: Case, spring: Spring) -> bool:
    """Whether its sections' warping would change as they yield, but does not."""
    return spring.section is not None and case.mesh.section.kind != "warping"


def warping_can_be_estimated(case: Case, law: Law) -> bool:
    """Whether sections can be followed as ones that warp freely: with six stresses, in curved wire."""
    return case.mesh.section.kind == "curved" and law.keeps_direction is None
