"""What every kind of contact gives to the problem: forces and stiffness on named degrees of freedom.

Degrees of freedom are numbered independently of the partition: 3 i + k is the displacement k of station i; after
those of the n stations come x, y, z and turns θx, θy, θz of the bottom and of the top seat, 3 n + j, and after these
the stations' turns since the last equilibrium, 3 n + 12 + 3 i + k. Positions of all stations are known on every rank
(they are small), every rank evaluates all contacts, and adds each row where it lives.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from coilset.model.contact.centreline import WirePoints
from coilset.model.contact.memory import Memory

ENDS = ("bottom", "top")
SEAT_DOFS = 6  # x, y, z, θx, θy, θz; see plate.py
LEVEL = 2  # the one along the spring's axis
TOUCH = 1e-6  # N


@dataclass
class Contribution:
    """Forces and stiffness of m contact elements on k degrees of freedom each.

    Attributes:
        dofs: shape (m, k).
        forces: internal forces, the gradient of the contact's potential, shape (m, k), N.
        stiffness: shape (m, k, k), N/mm.
        pressure: compressive force of each element, positive when closed, shape (m,), N.
        penetration: how far the bodies overlap, shape (m,), mm; negative where they do not.
        point: number of each element's point or pair in its kind of contact, shape (m,).
    """

    dofs: np.ndarray
    forces: np.ndarray
    stiffness: np.ndarray
    pressure: np.ndarray
    penetration: np.ndarray
    point: np.ndarray

    @property
    def closed(self):
        """Number of closed elements; what presses by less than TOUCH does so by rounding."""
        return int(np.count_nonzero(self.pressure > TOUCH))


def one_sided(g, c, onset):
    """Compressive force and stiffness of one-sided springs whose contact sets in over a short way.

    Touching surfaces come to bear gradually: with the penetration p = −g the force is c p²/(4w) up to p = 2w and
    c (p − w) beyond. Without such an onset the tangent jumps, and a line search can be caught on the kink.

    Args:
        g: gaps, negative where the bodies overlap, mm.
        c: stiffness, N/mm.
        onset: w, mm.

    Returns:
        Force, positive where the bodies touch, N, and its derivative by p, N/mm.
    """
    within = np.clip(-g, 0.0, 2.0 * onset)
    return c * (within**2 / (4.0 * onset) + np.maximum(-g - 2.0 * onset, 0.0)), c * within / (2.0 * onset)


class Contact(Protocol):
    """A kind of contact; no correction presses a guarded one in deep, and only such a one needs `depth`.

    Attributes:
        name: for labels.
        guarded: see above.
        end: `bottom` or `top` if its forces are those of a seat, else None.
        points: the WirePoints that `Contribution.point` counts, or None; `lengths`, shape (m,), mm, is the wire over
            which each of them bears.
        rolls: does it ask for the turns of the stations since the last equilibrium?
        memory: what it carries from one equilibrium to the next, or None. A kind that has one can be augmented: the
            array `lift` is a way by which each point is pressed although it has not sunk in by it.
    """

    name: str
    guarded: bool
    rolls: bool
    end: str | None
    points: WirePoints | None
    memory: Memory | None

    def depth(self, x: np.ndarray, seats: np.ndarray) -> float:
        """Greatest penetration, mm; 0 where nothing touches."""
        ...

    def evaluate(self, x: np.ndarray, seats: np.ndarray) -> Contribution:
        """Forces and stiffness at station positions `x`, shape (n, 3), mm, and seats, shape (12,), mm and rad.

        A kind that rolls is given the turns as a third argument, shape (n, 3), rad.
        """
        ...

    def augment(self, x: np.ndarray, seats: np.ndarray) -> None:
        """Lift each point by as much more as it has sunk in, so that the next equilibrium needs less penetration."""
        ...
