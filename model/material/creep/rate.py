"""The law of a material that creeps, or whose yield depends on the rate, over a step that takes time."""

import numpy as np

from coilset.model.material.creep.law import HOURS, CreepLaw, at_rate
from coilset.model.material.law.file import RateDependence
from coilset.model.material.law.law import Law
from coilset.model.material.law.parts import Parts


class RateLaw:
    """Yield that depends on the rate, see `coilset.model.material.point.overstress`.

    Args:
        data: the checked entries.
        parts: Parts of the law, `Law.parts()`.
    """

    def __init__(self, data: RateDependence, parts: Parts) -> None:
        self.data, self._parts = data, parts

    def clock(self, hours: float, temperature: float, before: np.ndarray | None = None) -> np.ndarray:
        """The clock, shape (3,), as `CreepLaw.clock`; temperature has no effect on the rate."""
        return np.array([hours, temperature, 0.0])

    def over(self, start: np.ndarray, end: np.ndarray) -> Parts:
        """The law over the time between two clocks."""
        plastic = at_rate(self.data, self._parts.plastic, float(end[HOURS] - start[HOURS]))
        return self._parts._replace(plastic=plastic)


def law_in_time(law: Law, plastic: np.ndarray) -> CreepLaw | RateLaw | None:
    """What the material does in time: creep, rate-dependent yield, or nothing."""
    parts = law.parts(plastic)
    if law.creep:
        return CreepLaw(law.creep, parts, law.is_adiabatic, law.data.rate)
    return RateLaw(law.data.rate, parts) if law.data.rate else None
