"""The law of a section's points over a step: without time or with it."""

import copy
from collections.abc import Mapping

import numpy as np

from coilset.model.material.creep.law import CREEP_COLUMNS, TEMPERATURE, CreepLaw, RateLaw
from coilset.model.material.law.functions import HELD
from coilset.model.material.law.law import Law
from coilset.model.material.law.loop import PointLaw
from coilset.model.material.point.loops import with_loop
from coilset.model.material.point.points import initial_state


def law_in_time(law: Law, plastic: np.ndarray) -> RateLaw | None:
    """What the material does in time: creep, rate-dependent yield, or nothing."""
    parts = law.parts(plastic)
    if law.data.creep:
        return CreepLaw(law.data.creep, parts, law.is_adiabatic, law.data.rate)
    return RateLaw(law.data.rate, parts) if law.data.rate else None


class LawOverTime:
    """The law as passed to the compiled loops over the points.

    Args:
        law: the material.
        parameters: of the law at the points' temperature.
        temperature: K, of the points at the start; None: the material's first.
        components: stresses of a point, 3 or 6.

    Attributes:
        in_time: CreepLaw, RateLaw, or None for a material that does not depend on time.
    """

    def __init__(self, law: Law, parameters: np.ndarray, temperature: float | None, components: int) -> None:
        self._law, self._temperature, self._components = law, temperature, components
        point_law = law.point_law(temperature)
        self._point_law = with_loop(
            parameters if isinstance(point_law, np.ndarray) else law.parts(parameters), components
        )
        self.in_time = law_in_time(law, parameters)

    def columns(self, back_stress: tuple[str, ...]) -> tuple[str, ...]:
        """Names of what the law adds to the columns of a point's state; `back_stress` names one back stress's."""
        further = tuple(f"{name}_{term}" for term in range(1, self._law.n_terms) for name in back_stress)
        return (CREEP_COLUMNS if self._law.data.creep else ()) + further

    def unstressed(self) -> np.ndarray:
        """The row of an unstressed point, shape (1, columns)."""
        components = self._components
        row = initial_state(self._law, 1, components, self._temperature)
        if self._law.data.creep is None:
            return row
        start = self._law.reference_temperature if self._temperature is None else self._temperature
        own, more = 2 * components + 1, components * max(self._law.n_terms - 1, 0)
        return np.concatenate([row[:, :own], [[start, 0.0]], np.zeros((1, more))], axis=1)

    def held(self) -> "LawOverTime":
        """The law without time whose tangents hold where κ sets in, see `functions.HELD`."""
        held, (address, parts) = copy.copy(self), self._point_law
        plastic = parts.plastic.copy()
        plastic[HELD] = 1.0
        held._point_law = PointLaw(address, parts._replace(plastic=plastic))
        return held

    def over(self, start: Mapping[str, np.ndarray], trial: Mapping[str, np.ndarray]) -> PointLaw:
        """The law from one state to the next; without a `clock` between them it is the law without time.

        To the return mapping, a row with the columns of creep is one with a temperature of its own.
        """
        law = self._while_time_passes(start, trial)
        if law is None:
            return self._point_law
        return with_loop(law.over(start["clock"], trial["clock"]), self._components)

    def growth(self, start: Mapping[str, np.ndarray], trial: Mapping[str, np.ndarray]) -> float:
        """Thermal strain of all points from one state to the next, where the law itself takes it off their strains."""
        law = self._while_time_passes(start, trial)
        if not isinstance(law, CreepLaw) or law.own:
            return 0.0
        return self._law.thermal_strain(*(float(state["clock"][TEMPERATURE]) for state in (start, trial)))

    def _while_time_passes(self, start: Mapping[str, np.ndarray], trial: Mapping[str, np.ndarray]) -> RateLaw | None:
        """The law in time, or None if there is none or no time passes."""
        stands = "clock" not in trial or np.array_equal(start["clock"], trial["clock"])
        return None if stands else self.in_time
