"""One step to equilibrium: what is tried if it is not found at once, augmentation of contacts, and parts of a step.

A step that contacts stop on its way is balanced roughly at the part of its load that it has reached, and goes on from
there. The law is integrated over the whole step in any case: parts change how a state is found, not the state.
"""

import logging
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from petsc4py import PETSc

from coilset.model.core.equilibrium.newton.contact_limit import ContactLimit
from coilset.model.core.equilibrium.newton.convergence import Reason, reason_in_words
from coilset.model.core.equilibrium.newton.iteration import Iteration
from coilset.model.core.equilibrium.newton.methods import Method
from coilset.model.core.equilibrium.newton.outcome import Outcome
from coilset.model.core.equilibrium.settings import NewtonControl
from coilset.model.core.equilibrium.system.factors import lu
from coilset.model.core.equilibrium.system.load import Load
from coilset.model.core.equilibrium.system.system import System

log = logging.getLogger("coilset.steps")

SMALLEST_PART = 0.1  # of a step, that is solved on the way to the whole; below it, the step is cut
WITHIN_REACH = 1e-2  # of the change of forces: an iteration that ends with less out of balance goes on once
FEW_AUGMENTATIONS, LESS = 5, 0.9  # after so many of them, penetrations are less than this part of what they were


@dataclass(frozen=True)
class Start:
    """Increments to start from, and what it took to find them; None for the last equilibrium."""

    increments: PETSc.Vec | None = None
    iterations: int = 0
    linear_iterations: int = 0


class Newton:
    """Solves a System for the increments of one step.

    Args:
        tolerance: ε of (6.3.1).
        limit: ContactLimit; None: corrections are not limited.
        augmentation_tolerance: tolerance of the augmented Lagrangian loop, mm: contacts that have penetrated
            deeper are pressed harder by as much, and the step is solved again.
        augmented: maximum penetration, mm, that the loop reduces; a state with a deeper one is left as it is.
        prepare: called with PETSc's matrix after each tangent, for preconditioners that are not PETSc's.

    Raises:
        InputError: if PETSc refuses an option.

    Attributes:
        predicts: whether tangents may be built with section forces that a correction predicts, see Body.
        iteration: Iteration.
    """

    def __init__(
        self,
        system: System,
        method: Method,
        tolerance: float,
        control: NewtonControl | None = None,
        limit: ContactLimit | None = None,
        augmentation_tolerance: float = np.inf,
        augmented: float = np.inf,
        prepare: Callable[[PETSc.Mat], object] = lambda matrix: None,
    ) -> None:
        self.system, self.control = system, control or NewtonControl()
        self.augmentation_tolerance, self.augmented = augmentation_tolerance, augmented
        self.limit = limit or ContactLimit(system, np.inf)
        self.predicts = system.body.predicts and self.control.predicted_forces is not False
        self.iteration = Iteration(system, method, tolerance, self.control, self.limit, prepare)

    def solve(self, load: Load, start: Start | None = None) -> Outcome:
        """As `_attempt`; where tangents with predicted section forces fail, again with the actual ones; collective.

        What fails with closed contacts has had the actual ones nearly all the way, and fails again.
        """
        outcome = self._attempt(load, start, self.predicts)
        if outcome.converged or not self.iteration.predicted or self.system.touches:
            return outcome
        return outcome + self._attempt(load, start, False)

    def _attempt(self, load: Load, start: Start | None, predicts: bool) -> Outcome:
        """Solve one step; the system is left at the last iterate; collective.

        Args:
            load: what the step requires.
            start: where to start; from the last equilibrium if None.
            predicts: as in `Iteration.begin`.

        Returns:
            Outcome; its counts are those of all solves where contacts are augmented.
        """
        self.iteration.begin(load, predicts)
        self.system.reset_contacts()
        outcome, depths = self._solve(start or Start()), list[float]()
        while outcome.converged and self.augmentation_tolerance < self.system.max_penetration <= self.augmented:
            depths.append(self.system.max_penetration)
            if self._in_vain(depths):
                reason = (
                    f"a penetration of {depths[-1]:.3g} mm is left after {len(depths) - 1} augmentations, "
                    "so the spring is probably solid"
                )
                return replace(outcome, converged=False, reason=reason)
            self.system.augment()
            outcome = outcome + self._solve(Start(self.system.increments.copy()))
        return outcome

    def rate(self, load: Load) -> PETSc.Vec | None:
        """Derivative of the increments by the load factor at the end of a step, by the last factors; collective.

        None where there are none of the true tangent: other methods, damped corrections, a start that was right.
        """
        iteration, X, layout = self.iteration, self.system.increments, self.system.layout
        if not iteration.has_tangent:
            return None
        change, F, rate = (layout.vector() for _vector in range(3))
        self.system.residual(X, load, 0.0, change)
        self.system.residual(X, load, 1.0, F)
        change.axpy(-1.0, F)
        iteration.snes.getKSP().solve(change, rate)
        return rate if math.isfinite(rate.norm()) else None

    def first_rate(self, load: Load) -> PETSc.Vec | None:
        """Derivative of the increments by the load factor at the start of a step; collective.

        None where the law finds no stress there, or the tangent is singular.
        """
        system, iteration, layout = self.system, self.iteration, self.system.layout
        X, F, rate = (layout.vector() for _vector in range(3))
        system.reset_contacts()
        if not system.evaluate(X):
            return None
        iteration.begin(load, False)
        system.tangent(X, load, iteration.matrix, at_step_start=True)
        system.residual(X, load, 1.0, F)
        factors = lu(iteration.matrix.mat, iteration.matrix.ordering)
        factors.setUp()
        failed = factors.getFailedReason()
        if not failed:
            factors.apply(F, rate)
            rate.scale(-1.0)
        factors.destroy()
        return None if failed or not math.isfinite(rate.norm()) else rate

    def _in_vain(self, depths: Sequence[float]) -> bool:
        """Whether to stop augmenting, from the penetrations before each augmentation, the last one's included.

        Where bodies are solid on each other they do not decrease any more.
        """
        few, made = FEW_AUGMENTATIONS, len(depths) - 1
        return made >= self.control.augmentations or (made >= few and depths[-1] > LESS * depths[-1 - few])

    def _solve(self, start: Start) -> Outcome:
        """As `_attempt`, with the contacts as they are pressed now."""
        system, iteration, evaluations = self.system, self.iteration, self.system.evaluations
        first = iteration.start(start.increments)
        iterations, linear, failed = self._in_parts() if iteration.method.searches else (*iteration.run(1.0), 0)
        reason = iteration.reason
        system.evaluate(system.increments)
        return Outcome(
            converged=reason > 0,
            reason=reason_in_words(reason),
            ratio=iteration.ratio,
            iterations=start.iterations + first + iterations,
            factorisations=iteration.factorisations,
            evaluations=system.evaluations - evaluations,
            linear_iterations=start.linear_iterations + linear,
            failed_solves=failed,
            stagnated=reason in (Reason.DIVERGED_LOCAL_MIN, Reason.DIVERGED_TR_DELTA),
        )

    def _in_parts(self) -> tuple[int, int, int]:
        """Solve the step whole, or balance it roughly on the way where contacts stop it.

        Where no contact, a part would fail just as the whole: the step is to be cut. So it is where the law finds
        no stress, and `touches` is therefore False: a part leads to the same increments, for which there is none. Where
        the iteration crawls, it does so in a part, too.

        Returns:
            Numbers of iterations, of linear ones in them, and of parts that failed.
        """
        iteration, X = self.iteration, self.system.increments
        aim, reached, iterations, linear, failed = 1.0, 0.0, 0, 0, 0
        good: PETSc.Vec | None = None  # at `reached`; None: the last equilibrium
        while True:
            more, more_linear = iteration.run(aim)
            if iteration.reason == Reason.DIVERGED_MAX_IT and iteration.ratio < WITHIN_REACH:
                iterations, linear = iterations + more, linear + more_linear
                more, more_linear = iteration.run(iteration.load_factor)
            iterations, linear, aim = iterations + more, linear + more_linear, iteration.load_factor
            if iteration.reason > 0:
                if aim == 1.0:
                    return iterations, linear, failed
                good, reached, aim = X.copy(), aim, 1.0
            else:
                part = 0.5 * (aim - reached)
                crawls = iteration.reason == Reason.DIVERGED_TR_DELTA
                whole = not self.iteration.load.changes  # a part of it is the same
                if part < SMALLEST_PART or crawls or whole or not self.system.touches:
                    return iterations, linear, failed
                failed += 1
                X.set(0.0) if good is None else good.copy(X)
                self.system.forget_iterate()
                aim = reached + part
                log.info("no equilibrium of the whole step yet: first %.3g of it", aim)
