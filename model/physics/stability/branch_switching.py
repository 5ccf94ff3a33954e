"""Snap-through: from an unstable state, or beyond the end of a path, to a stable state.

Loads and prescribed values are constant, and a drag slows the spring down, c M (x − x₀) over a step from x₀; the
potential falls in each step, and the path ends only in a state of rest. docs/theory/stability.md derives it, and c.
"""

import logging
import math
import weakref
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from petsc4py import PETSc

from coilset.model.core.base.agreement import sum_of_ranks
from coilset.model.core.equilibrium.newton.newton import Start
from coilset.model.core.equilibrium.newton.outcome import Outcome
from coilset.model.core.equilibrium.path.continuation import Continuation
from coilset.model.core.equilibrium.path.step_sizes import Path
from coilset.model.core.equilibrium.settings import StepControl
from coilset.model.core.equilibrium.system.load import Drag, Load
from coilset.model.physics.stability.stability import Stability, Weakest

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


class Branches:
    """Judges the stability of a continuation's steps, and leaves a path that ends or becomes unstable.

    Args:
        stability: Stability.
        along: the Continuation, to whose steps this belongs.
    """

    def __init__(self, stability: Stability, along: Continuation) -> None:
        self.stability, self.system, self.control = stability, along.system, along.control
        self._along: Continuation = weakref.proxy(along)  # that the end of an analysis frees it at once
        self.begin()

    def begin(self) -> None:
        """A step begins."""
        self._unstable: PETSc.Vec | None = None  # increments of an attempt that ended unstable
        self._unstable_at = 0.0  # its size

    def is_unstable(self, load: Load) -> bool:
        """Whether the last equilibrium, which is evaluated, is less stable under another load; collective."""
        return self.stability.weakest(load).negative > self._along.negative_pivots

    def judged(self, outcome: Outcome, load: Load) -> Outcome:
        """Reject a state that is less stable than the last equilibrium: another path continues from there; collective.

        A stable state near it, on a branch that forks off before it, takes its place.
        """
        negative = self.stability.negative_pivots(load)
        outcome = replace(outcome, negative_pivots=negative)
        if negative <= self._along.negative_pivots:
            return outcome
        self._unstable = self.system.increments.copy()
        beside = self._beside(load) if self._along.steps.position.has_left_branch else None
        if beside is not None:
            return beside
        reason = f"the equilibrium is unstable: {negative} of the tangent's eigenvalues are negative"
        return replace(outcome, converged=False, reason=reason)

    def _beside(self, load: Load) -> Outcome | None:
        """A stable state near the unstable one of the trial state, on a branch that forks off before it; collective.

        It is the continuation of the path, as that of Shanley's column, if it is no farther off than the wire's radius.
        """
        assert self._unstable is not None
        start = self._unstable.copy()
        start.axpy(1.0, aside(self.stability, self.stability.weakest(load), load, self.control.branch_amplitude))
        outcome = self._along.judged(self._along.solve_from(load, Start(start)))
        if not outcome.converged:
            return None
        start.waxpy(-1.0, self._unstable, self.system.increments)
        near = self.stability.greatest_displacement(start) <= self.system.line.rod.largest_radius
        if not near or (negative := self.stability.negative_pivots(load)) > self._along.negative_pivots:
            return None
        return replace(outcome, negative_pivots=negative, left_branch=True)

    def leave(self, path: Path, size: float, failed: Outcome) -> tuple[Outcome, float]:
        """What comes after a step that has failed: a stable state beside the path, if that must be left; collective.

        Returns:
            Its Outcome, and the size of the step that leads there; else those that were given.
        """
        if failed.negative_pivots > self._along.negative_pivots:
            self._unstable_at = size
        if not self._ends_here(path, size, failed):
            return failed, size
        there = size if self._unstable is None else self._unstable_at
        outcome = self._snap(path, self._along.steps.position.done + there)
        self._unstable = None  # once a step
        if not outcome.converged:
            return failed, size
        self._along.steps.begin_patience()
        return outcome, there

    def _ends_here(self, path: Path, size: float, outcome: Outcome) -> bool:
        """Whether the path of a failed step ends, or must be left because it becomes unstable.

        It ends where the step is as short as one may be, or where `patience` is used up.
        """
        ends = self._along.steps.is_last(size) or self._along.steps.stalls(path, self._along.in_vain)
        if self._unstable is None and (not ends or outcome.refused):
            return False
        return ends or self._along.steps.is_near_unstable(size)

    def _snap(self, path: Path, place: float) -> Outcome:
        """Leave a path that ends or becomes unstable, and find a stable state.

        If none is found everything is restored; an unstable state is then kept, with its negative pivots.

        Args:
            path: it.
            place: on it, where to find that state, in regular steps.
        """
        there, load, along = self._unstable, partial(path.load, place), self._along
        before, began = self.system.state.copy(), self.system.evaluations
        outcome = Snap(self.stability, self.control, partial(self._snap_step, began)).go(load, there)
        if outcome.converged:
            free = f"set {outcome.released:.3g} N mm free" if outcome.released else "set no energy free: its path forks"
            log.info("step %d: the spring left its path and %s", along.number + 1, free)
            along.negative_pivots = 0
            if along.step_error is not None:
                along.step_error.restart()
            return outcome
        along.in_vain += self.system.evaluations - began
        self.system.state.put_back(before)
        self.system.restore()
        log.info("step %d: no stable state beside the path was found", along.number + 1)
        return outcome if there is None else self._keep_unstable(load(), there)

    def _keep_unstable(self, load: Load, increments: PETSc.Vec) -> Outcome:
        outcome = self._along.solve(load, (Start(increments),))
        if outcome.converged:
            outcome = replace(outcome, negative_pivots=self.stability.negative_pivots(load))
        return self._along.conclude(load, outcome, 0.0)

    def _snap_step(self, began: int, load: Load, start: Start) -> Outcome:
        """One of a snap, which began after `began` evaluations and may take as many as may be in vain."""
        if self.system.evaluations - began > self.control.patience:
            return Outcome(False, "the program stalls", math.inf)
        return self._along.judged(self._along.solve_from(load, start))
