"""The law of a body's points over a step, as passed to the compiled loops."""

import copy
from collections.abc import Mapping
from typing import Any

import numpy as np

from coilset.model.core.base.package import package
from coilset.model.core.material.law.functions import HELD
from coilset.model.core.material.law.law import Law
from coilset.model.core.material.law.loop import PointLaw
from coilset.model.core.material.point.loops import with_loop
from coilset.model.core.material.point.points import initial_state

TIME = "coilset.model.physics.time.creep.in_time"  # the door to laws that depend on time


class LawOverStep:
    """A law that does not depend on time; `LawOverTime` is that of one that does.

    Args:
        law: the material.
        parameters: of the law at the points' temperature.
        temperature: K, of the points at the start; None: the material's first.
        components: stresses of a point, 3 or 6.

    Attributes:
        in_time: CreepLaw, RateLaw, or None for a material that does not depend on time.
    """

    in_time: Any = None

    def __init__(self, law: Law, parameters: np.ndarray, temperature: float | None, components: int) -> None:
        self._law, self._temperature, self._components = law, temperature, components
        point_law = law.point_law(temperature)
        self._point_law = with_loop(
            parameters if isinstance(point_law, np.ndarray) else law.parts(parameters), components
        )

    def columns(self, back_stress: tuple[str, ...]) -> tuple[str, ...]:
        """Names of what the law adds to the columns of a point's state; `back_stress` names one back stress's."""
        return tuple(f"{name}_{term}" for term in range(1, self._law.n_terms) for name in back_stress)

    def unstressed(self) -> np.ndarray:
        """The row of an unstressed point, shape (1, columns)."""
        return initial_state(self._law, 1, self._components, self._temperature)

    def held(self) -> "LawOverStep":
        """The law without time whose tangents hold where κ sets in, see `functions.HELD`."""
        held, (address, parts) = copy.copy(self), self._point_law
        plastic = parts.plastic.copy()
        plastic[HELD] = 1.0
        held._point_law = PointLaw(address, parts._replace(plastic=plastic))
        return held

    def over(self, start: Mapping[str, np.ndarray], trial: Mapping[str, np.ndarray]) -> PointLaw:
        """The law from one state to the next."""
        return self._point_law

    def growth(self, start: Mapping[str, np.ndarray], trial: Mapping[str, np.ndarray]) -> float:
        """Thermal strain of all points from one state to the next, where the law itself takes it off their strains."""
        return 0.0


def law_over_step(law: Law, parameters: np.ndarray, temperature: float | None, components: int) -> LawOverStep:
    """The law of a material's points; arguments as in `LawOverStep`.

    Raises:
        InputError: if it depends on time, and the package of such laws is missing.
    """
    kind = LawOverStep
    if law.data.creep or law.data.rate:
        kind = package(TIME, "a material that depends on time").LawOverTime
    return kind(law, parameters, temperature, components)
