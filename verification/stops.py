"""The thesis's gap element between a node and a plane (7.1.2), which no case of a spring needs."""

import numpy as np
from numpy.typing import ArrayLike

from coilset.model.core.contact.base import Contact, Contribution, TrialPositions, one_sided


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
