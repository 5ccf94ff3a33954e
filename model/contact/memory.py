"""Data that a contact carries from one equilibrium to the next: its part of the state."""

from collections.abc import Mapping

import numpy as np

from coilset.model.body.state import State, Where


class Memory:
    """Named arrays of a contact: it writes the trial arrays and also reads those of the last equilibrium.

    Args:
        stations: name → station of each row of that array. The rank of the station knows the row after an evaluation;
            the others may not. Arrays that are not named are known to every rank.
        arrays: name → values at the start, the same on every rank.

    Attributes:
        state: State that holds them.
    """

    def __init__(self, stations: Mapping[str, np.ndarray], **arrays: np.ndarray) -> None:
        self.state, self.stations = State(), dict(stations)
        for name, values in arrays.items():
            self.state.add(name, np.array(values, dtype=float), Where.SHARED)

    def committed(self, name: str) -> np.ndarray:
        """The array at the last equilibrium."""
        return self.state[name].equilibrium

    def __getitem__(self, name: str) -> np.ndarray:
        return self.state[name].trial

    def __setitem__(self, name: str, values: np.ndarray | float) -> None:
        self.state[name].trial[...] = values
