"""What a contact carries from one equilibrium to the next: arrays on trial, and as they were last committed."""

import numpy as np
from numpy.typing import ArrayLike


class Memory:
    """Named arrays of a contact.

    A step writes the trial arrays; `commit` keeps them, `restore` goes back, so that a failed step leaves no trace.

    Args:
        arrays: name → values at the start.

    Attributes:
        committed, trial: name → values at the last equilibrium, and at the trial state.
    """

    def __init__(self, **arrays: ArrayLike):
        self.committed: dict[str, np.ndarray] = {name: np.array(values, dtype=float) for name, values in arrays.items()}
        self.restore()

    def commit(self) -> None:
        """Make the trial arrays the committed ones."""
        self.committed = {name: values.copy() for name, values in self.trial.items()}

    def restore(self) -> None:
        """Go back to the committed arrays."""
        self.trial: dict[str, np.ndarray] = {name: values.copy() for name, values in self.committed.items()}

    def __getitem__(self, name: str) -> np.ndarray:
        return self.trial[name]

    def __setitem__(self, name: str, values: np.ndarray) -> None:
        self.trial[name] = values
