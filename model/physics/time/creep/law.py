"""The constants of creep from a material file, in the form for the kernels of `creep`, and the scaling of time.

Time is scaled with temperature (Orr, Sherby and Dorn, Trans. ASM 46, 1954): an hour at T corresponds to

    exp(−Q/R (1/T − 1/T₀))

hours at the temperature T₀ of the constants. Where plastic work heats the points, each scales its own hours with its
own temperature, which changes between the steps (`rod/heat.py`); by time hardening t^p, as if it had always had it.
"""

import numpy as np

from coilset.model.core.body.body import SECONDS
from coilset.model.core.material.law.functions import RATE
from coilset.model.core.material.law.parts import Parts
from coilset.model.physics.time.creep.entries import Creep, RateDependence
from coilset.model.physics.time.creep.flow import SCALED
from coilset.model.physics.time.creep.forms import FORMS

GAS_CONSTANT = 8.31446261815324  # J/(mol K)
# The clock of a body: hours since the start, temperature (K), and the equivalent hours at T₀.
HOURS, TEMPERATURE, WORTH = range(3)
# What is_resolved asks for. Of an error of third order in the creep strain, equal halves remove three quarters; where
# they remove less than a third of that, it is three times too small. SLOWING is the logarithm of the factor by
# which creep may become slower: up to 1.7, holds in one to six steps tell 0.6 of their error and more, with three
# laws; from 2.0 on some tell a fifth of it, or another sign. Where it becomes slower by STEADY or less there is hardly
# an error, however the halves share the creep.
LEAST_REMOVED, SLOWING, STEADY = 0.25, 1.8, 0.2
CREEP_COLUMNS = ("T", "c")  # what creep adds to a point's state: temperature, K, and equivalent creep strain


class RateLaw:
    """Yield that depends on the rate, see `coilset.model.physics.time.overstress`, and the clock of what takes time.

    Args:
        rate: the checked entries; None: yield does not depend on the rate.
        parts: Parts of the law, `Law.parts()`.
    """

    def __init__(self, rate: RateDependence | None, parts: Parts) -> None:
        self._rate, self._parts = rate, parts

    def _passed(self, hours: float, start: float, end: float) -> float:
        """What passes of the equivalent hours, of which nothing here depends."""
        return 0.0

    def clock(self, hours: float, temperature: float, before: np.ndarray | None = None) -> np.ndarray:
        """The clock, shape (3,), at a time and temperature; the temperature has changed linearly since `before`."""
        if before is None:
            return np.array([hours, temperature, 0.0])
        worth = self._passed(float(hours - before[HOURS]), float(before[TEMPERATURE]), temperature)
        return np.array([hours, temperature, before[WORTH] + worth])

    def is_resolved(self, clocks: tuple[np.ndarray, np.ndarray, np.ndarray], stress: float, fall: float) -> bool:
        """Whether two halves of a step show how wrong the whole one is; arguments as of `CreepLaw.is_resolved`."""
        return True

    def over(self, start: np.ndarray, end: np.ndarray) -> Parts:
        """The law over the time between two clocks."""
        plastic, hours = self._parts.plastic.copy(), float(end[HOURS] - start[HOURS])
        if self._rate and hours > 0.0:
            plastic[RATE] = 1.0 / (self._rate.reference_rate * SECONDS * hours)
        return self._parts._replace(plastic=plastic)


class CreepLaw(RateLaw):
    """Creep of a material.

    Args:
        data: the checked entries.
        parts: Parts of the law, `Law.parts()`.
        own: has each point a temperature of its own? Otherwise all have the clock's.
        rate: entries of yield that depends on the rate, if it does.
    """

    def __init__(self, data: Creep, parts: Parts, own: bool = False, rate: RateDependence | None = None) -> None:
        super().__init__(rate, parts)
        self.data, self.own = data, own
        self._gauss, self._weights = np.polynomial.legendre.leggauss(12)

    def _passed(self, hours: float, start: float, end: float) -> float:
        """Equivalent hours, not yet scaled where each point has a temperature of its own."""
        return hours if self.own else self.worth(hours, start, end)

    def worth(self, hours: float, start: float, end: float) -> float:
        """Equivalent hours at T₀ of hours in which the temperature changes linearly between two values, K."""
        temperatures = start + 0.5 * (1.0 + self._gauss) * (end - start)
        factors = np.exp(
            -self.data.activation_energy / GAS_CONSTANT * (1.0 / temperatures - 1.0 / self.data.temperature)
        )
        return hours * 0.5 * float(self._weights @ factors)

    def over(self, start: np.ndarray, end: np.ndarray) -> Parts:
        """The law over the time between two clocks."""
        data, power = self.data, self.data.time_exponent
        time = float(end[WORTH] - start[WORTH])
        energy = data.activation_energy / GAS_CONSTANT
        if data.hardening == "time":
            time, energy, power = float(end[WORTH] ** power - start[WORTH] ** power), energy * power, 1.0
        energy = energy if self.own else SCALED
        form = [*FORMS].index(data.form)
        speed, exponent = data.strain ** (1.0 / power), data.exponent / power
        viscous = np.array(
            [time, power, form, speed, data.stress, exponent, end[TEMPERATURE], energy, data.temperature]
        )
        return super().over(start, end)._replace(viscous=viscous)

    def strain(self, stress: float, hours: float, temperature: float) -> float:
        """Equivalent creep strain after some hours of constant stress (N/mm²) and temperature (K)."""
        factor, _ = FORMS[self.data.form].factor(stress / self.data.stress)
        return float(
            self.data.strain
            * factor**self.data.exponent
            * self.worth(hours, temperature, temperature) ** self.data.time_exponent
        )

    def is_resolved(self, clocks: tuple[np.ndarray, np.ndarray, np.ndarray], stress: float, fall: float) -> bool:
        """Whether two halves of a step show how wrong the whole one is.

        They do not where one of them has nearly all of the creep, nor where creep becomes much slower in the step. The
        difference is then too small, or has the other sign.

        Args:
            clocks: at the step's start, where the halves meet, and at its end.
            stress: equivalent stress of the most stressed point, N/mm².
            fall: of the logarithm of the stress in the step.
        """
        start, middle, end = (float(clock[WORTH]) ** self.data.time_exponent for clock in clocks)
        first = (middle - start) / (end - start) if end > start else 0.5
        slowing, removed = self._stress_exponent(stress) * fall, 1.0 - first**3 - (1.0 - first) ** 3
        return slowing <= STEADY or (slowing <= SLOWING and removed >= LEAST_REMOVED)

    def _stress_exponent(self, stress: float) -> float:
        """Slope of the logarithm of the creep rate over that of the equivalent stress, N/mm²."""
        data, x = self.data, stress / self.data.stress
        steeper = FORMS[data.form].factor(x)[1] if x > 0.0 else 1.0
        return data.exponent / (1.0 if data.hardening == "time" else data.time_exponent) * steeper
