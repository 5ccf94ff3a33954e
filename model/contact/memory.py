"""What a contact carries from one equilibrium to the next: arrays on trial, and as they were last committed."""

import numpy as np


class Memory:
    """Named arrays of a contact.

    A step writes the trial arrays; `commit` keeps them, `restore` goes back, so that a failed step leaves no trace.

    Args:
        arrays: name → values at the start.
    """

    def __init__(self, **arrays):
        self.committed = {name: np.array(values, dtype=float) for name, values in arrays.items()}
        self.restore()

    def commit(self):
        """Make the trial arrays the committed ones."""
        self.committed = {name: values.copy() for name, values in self.trial.items()}

    def restore(self):
        """Go back to the committed arrays."""
        self.trial = {name: values.copy() for name, values in self.committed.items()}

    def __getitem__(self, name):
        return self.trial[name]

    def __setitem__(self, name, values):
        self.trial[name] = values
