"""The thesis's gap element between two given nodes, or a node and a plane (7.1.1, after Hughes)."""

import numpy as np

from coilset.model.contact.base import Contribution, one_sided


class Gaps:
    """One-sided springs between pairs of stations: open beyond the free length, else c times the compression.

    Args:
        pairs: station numbers, shape (m, 2).
        free_length: distance at which the wires touch, the sum of their radii, shape (m,), mm.
        stiffness: c, shape (m,), N/mm.
        onset: way over which contact sets in, mm.
    """

    name, end, points, memory = "gap", None, None, None
    rolls = guarded = False  # gap elements are few: they close and open by the iteration alone, as in the thesis

    def __init__(self, pairs, free_length, stiffness, onset):
        self.pairs = np.asarray(pairs, dtype=np.int64).reshape(-1, 2)
        self.free_length = np.broadcast_to(free_length, len(self.pairs))
        self.stiffness = np.broadcast_to(stiffness, len(self.pairs))
        self.onset = onset
        self.dofs = (3 * self.pairs[:, :, None] + np.arange(3)).reshape(-1, 6)

    def evaluate(self, x, seats):
        """Gap g = |x2 − x1| − free length; the force acts along the connection, with its exact derivative."""
        d = x[self.pairs[:, 1]] - x[self.pairs[:, 0]]
        length = np.linalg.norm(d, axis=1)
        n = d / length[:, None]
        pressure, c = one_sided(length - self.free_length, self.stiffness, self.onset)
        force = -pressure[:, None] * n
        nn = n[:, :, None] * n[:, None, :]
        k = c[:, None, None] * nn - (pressure / length)[:, None, None] * (np.eye(3) - nn)
        penetration = self.free_length - length
        return Contribution(self.dofs, np.hstack([-force, force]), np.block([[k, -k], [-k, k]]), pressure, penetration,
                            np.arange(len(length)))  # fmt: skip


class Stops:
    """One-sided springs between stations and planes; their supports go with the stations along the planes (7.1.2).

    Args:
        stations: station numbers, shape (m,).
        normal: unit vectors out of the planes, shape (m, 3).
        level: the stations touch where normal · x = level, shape (m,), mm.
        stiffness: c, shape (m,), N/mm.
        onset: way over which contact sets in, mm.
    """

    name, end, points, memory = "stop", None, None, None
    rolls = guarded = False

    def __init__(self, stations, normal, level, stiffness, onset):
        self.stations = np.asarray(stations, dtype=np.int64)
        m = len(self.stations)
        self.normal = np.broadcast_to(np.asarray(normal, dtype=float), (m, 3))
        self.level, self.stiffness = np.broadcast_to(level, m), np.broadcast_to(stiffness, m)
        self.onset = onset
        self.dofs = 3 * self.stations[:, None] + np.arange(3)

    def evaluate(self, x, seats):
        """Gap g = n · x − level; the force acts along n."""
        n = self.normal
        gap = np.einsum("mk,mk->m", n, x[self.stations]) - self.level
        pressure, c = one_sided(gap, self.stiffness, self.onset)
        return Contribution(self.dofs, -pressure[:, None] * n, c[:, None, None] * n[:, :, None] * n[:, None, :],
                            pressure, -gap, np.arange(len(gap)))  # fmt: skip
