"""Wire against two flat seats across the axis z, bedded along its underside (7.1.1, Bettung)."""

import numpy as np

from coilset.model.contact.base import Contribution, one_sided

CORD = 1e-3  # stiffness of the tips' cords as a share of the tips' bedding
ABSCISSAE = 0.5 + np.array([-0.5, 0.0, 0.5]) * np.sqrt(0.6)  # Gauss points of an element
WEIGHTS = np.array([5.0, 8.0, 5.0]) / 18.0
SIDE = np.array([[1.0], [-1.0]])  # the wire lies above the bottom seat, below the top seat


class Seats:
    """Bottom and top seat: where the underside sinks into the seat it is pushed out in proportion to the penetration.

    The bedding is integrated along the elements, so that a coil that lies down does so evenly. The two tips are points
    of their own; they bear from the first touch, and hang on cords: a tip that lifts off is pulled back with a
    thousandth of its stiffness, so that "zero force" is the one position in which both tips just touch, and the spring
    cannot float between the seats.

    Args:
        lengths: of the elements, shape (n - 1,), mm.
        reach: distance from the centre line to the underside at both seats, at the tips and at the elements' Gauss
            points: shape (2,) and (2, n - 1, 3), mm.
        bedding: force per length of wire and penetration, N/mm per mm.
        tip: length of wire that bears with the tip, mm.
        onset: way over which contact sets in, mm.
    """

    name = "seats"

    def __init__(self, lengths, reach, bedding, tip, onset):
        n, self.onset = len(lengths) + 1, onset
        self.first = np.concatenate([np.repeat(np.arange(n - 1), 3), [0, n - 2]])
        self.xi = np.concatenate([np.tile(ABSCISSAE, n - 1), [0.0, 1.0]])
        share = bedding * np.concatenate([(lengths[:, None] * WEIGHTS).ravel(), [tip, tip]])
        tips, along = reach
        m = len(self.first)
        self.reach = np.concatenate([along.reshape(2, -1), np.repeat(tips[:, None], 2, axis=1)], axis=1)
        self.cord = np.zeros((2, m))
        self.stiffness = np.tile(share, (2, 1))
        for seat in range(2):  # each seat has its own tip only
            self.cord[seat, m - 2 + seat] = CORD * bedding * tip
            self.stiffness[seat, m - 1 - seat] = 0.0
        z = np.stack([3 * self.first + 2, 3 * self.first + 5], axis=1)
        self.dofs = np.concatenate([np.column_stack([z, np.full(m, 3 * n + seat)]) for seat in range(2)])
        self.length = np.concatenate([(lengths[:, None] * WEIGHTS).ravel(), [0.0, 0.0]])

    def points(self, x):
        """Positions of the centre line at the bedded points, shape (m, 3), mm."""
        return (1.0 - self.xi)[:, None] * x[self.first] + self.xi[:, None] * x[self.first + 1]

    def laws(self, x, seats):
        """Gap, compressive force and stiffness of every point at both seats, each of shape (2, m)."""
        g = SIDE * (self.points(x)[:, 2] - seats[:, None]) - self.reach
        pressure, c = one_sided(g, self.stiffness, self.onset)
        tip, closed = self.cord > 0.0, g <= 0.0
        pressure = np.where(tip, np.where(closed, -self.stiffness * g, 0.0), pressure)
        return g, pressure, np.where(tip, np.where(closed, self.stiffness, self.cord), c)

    def evaluate(self, x, seats):
        """Gap g of the underside, g < 0 where it sinks in; the force acts along the axis."""
        g, pressure, c = self.laws(x, seats)
        force = SIDE * (self.cord * np.maximum(g, 0.0) - pressure)
        bearing = np.flatnonzero(c > 0.0)
        shape = np.column_stack([1.0 - self.xi, self.xi, -np.ones(len(self.xi))])  # of the height over the seat
        shape = np.concatenate([shape, shape])[bearing]
        k = c.ravel()[bearing, None, None] * shape[:, :, None] * shape[:, None, :]
        forces = force.ravel()[bearing, None] * shape
        return Contribution(self.dofs[bearing], forces, k, pressure.ravel()[bearing], -g.ravel()[bearing])
