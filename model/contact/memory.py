"""Data that a contact carries from one equilibrium to the next: its part of the state."""

import numpy as np

from coilset.model.state import State, Where


class Memory:
    """Named arrays of a contact: it writes the trial arrays and also reads those of the last equilibrium.

    Args:
        arrays: name → values at the start, the same on every rank.

    Attributes:
        state: State that holds them.
    """

    def __init__(self, **arrays: np.ndarray) -> None:
        self.state = State()
        for name, values in arrays.items():
            self.state.add(name, np.array(values, dtype=float), Where.SHARED)

    def committed(self, name: str) -> np.ndarray:
        """The array at the last equilibrium."""
        return self.state[name].equilibrium

    def __getitem__(self, name: str) -> np.ndarray:
        return self.state[name].trial

    def __setitem__(self, name: str, values: np.ndarray) -> None:
        self.state[name].trial[...] = values
