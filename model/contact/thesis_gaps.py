"""The thesis's gap element between two given nodes (7.1.1, after Hughes)."""

import numpy as np
from numpy.typing import ArrayLike

from coilset.model.contact.base import Contact, Contribution, TrialPositions, one_sided


class Gaps(Contact):
    """One-sided springs between pairs of stations: open beyond the free length, else c times the compression.

    Args:
        pairs: station numbers, shape (m, 2).
        free_length: distance at which the wires touch, the sum of their radii, shape (m,), mm.
        stiffness: c, shape (m,), N/mm.
        onset: distance over which contact sets in, mm.
    """

    # gap elements are few: they do not limit steps, but open and close in the iteration alone, as in the thesis
    name = "gap"

    def __init__(self, pairs: ArrayLike, free_length: ArrayLike, stiffness: ArrayLike, onset: float):
        self.pairs = np.asarray(pairs, dtype=np.int64).reshape(-1, 2)
        self.free_length = np.broadcast_to(free_length, len(self.pairs))
        self.stiffness = np.broadcast_to(stiffness, len(self.pairs))
        self.onset = onset
        self.dofs = (3 * self.pairs[:, :, None] + np.arange(3)).reshape(-1, 6)

    def evaluate(self, trial: TrialPositions) -> Contribution:
        """Gap g = |x2 − x1| − free length; the force acts along the connection, with its exact derivative."""
        d = trial.x[self.pairs[:, 1]] - trial.x[self.pairs[:, 0]]
        length = np.linalg.norm(d, axis=1)
        n = d / length[:, None]
        pressure, c = one_sided(length - self.free_length, self.stiffness, self.onset)
        force = -pressure[:, None] * n
        nn = n[:, :, None] * n[:, None, :]
        k = c[:, None, None] * nn - (pressure / length)[:, None, None] * (np.eye(3) - nn)
        penetration = self.free_length - length
        return Contribution(
            self.dofs,
            np.hstack([-force, force]),
            np.block([[k, -k], [-k, k]]),
            pressure,
            penetration,
            np.arange(len(length)),
            self.stiffness * self.onset,
        )
