"""Where on a step something touches that was open: automatic steps end there, and go on from there.

Within a step the law follows a straight path of strains. Where coils close for the first time the path has a kink: wire
that flowed is suddenly unloaded. A step across it is wrong by the force that the wire would gain elastically over the
way to the touch, and its equilibrium is far from any guess. But the guess of a step shows at which part of it a gap
closes. The step is made SHORT of that; from there the guess is so much better that a second, short one ends within
NEAR of the touch, and a third one of size CROSSING goes across it. The rates at its end are those with the contact
closed: the next step may be long again, and its guess shows what touches next.
"""

from collections.abc import Callable

import numpy as np
from petsc4py import PETSc

from coilset.model.core.base.agreement import max_of_ranks
from coilset.model.core.contact.base import Contribution
from coilset.model.core.contact.elements import PAIR
from coilset.model.core.equilibrium.system.system import System

DEEP = 1e-3  # wire diameters: what the guess closes by less is no first touch, but a contact that spreads
SHORT, EXACT = 0.98, 0.002  # of the part; how exactly it is found
NEAR, CROSSING = 2.0**-9, 2.0**-6  # sizes, in regular steps
FIRST = 2.0**-12  # a touch nearer to the start is at it
MARGIN = 0.05  # distance that a trial keeps from both ends of the bracket, as a share of its width


class NextTouch:
    """First touches along guesses."""

    def __init__(self, system: System) -> None:
        self.system = system
        self._limiting = [contact for contact in system.contacts if contact.limits_step]

    def part(self, guess: PETSc.Vec) -> float:
        """Part of a guess up to which nothing closes that is open; 1 if nothing closes deeply at all; collective."""
        if not self._limiting:
            return 1.0
        system, values = self.system, guess.getArray(readonly=True)
        local, moved, rod = system.with_ghosts(values), system.line.extra(values), system.line.rod
        u, turned = local[rod.numbering.u], local[rod.rotation_dofs] if system.touching.need_rotations else None
        x, seats = system.state["x"].equilibrium, system.state["seats"].equilibrium

        def touching(part: float) -> list[Contribution]:
            rotations = None if turned is None else part * turned
            trial = system.touching.trial(x + part * u, seats + part * moved, rotations)
            return [contact.evaluate(trial) for contact in self._limiting]

        after, deep = touching(1.0), DEEP * 2.0 * rod.largest_radius
        if max_of_ranks(system.comm, max(found.deepest for found in after)) <= deep:
            return 1.0
        closed = [sides(found)[found.bears] for found in touching(0.0)]

        def depth(contacts: list[Contribution]) -> float:
            depths = [
                found.penetration[~np.isin(sides(found), before)].max(initial=0.0)
                for found, before in zip(contacts, closed, strict=True)
            ]
            return max_of_ranks(system.comm, max(depths))

        if (end := depth(after)) <= deep:
            return 1.0
        return _first_touch(lambda part: depth(touching(part)), end)


def _first_touch(depth: Callable[[float], float], end: float) -> float:
    """Greatest part found at which the depth is 0 yet; it grows about linearly from there, to `end` at the whole."""
    low, high, part, rise = 0.0, 1.0, 0.5, 0.0
    while high - low > max(EXACT * high, FIRST):
        found = depth(part)
        if found > 0.0:
            rise = (end - found) / (high - part)
            high, end = part, found
        else:
            low = part
        margin, straight = MARGIN * (high - low), high - end / rise if rise > 0.0 else 0.5 * (low + high)
        part = min(max(straight, low + margin), high - margin)
    return low


def sides(found: Contribution) -> np.ndarray:
    """A number for each element, the same wherever its point slides on the same side of the same body."""
    other = min(PAIR // 2, found.dofs.shape[1] - 1)  # first unknown of the other coil
    return 2 * found.point + (found.dofs[:, other] > found.dofs[:, 0])
