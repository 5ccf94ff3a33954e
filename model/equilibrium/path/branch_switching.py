"""Snap-through: from an unstable state, or beyond the end of a path, to a stable state.

Loads and prescribed values are constant, and a drag slows the spring down, c M (x − x₀) over a step from x₀; the
potential falls in each step, and the path ends only in a state of rest. docs/theory/stability.md derives it, and c.
"""

import logging
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from petsc4py import PETSc

from coilset.model.base.agreement import sum_of_ranks
from coilset.model.equilibrium.newton.newton import Start
from coilset.model.equilibrium.newton.outcome import Outcome
from coilset.model.equilibrium.path.stability import Stability, Weakest
from coilset.model.equilibrium.settings import StepControl
from coilset.model.equilibrium.system.load import Drag, Load

log = logging.getLogger("coilset.steps")
FASTER = 4.0  # maximum factor of a change of drag, and of a step's length over the intended one
FADES = 0.7  # factor of the least drag, by a step: after four, that of the step that failed is tried again
SNAP_ADVANCE = 1.0  # wire radii: distance that a snapping spring moves in its first step against the drag
SNAP_STEPS = 200  # maximum number of these steps until the spring comes to rest
SNAP_FAILURES = 8  # of these steps in a row that may fail or go FASTER times as far
STUCK = 1e-3  # of the intended step: an unstable state that moves less is held by contact


@dataclass
class Descent:
    """Progress of a snap.

    Attributes:
        drag: c of the next step, N/mm.
        origin: x₀ of the next step, over the last equilibrium, of this rank's unknowns.
        weights: M of this rank's unknowns.
        advance: intended length of a step, mm.
        weakest: mode of the last state.
        released: energy dissipated by the drag, N mm.
        drag_force: c M (x − x₀) at the last state.
        moved: length of the last step, mm.
        speed, before: drag times length of the last step and of the one before it, N.
        failed: number of consecutive failed steps.
        least: drag below which a step has lately failed, N/mm; it fades.
    """

    drag: float
    origin: np.ndarray
    weights: np.ndarray
    advance: float
    weakest: Weakest
    drag_force: np.ndarray
    released: float = 0.0
    moved: float = 0.0
    speed: float = 0.0
    before: float = 0.0
    failed: int = 0
    least: float = 0.0

    @property
    def is_stuck(self) -> bool:
        """Whether it hardly moves although it is unstable, and no faster than before."""
        return self.weakest.negative > 0 and self.moved < STUCK * self.advance and self.speed <= self.before

    def adapt(self) -> None:
        """Set the drag for a next step of the right length."""
        self.drag = max(self.drag * float(np.clip(self.moved / self.advance, 1.0 / FASTER, FASTER)), self.least)
        self.least *= FADES
        if self.weakest.negative:
            self.drag = max(self.drag, holding(self.weakest))


def holding(weakest: Weakest) -> float:
    """The drag with which the weakest mode doubles in a step, N/mm."""
    return 2.0 * abs(weakest.value)


def aside(stability: Stability, weakest: Weakest, load: Load, amplitude: float) -> PETSc.Vec:
    """A displacement along the weakest mode of the trial state, towards where the spring came from; collective.

    Args:
        amplitude: of the station that moves most, over the wire's radius.
    """
    system = stability.system
    came, mode = system.increments.getArray(readonly=True), weakest.mode.getArray(readonly=True)
    back = sum_of_ranks(system.comm, (stability.weights(load) * came) @ mode) > 0.0
    displacement = weakest.mode.copy()
    displacement.scale((-amplitude if back else amplitude) * system.line.rod.largest_radius)
    return displacement


class Snap:
    """The path against the drag. Each step is committed: the wire yields along this path, not along a straight one.

    Args:
        solve: solves a load from a start; an equilibrium with too deep penetrations is rejected.
    """

    def __init__(self, stability: Stability, control: StepControl, solve: Callable[[Load, Start], Outcome]) -> None:
        self.stability, self.control, self.solve = stability, control, solve
        self.system = stability.system

    def go(self, load: Callable[[], Load], unstable: PETSc.Vec | None) -> Outcome:
        """Follow the path until a stable state is found; if none is found, the committed steps are kept.

        Args:
            load: the load from the last equilibrium, whichever that is.
            unstable: increments to an unstable equilibrium under this load; None to start from the last equilibrium.

        Returns:
            Outcome of the last solve; its `released` is the energy dissipated by the drag, N mm.
        """
        descent = self._begin(load(), unstable)
        outcome = Outcome(False, "the spring does not come to rest", np.inf)
        for _step in range(SNAP_STEPS):
            outcome = self._descend(load(), descent)
            if outcome.converged:
                if (rest := self._rest(load, descent)) is not None:
                    return rest
                if descent.is_stuck:
                    break
                descent.adapt()
            elif descent.failed > SNAP_FAILURES:
                break
        return replace(outcome, converged=False)

    def _begin(self, load: Load, unstable: PETSc.Vec | None) -> Descent:
        """Start at an unstable equilibrium, displaced along its weakest mode towards where the spring came from; or,
        without one, at the last equilibrium."""
        origin = np.zeros(self.system.layout.size_local)
        if unstable is not None and self.solve(load, Start(unstable)).converged:
            weakest = self.stability.weakest(load)
            origin = aside(self.stability, weakest, load, self.control.branch_amplitude).getArray().copy()
            self.system.commit()
        else:
            self.system.restore()
            weakest = self.stability.weakest(self.stability.iteration.load)
        advance = SNAP_ADVANCE * self.system.line.rod.largest_radius
        weights = self.stability.weights(load)
        return Descent(holding(weakest), origin, weights, advance, weakest, np.zeros_like(origin))

    def _descend(self, load: Load, descent: Descent) -> Outcome:
        """One step against the drag, which is committed; if it fails or goes too far, the drag is increased instead."""
        drag = Drag(descent.drag * descent.weights, descent.origin)
        outcome = self.solve(load.resisted(drag), Start())
        moved = self.stability.greatest_displacement(self.system.increments)
        if not outcome.converged or moved > FASTER * descent.advance:
            self.system.restore()
            descent.failed += 1
            descent.drag *= FASTER
            descent.least = descent.drag
            return replace(outcome, converged=False)
        way = self.system.increments.getArray(readonly=True).copy()
        force = drag.forces(way)
        descent.released += 0.5 * sum_of_ranks(self.system.comm, (descent.drag_force + force) @ way)
        descent.drag_force, descent.origin = force, np.zeros_like(way)
        descent.before, descent.speed = descent.speed, descent.drag * moved
        descent.moved, descent.failed = moved, 0
        descent.weakest = weakest = self.stability.weakest(load)
        self.system.commit()
        log.info(
            "snap: %.3g mm, drag %.2g, %d negative, least eigenvalue %.3g N/mm, %d iterations",
            moved,
            descent.drag,
            weakest.negative,
            weakest.value,
            outcome.iterations,
        )
        return outcome

    def _rest(self, load: Callable[[], Load], descent: Descent) -> Outcome | None:
        """The stable equilibrium nearby, if the drag is small compared with the spring's stiffness; else None."""
        if descent.weakest.negative or descent.drag > descent.weakest.value:
            return None
        aim = load()
        outcome = self.solve(aim, Start())
        near = outcome.converged
        near = near and self.stability.greatest_displacement(self.system.increments) <= 2.0 * descent.moved
        if not near or self.stability.negative_pivots(aim) > 0:
            self.system.restore()
            return None
        self.system.commit()
        way = self.system.state["increments"].equilibrium
        released = descent.released + 0.5 * sum_of_ranks(self.system.comm, descent.drag_force @ way)
        # less than nothing: yielding took up more of the push than the way set free, and nothing drives the spring on
        return replace(outcome, left_branch=True, released=max(released, 0.0))
