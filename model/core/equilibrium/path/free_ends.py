"""The finished spring: what is left of a released one when nothing holds it any more.

A release to zero force lets go of the axial force only. Tips stay held sideways and against rotation, so that a spring
that has set keeps bending and turning moments in its wire. Beside the path of the load program the ends are let go as
well: seats, guides and heads are taken away, and the forces and moments of held tips are reduced to zero. The bottom
tip alone stays where it is; it holds the spring without a force, as nothing else acts on it from outside.

Plates that measure a spring rest on its end coils. Held by its bottom tip alone it leans, so it is turned as a rigid
body until its end coils lie on average as they lay between the heads: its length is that across planes parallel to
these.
"""

import logging
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from coilset.model.core.base.errors import SolveError
from coilset.model.core.equilibrium.path.continuation import Continuation
from coilset.model.core.equilibrium.path.step_sizes import Path
from coilset.model.core.equilibrium.system.heads import Heads
from coilset.model.core.rotations.vectors import nearest_vector

log = logging.getLogger("coilset.steps")
STEPS = 2  # equal ones in which the ends are let go
POINTS = 25  # of an end coil that show how it lies
END_COIL = 0.75  # turn of wire at an end on which a plate rests: as much as is usually ground


class Change(NamedTuple):
    """What letting go of the ends has changed.

    Attributes:
        rise: from the bottom tip's point to the top one's along the axis, mm.
        turn: of the top tip about the axis, less that of the bottom one, rad.
    """

    rise: float
    turn: float


class FreeEnds:
    """Lets go of a spring's ends, within an excursion from its path.

    Args:
        control: Heads of the spring.
        continuation: of its load program.
        turns: of the stations, shape (n,), from 0 on along the coil, which has so many `coils`.
    """

    def __init__(self, control: Heads, continuation: Continuation, turns: np.ndarray, coils: float) -> None:
        self.control, self.continuation, self.system = control, continuation, control.system
        self._turns, part = turns, np.linspace(0.0, min(END_COIL, coils), POINTS)
        self._ends = part, coils - part

    def let_go(self) -> Change:
        """Go to the spring that nothing holds, in its place; its contacts with others stay off; collective.

        Raises:
            SolveError: if it finds no equilibrium.
        """
        control = self.control
        before, triads, forces = self._positions(), control.tip_triads(), control.tip_forces()
        rested = [self._end_coil(before, end) for end in self._ends]
        self.system.detach()
        continuation = self.continuation
        continuation.begin()
        path = Path(lambda done: control.let_go(forces, 1.0 - done / STEPS), STEPS, "the free spring")
        while continuation.steps.position.done < STEPS:
            continuation.advance(path)
        after = self._positions()
        rests = [self._end_coil(after, end) for end in self._ends]
        self._move(mean_rotation([nearest_rotation(now, then) for now, then in zip(rests, rested, strict=True)]))
        bottom, top = (
            nearest_vector(now @ then.T, np.zeros(3))[2] for now, then in zip(control.tip_triads(), triads, strict=True)
        )
        rise = np.diff(self._positions()[control.held_stations, 2] - before[control.held_stations, 2])
        return Change(float(rise[0]), float(top - bottom))

    def stand(self, lowest: float, height: float) -> None:
        """Put the free spring between seats that just touch it; collective.

        Args:
            lowest: of its points above the bottom seat, mm; height: of the spring, mm.

        Raises:
            SolveError: if it finds no equilibrium.
        """
        self._move(np.eye(3), -lowest, height - self.control.height)
        self.system.attach()

    def _move(self, R: np.ndarray, lift: float = 0.0, seat: float = 0.0) -> None:
        """Turn the free spring about its bottom tip and lift it as a rigid body, and the top seat, mm; collective."""
        outcome = self.continuation.attempt(self.control.carry(R, lift, seat))
        if not outcome.converged:
            raise SolveError(f"the free spring finds no equilibrium in its place: {outcome.reason}")

    def _positions(self) -> np.ndarray:
        """Positions of all stations at the last equilibrium, shape (n, 3), mm; collective."""
        return self.control.layout.gather(self.system.state["x"].equilibrium)

    def _end_coil(self, x: np.ndarray, turns: np.ndarray) -> np.ndarray:
        """Points of an end coil, the same on any mesh, stations at `x`, shape (POINTS, 3), mm."""
        return np.stack([np.interp(turns, self._turns, component) for component in x.T], axis=1)


def nearest_rotation(x: np.ndarray, to: np.ndarray) -> np.ndarray:
    """The rotation that brings points nearest to others in the mean square, both about their centres, shape (3, 3).

    W. Kabsch, Acta Cryst. A 32 (1976) 922.

    Args:
        x, to: both sets, shape (n, 3), mm.
    """
    return _rotation((to - to.mean(axis=0)).T @ (x - x.mean(axis=0)))


def mean_rotation(rotations: Sequence[np.ndarray]) -> np.ndarray:
    """The rotation nearest to several, in the mean square of their entries, shape (3, 3)."""
    return _rotation(np.sum(rotations, axis=0))


def _rotation(A: np.ndarray) -> np.ndarray:
    """The rotation nearest to a matrix: of its polar decomposition, without a mirror."""
    U, _, V = np.linalg.svd(A)
    return np.asarray(U @ np.diag([1.0, 1.0, np.sign(np.linalg.det(U @ V))]) @ V)
