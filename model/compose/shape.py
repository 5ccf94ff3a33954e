"""Checks of a compressed spring's shape: has it left a seat, have coils slipped past each other?"""

import numpy as np

from coilset.meshes.springs.ends import touching_pitch
from coilset.meshes.springs.geometry import Spring
from coilset.model.core.contact.seat import Seat
from coilset.model.core.equilibrium.system.system import System

PASSING = 0.5  # of the wire diameter: with a smaller touching pitch, coils pass each other by their shape


def clearance(system: System, x: np.ndarray) -> float:
    """Maximum distance between a seat and the wire, mm; 0 where both touch, or there are none.

    Args:
        system: System.
        x: station positions, shape (n, 3), mm.
    """
    seats = [contact for contact in system.contacts if isinstance(contact, Seat)]
    return max((float(seat.gaps(seat.points.at(x), system.seats).min()) for seat in seats), default=0.0)


class LeastRise:
    """Smallest rise of the wire over one turn, relative to the rise at which adjacent coils touch: 1 at block.

    Contact cannot hold a coil that has slipped sideways past the next one; the value then falls far below 1, and
    below 0 once it has passed.

    Args:
        turns: of the stations, shape (n,).
        spring: the stress-free spring.
    """

    def __init__(self, turns: np.ndarray, spring: Spring) -> None:
        lower = turns[(turns >= 0.0) & (turns <= spring.turns - 1.0)]
        diameter = 0.5 * (spring.wire_diameter(lower) + spring.wire_diameter(lower + 1.0))
        aside = spring.aside(lower, lower + 1.0)
        touching = touching_pitch(diameter, aside, spring.section)
        lies = touching > PASSING * diameter
        self._turns, self._lower, self._touching = turns, lower[lies], touching[lies]

    def of(self, x: np.ndarray) -> float | None:
        """At station positions `x`, shape (n, 3), mm; None unless there are two coils, one above the other."""
        if not len(self._lower):
            return None
        above, below = (np.interp(self._lower + turn, self._turns, x[:, 2]) for turn in (1.0, 0.0))
        return float(((above - below) / self._touching).min())
