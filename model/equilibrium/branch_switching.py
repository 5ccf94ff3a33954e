"""A spring lets go: from a state that is not stable, or beyond the end of its path, to where it is stable.

Loads and prescribed values stay, and a drag holds the spring back: over a step of time Δt the unknowns x resist with

    c M (x − x₀),    c = 1/Δt,

where x₀ is the state before and M weighs displacements and rotations. That is backward Euler for M ẋ = −r(x). Of all
states it takes the one of least Π(x) + c/2 (x − x₀)·M (x − x₀), so the potential Π falls with each step whatever c is,
and the way ends only where the spring rests. Where the least eigenvalue λ of the tangent is negative c = 2 |λ|: a drag
of less than |λ| would not hold, and with this one the weakest mode doubles in a step. Else c is such that a step moves
the wire by about its radius, and when it is below λ > 0 the state is solved for without drag.
"""

import logging
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from petsc4py import PETSc

from coilset.model.equilibrium.convergence import Outcome
from coilset.model.equilibrium.load import Drag, Load
from coilset.model.equilibrium.newton import Start
from coilset.model.equilibrium.settings import StepControl
from coilset.model.equilibrium.stability import Stability, Weakest

log = logging.getLogger("coilset.steps")
STUCK = 1e-3  # of the way that a step should go: what moves less though it is unstable is held by what it touches


class Snap:
    """The way against the drag. Each step of it is committed: the wire yields along this way, not along a straight one.

    Args:
        stability: Stability.
        control: StepControl.
        solve: solves a load from a start; an equilibrium with too deep penetrations counts as none.
    """

    def __init__(self, stability: Stability, control: StepControl, solve: Callable[[Load, Start], Outcome]) -> None:
        self.stability, self.control, self.solve = stability, control, solve
        self.system = stability.system

    def go(self, load: Callable[[], Load], unstable: PETSc.Vec | None) -> Outcome:
        """Let go until a stable state is found; what is committed on the way is left as it is if none is.

        Args:
            load: the load from the last equilibrium, whichever that is.
            unstable: increments to an unstable equilibrium under this load; None to go from the last equilibrium.

        Returns:
            Outcome of the last solve; its `released` is what the drag took up, N mm.
        """
        begin = self._leave(load(), unstable) if unstable is not None else self._hold()
        weakest, origin = begin
        c, released, failed, before = self._drag(weakest), 0.0, 0, np.zeros(self.system.layout.size_local)
        weights = self.stability.weights(load())
        advance = self.control.snap_advance * self.system.line.rod.largest_radius
        outcome = Outcome(False, "the spring does not come to rest", np.inf)
        for _step in range(self.control.snap_steps):
            aim = load()
            outcome = self.solve(aim.dragged(Drag(c * weights, origin)), Start())
            moved = self.stability.greatest_displacement(self.system.increments)
            if not outcome.converged or moved > 4.0 * advance:
                failed += 1
                self.system.restore()
                if failed > self.control.snap_failures:
                    break
                c *= 4.0
                continue
            failed, way = 0, self.system.increments.getArray(readonly=True).copy()
            now = c * weights * (way - origin)
            released += 0.5 * float(self._sum((before + now) @ way))
            before, origin = now, np.zeros_like(origin)
            weakest = self.stability.weakest(aim)
            self.system.commit()
            log.info("snap: %.3g mm, drag %.2g, %d negative, least eigenvalue %.3g N/mm, %d iterations",
                     moved, c, weakest.negative, weakest.value, outcome.iterations)  # fmt: skip
            if weakest.negative == 0 and c <= weakest.value and (rest := self._rest(load(), moved)) is not None:
                way = self.system.state["increments"].equilibrium
                return replace(rest, left_branch=True, released=released + 0.5 * float(self._sum(before @ way)))
            if weakest.negative and moved < STUCK * advance:
                break
            c *= float(np.clip(moved / advance, 0.25, 4.0))
            if weakest.negative:
                c = max(c, self._drag(weakest))
        return replace(outcome, converged=False)

    def _drag(self, weakest: Weakest) -> float:
        return 2.0 * abs(weakest.value)

    def _hold(self) -> tuple[Weakest, np.ndarray]:
        """Begin at the last equilibrium."""
        self.system.restore()
        return self.stability.weakest(self.stability.newton.load), np.zeros(self.system.layout.size_local)

    def _leave(self, load: Load, unstable: PETSc.Vec) -> tuple[Weakest, np.ndarray]:
        """Begin at an unstable equilibrium, pushed along its weakest mode to the side from which the spring came."""
        self.solve(load, Start(unstable))
        weakest = self.stability.weakest(load)
        weights = self.stability.weights(load)
        came = self.system.increments.getArray(readonly=True)
        mode = weakest.mode.getArray(readonly=True)
        side = -1.0 if self._sum((weights * came) @ mode) > 0.0 else 1.0
        amplitude = self.control.branch_amplitude * self.system.line.rod.largest_radius
        self.system.commit()
        return weakest, side * amplitude * mode

    def _rest(self, load: Load, moved: float) -> Outcome | None:
        """The stable equilibrium near by, or None."""
        outcome = self.solve(load, Start())
        near = outcome.converged and self.stability.greatest_displacement(self.system.increments) <= 2.0 * moved
        if near and self.stability.negative_pivots(load) == 0:
            self.system.commit()
            return outcome
        self.system.restore()
        return None

    def _sum(self, value: float) -> float:
        comm = self.system.comm
        return comm.allreduce(float(value)) if comm.size > 1 else float(value)
