"""The law of a body's points over a step in which time may pass."""

from collections.abc import Mapping

import numpy as np

from coilset.model.core.material.law.law import Law
from coilset.model.core.material.law.loop import PointLaw
from coilset.model.core.material.point.loops import with_loop
from coilset.model.core.material.point.over_step import LawOverStep
from coilset.model.physics.time.creep.law import CREEP_COLUMNS, TEMPERATURE, CreepLaw, RateLaw


def law_in_time(law: Law, plastic: np.ndarray) -> RateLaw | None:
    """What the material does in time: creep, rate-dependent yield, or nothing."""
    parts = law.parts(plastic)
    if law.data.creep:
        return CreepLaw(law.data.creep, parts, law.is_adiabatic, law.data.rate)
    return RateLaw(law.data.rate, parts) if law.data.rate else None


class LawOverTime(LawOverStep):
    """The law of a material that depends on time; arguments and attributes as of `LawOverStep`."""

    in_time: RateLaw

    def __init__(self, law: Law, parameters: np.ndarray, temperature: float | None, components: int) -> None:
        super().__init__(law, parameters, temperature, components)
        in_time = law_in_time(law, parameters)
        assert in_time is not None, "a material without time has a LawOverStep"
        self.in_time = in_time

    def columns(self, back_stress: tuple[str, ...]) -> tuple[str, ...]:
        """See LawOverStep."""
        return (CREEP_COLUMNS if self._law.data.creep else ()) + super().columns(back_stress)

    def unstressed(self) -> np.ndarray:
        """See LawOverStep."""
        components, row = self._components, super().unstressed()
        if self._law.data.creep is None:
            return row
        start = self._law.reference_temperature if self._temperature is None else self._temperature
        own, more = 2 * components + 1, components * max(self._law.n_terms - 1, 0)
        return np.concatenate([row[:, :own], [[start, 0.0]], np.zeros((1, more))], axis=1)

    def over(self, start: Mapping[str, np.ndarray], trial: Mapping[str, np.ndarray]) -> PointLaw:
        """The law from one state to the next; without a `clock` between them it is the law without time.

        To the return mapping, a row with the columns of creep is one with a temperature of its own.
        """
        if not _passes(start, trial):
            return super().over(start, trial)
        return with_loop(self.in_time.over(start["clock"], trial["clock"]), self._components)

    def growth(self, start: Mapping[str, np.ndarray], trial: Mapping[str, np.ndarray]) -> float:
        """See LawOverStep."""
        if not _passes(start, trial) or not isinstance(self.in_time, CreepLaw) or self.in_time.own:
            return 0.0
        return self._law.thermal_strain(*(float(state["clock"][TEMPERATURE]) for state in (start, trial)))


def _passes(start: Mapping[str, np.ndarray], trial: Mapping[str, np.ndarray]) -> bool:
    """Whether time passes from one state to the next."""
    return "clock" in trial and not np.array_equal(start["clock"], trial["clock"])
