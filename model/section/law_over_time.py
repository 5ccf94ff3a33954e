"""The law of a section's points over a step: without time or with it."""

from collections.abc import Mapping

import numpy as np

from coilset.model.material.creep import Creeping
from coilset.model.material.creep_law import CREEP_COLUMNS, CreepLaw
from coilset.model.material.law import Law
from coilset.model.material.points import initial_state


class LawOverTime:
    """What the compiled loops over the points take as their law.

    Args:
        law: the material.
        parameters: of the law at the points' temperature.
        temperature: K, of the points at the start; None: the material's first.

    Attributes:
        creep: CreepLaw, or None for a material that does not creep.
        columns: names of what creep adds to a point's state.
    """

    def __init__(self, law: Law, parameters: np.ndarray, temperature: float | None) -> None:
        self._law, self._parameters, self._temperature = law, parameters, temperature
        self.creep = CreepLaw(law.creep, parameters) if law.creep else None
        self.columns = CREEP_COLUMNS if self.creep else ()

    def unstressed(self, components: int) -> np.ndarray:
        """The row of an unstressed point of 3 or 6 stresses, shape (1, columns)."""
        row = initial_state(self._law, 1, components, self._temperature)
        if self.creep is None:
            return row
        start = self._law.reference_temperature if self._temperature is None else self._temperature
        return np.append(row, [[start, 0.0]], axis=1)

    def over(self, start: Mapping[str, np.ndarray], trial: Mapping[str, np.ndarray]) -> np.ndarray | Creeping:
        """The law from one state to the other; where no `clock` goes between them it is the law without time.

        A row with the columns of creep is one of the law with a temperature of its own, which the return mapping takes
        as it is.
        """
        if self.creep is None or "clock" not in trial or np.array_equal(start["clock"], trial["clock"]):
            return self._parameters
        return self.creep.over(start["clock"], trial["clock"])
