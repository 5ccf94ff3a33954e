"""Wire against two flat seats across the axis z, bedded at the stations (7.1.1)."""

import numpy as np

from coilset.model.contact.base import Contribution, one_sided

CORD = 1e-3  # stiffness of the tips' cords as a share of the bedding's


class Seats:
    """Bottom and top seat: a station's underside that sinks into the seat is pushed out with c times the penetration.

    The two tips hang on cords: when a tip lifts off, it is pulled back with a thousandth of the bedding stiffness, so
    that "zero force" is the one position in which both tips just touch, and the spring cannot float between the seats.

    Args:
        reach: from the wire's axis to its surface at the bottom and the top seat, shape (2, n) or (n,), mm: the wire's
            radius, and less where an end is ground.
        stiffness: c of each station, shape (n,), N/mm.
        onset: way over which contact sets in, mm.
    """

    name = "seat"

    def __init__(self, reach, stiffness, onset):
        n, self.onset = len(stiffness), onset
        self.reach, self.stiffness = np.broadcast_to(reach, (2, n)), np.asarray(stiffness)
        self.cord = np.zeros((2, n))
        self.cord[0, 0], self.cord[1, -1] = CORD * self.stiffness[[0, -1]]
        z = 3 * np.arange(n) + 2
        self.dofs = np.concatenate([np.stack([z, np.full(n, 3 * n + seat)], axis=1) for seat in range(2)])

    def evaluate(self, x, seats):
        """Gap g of the underside, g < 0 where it sinks in; the force acts along the axis."""
        side = np.array([1.0, -1.0])[:, None]  # the wire lies above the bottom seat, below the top seat
        g = side * (x[:, 2] - seats[:, None]) - self.reach
        pressure, c = one_sided(g, self.stiffness, self.onset)
        # the tips bear from the first touch, so that there is a stiffness to begin with, and hang on cords beyond
        tip, closed = self.cord > 0.0, g <= 0.0
        pressure = np.where(tip, np.where(closed, -self.stiffness * g, 0.0), pressure)
        c = np.where(tip, np.where(closed, self.stiffness, self.cord), c)
        force = (side * (self.cord * np.maximum(g, 0.0) - pressure)).ravel()
        c = c.ravel()
        k = np.array([[1.0, -1.0], [-1.0, 1.0]])
        return Contribution(self.dofs, np.stack([force, -force], axis=1), c[:, None, None] * k, pressure.ravel())
