"""Limit of a correction, so that coils and seats do not penetrate each other deeply.

A correction that presses bodies deeply into each other makes the wire yield, which the next correction cannot undo.
Penetrations up to a few hundredths of the wire diameter are therefore free; deeper ones may grow only by a factor.
"""

import numpy as np
from petsc4py import PETSc

from coilset.model.core.equilibrium.system.system import System

PENETRATION_GROWTH = 1.5  # factor by which one correction may increase a penetration that is deeper than the free one
SMALLEST_CONTACT_STEP = 0.02  # share of a correction that is made whatever it does to the contacts
CONTACT_BISECTIONS = 6  # to find the share of a correction that the contacts allow


class ContactLimit:
    """The limit for a system.

    Args:
        system: System.
        free: penetration up to which a correction may press, mm.
    """

    def __init__(self, system: System, free: float) -> None:
        self.system, self.free = system, free
        self.limiting = [contact for contact in system.contacts if contact.limits_step]

    def allowed(self, penetration: float) -> float:
        """Penetration up to which a correction may press, from a state with `penetration`, mm."""
        return max(self.free, PENETRATION_GROWTH * penetration)

    def step_length(self, start: PETSc.Vec, direction: PETSc.Vec, sign: float = 1.0) -> float:
        """Largest λ ≤ 1 up to which start + λ · sign · direction presses no deeper than allowed; collective."""
        system = self.system
        if not self.limiting:
            return 1.0
        x, seats = self._moves(start)
        u, moved = (sign * part for part in self._moves(direction))
        x, seats = system.state["x"].equilibrium + x, system.state["seats"].equilibrium + seats

        def penetration(length: float) -> float:
            return system.touching.max_penetration(x + length * u, seats + length * moved)

        allowed = self.allowed(penetration(0.0))
        if penetration(1.0) <= allowed:
            return 1.0
        low, high = SMALLEST_CONTACT_STEP, 1.0
        for _bisection in range(CONTACT_BISECTIONS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if penetration(middle) <= allowed else (low, middle)
        return low

    def _moves(self, increments: PETSc.Vec) -> tuple[np.ndarray, np.ndarray]:
        """Displacements of the local nodes and of both seats; collective."""
        line, values = self.system.line, increments.getArray(readonly=True)
        return self.system.with_ghosts(values)[line.rod.numbering.u], line.extra(values)

    def limit_start(self, guess: PETSc.Vec, start: PETSc.Vec) -> None:
        """Write into `start` as much of the guess as the contacts allow from the last equilibrium; collective."""
        guess.copy(start)
        self.system.evaluate(start)
        if self.system.max_penetration > self.allowed(0.0):
            start.set(0.0)
            length = self.step_length(start, guess)
            guess.copy(start)
            start.scale(length)
