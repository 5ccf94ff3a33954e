"""The uniform rod in place of a spring, as a first guess of a design's run and for slopes; the search learns the effect
of ends, contact and bowing, which it neglects.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from coilset.model.core.base.errors import SolveError
from coilset.model.core.case.case import Case
from coilset.model.core.case.material import case_law
from coilset.model.core.material import library
from coilset.model.core.material.law.law import Law
from coilset.model.physics.uniform_coil.estimate import estimate
from coilset.model.tools.design.conditions import Condition


@dataclass(frozen=True)
class Guess:
    """Estimate by the uniform rod.

    Attributes:
        values: of the conditions, shape (m,); NaN for those that the uniform rod cannot compute.
        torque: maximum torque in the wire over that at which its surface yields; 0 for an elastic law.
    """

    values: np.ndarray
    torque: float


def guess(case: Case, conditions: Sequence[Condition], load: Callable[[str], Law] = library.load) -> Guess:
    """Take the uniform rod through the load program of a case.

    Args:
        case, conditions: to run, and the results that are needed.
        load: gives the law of a material's name.

    Raises:
        InputError: if spring or material cannot be built, or the spring cannot reach a target.
    """
    spring = case.spring.build()
    law = load(case.material) if isinstance(case.material, str) else case_law(case, spring)
    unknown = np.full(len(conditions), np.nan)
    try:
        found = estimate(case, spring, law)
    except SolveError:
        return Guess(unknown, 0.0)
    names = [one.short_name if one.phase is None else f"force {one.phase}" for one in conditions]
    return Guess(np.array([found.numbers.get(name, np.nan) for name in names]), found.torque)
