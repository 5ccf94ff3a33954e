"""The thesis's gap element between two given nodes, or a node and a plane (7.1.1, after Hughes)."""

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


class Stops(Contact):
    """One-sided springs between stations and planes; their supports go with the stations along the planes (7.1.2).

    Args:
        stations: station numbers, shape (m,).
        normal: unit vectors out of the planes, shape (m, 3).
        level: the stations touch where normal · x = level, shape (m,), mm.
        stiffness: c, shape (m,), N/mm.
        onset: distance over which contact sets in, mm.
    """

    name = "stop"

    def __init__(self, stations: ArrayLike, normal: ArrayLike, level: ArrayLike, stiffness: ArrayLike, onset: float):
        self.stations = np.asarray(stations, dtype=np.int64)
        m = len(self.stations)
        self.normal = np.broadcast_to(np.asarray(normal, dtype=float), (m, 3))
        self.level, self.stiffness = np.broadcast_to(level, m), np.broadcast_to(stiffness, m)
        self.onset = onset
        self.dofs = 3 * self.stations[:, None] + np.arange(3)

    def evaluate(self, trial: TrialPositions) -> Contribution:
        """Gap g = n · x − level; the force acts along n."""
        n = self.normal
        gap = np.einsum("mk,mk->m", n, trial.x[self.stations]) - self.level
        pressure, c = one_sided(gap, self.stiffness, self.onset)
        return Contribution(
            self.dofs,
            -pressure[:, None] * n,
            c[:, None, None] * n[:, :, None] * n[:, None, :],
            pressure,
            -gap,
            np.arange(len(gap)),
            self.stiffness * self.onset,
        )
