"""The thesis's gap element between two given nodes (7.1.1, after Hughes)."""

import numpy as np
from numpy.typing import ArrayLike

from coilset.model.core.base.errors import InputError
from coilset.model.core.contact.base import Contact, Contribution, TrialPositions, one_sided

ASIDE_OF_DIAMETER = 0.1  # nodes of a gap element may be so far beside each other: they meet 0.5 % of a diameter late


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


def gaps_one_turn_apart(
    turns: np.ndarray, radius: np.ndarray, lengths: np.ndarray, bedding: float, onset: float
) -> Gaps:
    """The thesis's gap elements between stations one turn apart.

    Raises:
        InputError: if there are none: elements between others would close too late, or never.
    """
    stiffness = bedding * 0.5 * (np.append(lengths, 0.0) + np.append(0.0, lengths))  # of each station
    lower = np.flatnonzero(turns <= turns[-1] - 1.0 + 1e-9)
    upper = np.searchsorted(turns, turns[lower] + 1.0 - 1e-9)
    upper -= np.abs(turns[upper - 1] - turns[lower] - 1.0) < np.abs(turns[upper] - turns[lower] - 1.0)  # the nearest
    off = np.abs(turns[upper] - turns[lower] - 1.0) * (lengths / np.diff(turns))[lower]
    if np.any(off > ASIDE_OF_DIAMETER * 2.0 * radius[lower]):
        raise InputError(
            f"gaps join nodes one turn apart, but on this mesh the nearest are up to {off.max():.3g} mm "
            "beside them; give a number of elements_per_turn whose product with the turns is whole, or "
            "coils: closest",
            "contact.coils",
        )
    return Gaps(np.stack([lower, upper], axis=1), radius[lower] + radius[upper], stiffness[lower], onset)
