"""The law of a material whose yield depends on the rate, over a step that takes time; see `perzyna`."""

import numpy as np

from coilset.model.material.creep.law import HOURS, CreepLaw
from coilset.model.material.law.file import RateDependence
from coilset.model.material.law.functions import RATE
from coilset.model.material.law.law import Law

SECONDS = 3600.0  # of an hour


class RateLaw:
    """Yield of a material in time.

    Args:
        data: the checked entries.
        plastic: parameter array of the law, `Law.parameters()`.
    """

    def __init__(self, data: RateDependence, plastic: np.ndarray) -> None:
        self.data, self._plastic = data, plastic

    def clock(self, hours: float, temperature: float, before: np.ndarray | None = None) -> np.ndarray:
        """The clock, shape (3,), as `CreepLaw.clock`; temperature has no effect on the rate."""
        return np.array([hours, temperature, 0.0])

    def over(self, start: np.ndarray, end: np.ndarray) -> np.ndarray:
        """The parameter array over the time between two clocks."""
        plastic = self._plastic.copy()
        plastic[RATE] = 1.0 / (self.data.reference_rate * SECONDS * (end[HOURS] - start[HOURS]))
        return plastic


def law_in_time(law: Law, plastic: np.ndarray) -> CreepLaw | RateLaw | None:
    """What the material does in time: creep, rate-dependent yield, or nothing."""
    if law.creep:
        return CreepLaw(law.creep, plastic, law.is_adiabatic)
    return RateLaw(law.data.rate, plastic) if law.data.rate else None
