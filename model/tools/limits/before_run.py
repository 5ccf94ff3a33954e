"""What follows from the standards for a case, before it runs."""

import math
from typing import NamedTuple

from coilset.meshes.springs.geometry import Spring
from coilset.model.core.base.errors import InputError
from coilset.model.core.base.warning import Warning
from coilset.model.core.case import Case
from coilset.model.core.case.loading import is_pressed
from coilset.model.core.case.material import case_elastic
from coilset.model.core.material.law.law import Law
from coilset.model.tools.limits.case_warnings import case_warnings
from coilset.model.tools.standards import en13906
from coilset.model.tools.standards.buckling import buckling_travel, seating_of
from coilset.model.tools.standards.cylinder import Cylinder


class BeforeRun(NamedTuple):
    """Of a spring by the standards, before its run.

    Attributes:
        warnings: about its case.
        buckling_travel: at which it buckles by EN 13906-1, mm; infinite if it never does, or is not compressed.
        nominal_stress: `nominal_stress`.
    """

    warnings: tuple[Warning, ...]
    buckling_travel: float
    nominal_stress: tuple[float | None, float | None]


def before_run(case: Case, spring: Spring, law: Law) -> BeforeRun:
    """What follows from the standards for a case with its spring and law."""
    elastic = case_elastic(case, law)
    ratio = elastic.shear_modulus / elastic.young_modulus
    travel = buckling_travel(spring, ratio, seating_of(case)) if is_pressed(case, spring) else math.inf
    return BeforeRun(case_warnings(case, spring, law), travel, nominal_stress(spring))


def nominal_stress(spring: Spring) -> tuple[float | None, float | None]:
    """τ = 8 D/(π d³) and k τ of EN 13906-1 under 1 N, or D/(2 W) of wire that is not round, MPa.

    None of a spring that is no cylinder of one wire.
    """
    try:
        cylinder = Cylinder.of(spring)
    except InputError:
        return None, None
    stress = en13906.stress(1.0, cylinder.of_stress, cylinder.D)
    return stress, cylinder.correction * stress
