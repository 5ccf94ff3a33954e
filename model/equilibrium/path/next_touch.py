"""Where on a step something touches that was open: automatic steps end there, and go on from there.

Within a step the law follows a straight path of strains. Where coils close for the first time the path has a kink: wire
that flowed is suddenly unloaded. A step across it is wrong by the force that the wire would gain elastically over the
way to the touch, and its equilibrium is far from any guess. But the guess of a step shows at which part of it a gap
closes. The step is made SHORT of that; from there the guess is so much better that a second, short one ends within
NEAR of the touch, and a third one of size CROSSING goes across it. The rates at its end are those with the contact
closed: the next step may be RESTART long again, and its guess shows what touches next.
"""

import numpy as np
from petsc4py import PETSc

from coilset.model.base.agreement import max_of_ranks
from coilset.model.contact.base import Contribution
from coilset.model.contact.elements import PAIR
from coilset.model.equilibrium.system.system import System

DEEP = 1e-3  # wire diameters: what the guess closes by less is no first touch, but a contact that spreads
SHORT = 0.98
NEAR, CROSSING, RESTART = 2.0**-9, 2.0**-6, 0.5  # sizes, in regular steps
BISECTIONS = 12


class NextTouch:
    """First touches along guesses.

    Args:
        system: System.
    """

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
            trial = system.touching.halo.trial(x + part * u, seats + part * moved, rotations)
            return [contact.evaluate(trial) for contact in self._limiting]

        closed = [sides(found)[found.bears] for found in touching(0.0)]

        def depth(part: float) -> float:
            depths = [
                found.penetration[~np.isin(sides(found), before)].max(initial=0.0)
                for found, before in zip(touching(part), closed, strict=True)
            ]
            return max_of_ranks(system.comm, max(depths))

        if depth(1.0) <= DEEP * 2.0 * rod.largest_radius:
            return 1.0
        low, high = 0.0, 1.0
        for _bisection in range(BISECTIONS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if depth(middle) == 0.0 else (low, middle)
        return low


def sides(found: Contribution) -> np.ndarray:
    """A number for each element, the same wherever its point slides on the same side of the same body."""
    other = min(PAIR // 2, found.dofs.shape[1] - 1)  # first unknown of the other coil
    return 2 * found.point + (found.dofs[:, other] > found.dofs[:, 0])
