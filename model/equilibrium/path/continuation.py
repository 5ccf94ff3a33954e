"""Continuation along a load path: predict, solve, accept or cut; one loop for rods, frames, probes and solids.

A solve ends in one of two ways: its trial state becomes the equilibrium, or the last equilibrium is restored. The steps
of a load program are committed here, the states of a snap-through in `branch_switching`.
"""

import logging
import math
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from typing import TypeVar

from petsc4py import PETSc

from coilset.model.equilibrium.newton.newton import Newton, Start
from coilset.model.equilibrium.newton.outcome import Estimate, Outcome
from coilset.model.equilibrium.path.branch_switching import Snap, aside
from coilset.model.equilibrium.path.guess import Guess
from coilset.model.equilibrium.path.next_touch import CROSSING, NEAR, RESTART, SHORT, NextTouch
from coilset.model.equilibrium.path.stability import Stability
from coilset.model.equilibrium.path.step_error import StepError
from coilset.model.equilibrium.path.step_sizes import Path, StepSizes, tolerates
from coilset.model.equilibrium.settings import StepControl
from coilset.model.equilibrium.system.load import Load

log = logging.getLogger("coilset.steps")
Reading = TypeVar("Reading")
# what the state remembers of the last steps on a path: the guess, and the parabola of the finer path
ELASTIC = 1e-6  # of what a step may bring in: the error of one in which no wire flows is rounding
OF_PATH = "increments", "increments_before", "strain_increment"


class Continuation:
    """Takes a body along paths of loads.

    Args:
        penetration_limit: penetration beyond which a state is rejected, mm.
        starts: starting points for solving a load for a step of the given length, to be tried in order; default: the
            guess of the last steps, then the last equilibrium.
        stability: Stability; None: stability is not checked.
        step_error: StepError; None: the error is unknown, and automatic steps depend on convergence alone.

    Attributes:
        refusal: why the trial state is impossible although forces balance, in words; None if it is possible.
        overshoots: what happens within the step to the trial state and asks for a shorter one, in words; None if
            nothing does.
        cause: what gives way at the last equilibrium, in words.
        steps: StepSizes, which also hold the position on the path.
        number: of steps so far.
        negative_pivots: of the tangent at the last equilibrium; 0 if it is stable.
    """

    def __init__(
        self,
        newton: Newton,
        control: StepControl | None = None,
        penetration_limit: float = math.inf,
        starts: Callable[[Load, float], Iterable[Start]] | None = None,
        stability: Stability | None = None,
        step_error: StepError | None = None,
    ) -> None:
        self.newton, self.system, self.control = newton, newton.system, control or StepControl()
        self.penetration_limit, self.starts = penetration_limit, starts
        self.stability, self.negative_pivots, self.step_error = stability, 0, step_error
        self.refusal: Callable[[], str | None] = lambda: None
        self.overshoots: Callable[[], str | None] = lambda: None
        self.cause: Callable[[], str] = lambda: ""
        self.steps, self.number = StepSizes(self.control), 0
        self.guess = Guess(self.system)
        self.next_touch = NextTouch(self.system)
        self._spent: list[Outcome] = []  # all solves of the step in progress
        self._unstable: PETSc.Vec | None = None  # increments of an attempt that ended unstable
        self._in_vain = 0  # evaluations that found no equilibrium

    # ---- one solve -------------------------------------------------------------------------------------------------

    def attempt(self, load: Load, starts: Iterable[Start] = (Start(),)) -> Outcome:
        """Solve a step; its state becomes the last equilibrium, or everything is restored; collective."""
        self._spent.clear()
        return self._charged(self._attempt(load, starts))

    def _attempt(self, load: Load, starts: Iterable[Start], size: float = 0.0, accurately: bool = False) -> Outcome:
        began = self.system.evaluations
        solved = self._stable(self._solve(load, starts), load)
        judged = self._short_enough(solved, size)
        outcome = self._conclude(load, judged, size, accurately)
        self._in_vain += 0 if outcome.converged or judged is not solved else self.system.evaluations - began
        return outcome

    def _newton(self, load: Load, start: Start) -> Outcome:
        self._spent.append(self.newton.solve(load, start))
        return self._spent[-1]

    def _charged(self, outcome: Outcome) -> Outcome:
        """The outcome of a step, with the cost of all solves since its start."""
        spent = self._spent
        return replace(
            outcome,
            factorisations=sum(solve.factorisations for solve in spent),
            evaluations=sum(solve.evaluations for solve in spent),
            failed_solves=len(spent) - 1 + sum(solve.failed_solves for solve in spent),
        )

    def _conclude(self, load: Load, outcome: Outcome, size: float, accurately: bool = False) -> Outcome:
        """Commit or restore.

        Args:
            load: of the step.
            outcome: of its solution.
            size: length of the step, in regular steps.
            accurately: whether a step with too large an error counts as failed.
        """
        rate = None
        if outcome.converged and self.step_error is not None:
            rate = None if self.step_error.takes_time() else self.newton.rate(load)
            before = self.steps.position.before
            estimate = self.step_error.estimate(size / before if before else 0.0, accurately, rate)
            outcome = self._judged_by(estimate, outcome, size, accurately)
        self.guess.too_far = self.guess.probed = None
        if outcome.converged:
            self.guess.remember(rate if accurately else None)  # equal steps do not depend on estimates
            self.system.commit()
            if self.step_error is not None:
                self.step_error.accept()
            self.negative_pivots = outcome.negative_pivots
        else:
            if outcome.estimate is not None:
                self.guess.too_far = self.system.increments.copy(), size
            self.system.restore()
        return outcome

    def settle(self, load: Load, step: Outcome) -> Outcome:
        """Find equilibrium again where something else than a load has changed the body after a step; collective.

        What is remembered of the path stays that of its steps: the next one does not go on as this goes.

        Args:
            load: keeps what is driven where it is.
            step: Outcome of the step.

        Returns:
            Outcome of both; if it has not converged the state is that before.
        """
        state = self.system.state
        kept = {name: state[name].equilibrium.copy() for name in OF_PATH if name in state}
        found = self.attempt(load)
        if found.converged:
            for name, values in kept.items():
                state[name].equilibrium[:] = state[name].trial[:] = values
        return replace(step + found, estimate=step.estimate, left_branch=step.left_branch, released=step.released)

    def probe(self, load: Load, read: Callable[[], Reading]) -> tuple[Outcome, Reading]:
        """Solve a step, evaluate its state, and return to the last equilibrium; collective.

        The first step then starts in proportion to it.
        """
        outcome = self._solve(load, (Start(),))
        reading = read()
        if outcome.converged:
            self.guess.probed = self.system.increments.copy(), load
        self.system.restore()
        return outcome, reading

    @contextmanager
    def excursion(self) -> Iterator[None]:
        """What happens within leaves the equilibrium before as it was; its path is to be begun anew; collective."""
        before, number, pivots = self.system.state.copy(), self.number, self.negative_pivots
        try:
            yield
        finally:
            self.system.state.put_back(before)
            self.system.attach()
            self.system.restore()
            self.number, self.negative_pivots = number, pivots

    def _solve(self, load: Load, starts: Iterable[Start]) -> Outcome:
        outcome = None
        for start in starts:
            if outcome is not None:
                log.info("step %d: no equilibrium from the last step's direction (%s)", self.number + 1, outcome.reason)
            outcome = self._newton(load, start)
            # stagnation recurs from other starts too, and partial steps lead away from the start: shorten the step
            if outcome.converged or outcome.stagnated or outcome.failed_solves:
                break
        assert outcome is not None
        return self._judged(outcome)

    def _judged(self, outcome: Outcome) -> Outcome:
        """Reject an equilibrium in which bodies penetrate each other deeply."""
        if outcome.converged and (depth := self.system.max_penetration) > self.penetration_limit:
            limit = self.penetration_limit
            reason = (
                f"coils or seats would lie {depth:.4g} mm in each other, more than the {limit:.4g} mm of "
                "contact.penetration_limit; try a stiffer contact.bedding, or a greater limit"
            )
            return replace(outcome, converged=False, reason=reason, refused=True)
        if outcome.converged and (refusal := self.refusal()) is not None:
            return replace(outcome, converged=False, reason=refusal, refused=True)
        return outcome

    def _short_enough(self, outcome: Outcome, size: float) -> Outcome:
        """Reject an equilibrium beyond something that a shorter step shows, as long as a step may be cut for that."""
        if outcome.converged and not self.steps.is_near_unstable(size):
            reason = self.overshoots()
            if reason is not None:
                return replace(outcome, converged=False, reason=reason, refused=True)
        return outcome

    def _judged_by(self, estimate: Estimate, outcome: Outcome, size: float, accurately: bool) -> Outcome:
        """Reject an equilibrium with too large an error, if steps are to be accurate."""
        outcome = replace(outcome, estimate=estimate)
        if not accurately or tolerates(estimate.share, size):
            return outcome
        reason = f"its error is estimated at {estimate.share:.3g} of what a step may have"
        return replace(outcome, converged=False, reason=reason, refused=True)

    # ---- stability -------------------------------------------------------------------------------------------------

    def _stable(self, outcome: Outcome, load: Load) -> Outcome:
        """Reject a state that is less stable than the last equilibrium: another path continues from there."""
        if not outcome.converged or self.stability is None:
            return outcome
        negative = self.stability.negative_pivots(load)
        outcome = replace(outcome, negative_pivots=negative)
        if negative <= self.negative_pivots:
            return outcome
        self._unstable = self.system.increments.copy()
        beside = self._beside(load) if self.steps.position.has_left_branch else None
        if beside is not None:
            return beside
        reason = f"the equilibrium is unstable: {negative} of the tangent's eigenvalues are negative"
        return replace(outcome, converged=False, reason=reason)

    def _beside(self, load: Load) -> Outcome | None:
        """A stable state near the unstable one of the trial state, on a branch that forks off before it; collective.

        It is the continuation of the path, as that of Shanley's column, if it is no farther off than the wire's radius.
        """
        assert self.stability is not None
        assert self._unstable is not None
        start = self._unstable.copy()
        start.axpy(1.0, aside(self.stability, self.stability.weakest(load), load, self.control.branch_amplitude))
        outcome = self._judged(self._newton(load, Start(start)))
        if not outcome.converged:
            return None
        start.waxpy(-1.0, self._unstable, self.system.increments)
        near = self.stability.greatest_displacement(start) <= self.system.line.rod.largest_radius
        if not near or (negative := self.stability.negative_pivots(load)) > self.negative_pivots:
            return None
        return replace(outcome, negative_pivots=negative, left_branch=True)

    def _ends_here(self, path: Path, size: float, outcome: Outcome) -> bool:
        """Whether the path of a failed step ends, or must be left because it becomes unstable.

        It ends where the step is as short as one may be, or where `patience` is used up.
        """
        ends = self.steps.is_last(size) or self.steps.stalls(path, self._in_vain)
        if self.stability is None or (self._unstable is None and (not ends or outcome.refused)):
            return False
        return ends or self.steps.is_near_unstable(size)

    def _snap(self, path: Path, place: float) -> Outcome:
        """Leave a path that ends or becomes unstable, and find a stable state.

        If none is found everything is restored; an unstable state is then kept, with its negative pivots.

        Args:
            path: it.
            place: on it, where to find that state, in regular steps.
        """
        assert self.stability is not None
        there, load = self._unstable, partial(path.load, place)
        before, began = self.system.state.copy(), self.system.evaluations
        outcome = Snap(self.stability, self.control, partial(self._snap_step, began)).go(load, there)
        if outcome.converged:
            free = f"set {outcome.released:.3g} N mm free" if outcome.released else "set no energy free: its path forks"
            log.info("step %d: the spring left its path and %s", self.number + 1, free)
            self.negative_pivots = 0
            if self.step_error is not None:
                self.step_error.restart()
            return outcome
        self._in_vain += self.system.evaluations - began
        self.system.state.put_back(before)
        self.system.restore()
        log.info("step %d: no stable state beside the path was found", self.number + 1)
        return outcome if there is None else self._keep_unstable(load(), there)

    def _keep_unstable(self, load: Load, increments: PETSc.Vec) -> Outcome:
        outcome = self._solve(load, (Start(increments),))
        if outcome.converged and self.stability is not None:
            outcome = replace(outcome, negative_pivots=self.stability.negative_pivots(load))
        return self._conclude(load, outcome, 0.0)

    def _snap_step(self, began: int, load: Load, start: Start) -> Outcome:
        """One of a snap, which began after `began` evaluations and may take as many as may be in vain."""
        if self.system.evaluations - began > self.control.patience:
            return Outcome(False, "the program stalls", math.inf)
        return self._judged(self._newton(load, start))

    def from_last_step(self, load: Load, size: float) -> Iterator[Start]:
        """The guess of the last steps, of the first one of a rotation that by its rate; then the last equilibrium."""
        guess = self.guess.of(load, self.steps.position, size)
        if guess is None and self.guess.carried and (rate := self.newton.first_rate(load)) is not None:
            guess = self.guess.from_rate(rate, load)
        if guess is not None:
            yield Start(guess)
        yield Start()

    # ---- along a path -----------------------------------------------------------------------------------------

    def begin(self) -> None:
        """Go to the start of a path."""
        self.steps.begin()

    def advance(self, path: Path) -> tuple[Outcome, int]:
        """Take one step along a path, cut as often as necessary; collective.

        Returns:
            The step's Outcome, with the cost of failed attempts, and how often it was cut.

        Raises:
            SolveError: if it failed down to the smallest size, or once on a path that gives way, or the program stalls,
                see `StepControl.patience`; the state is that of the last converged step.
        """
        self._spent.clear()
        self._unstable, unstable_at = None, 0.0
        outcome: Outcome | None = None
        while True:
            if self.steps.stalls(path, self._in_vain):
                tried = f"more than {self.control.patience} states were tried in vain within a hundredth of the way"
                raise path.failure(tried, "" if outcome is None else outcome.reason, self.cause())
            begun = self.steps.position
            wanted = self.steps.size(path)
            size = self._to_next_touch(path, wanted) if path.automatic else wanted
            load, length = path.load(begun.done + size), path.step_length(begun.done, size)
            if path.moment is not None:
                self.system.pass_time(path.moment(begun.done + 0.5 * size), path.moment(begun.done + size))
            outcome = self._attempt(load, (self.starts or self.from_last_step)(load, length), length, path.automatic)
            if outcome.negative_pivots > self.negative_pivots:
                unstable_at = size
            if path.gives_way and not (outcome.converged or outcome.refused):
                raise path.failure(outcome.reason)
            # no snaps while time passes: a path that ends there ends the run
            if not outcome.converged and path.moment is None and self._ends_here(path, size, outcome):
                there = size if self._unstable is None else unstable_at
                beside = self._snap(path, begun.done + there)
                if beside.converged:
                    outcome, size = beside, there
                    self.steps.begin_patience()
                self._unstable = None  # once a step
            if outcome.converged:
                self.number += 1
                self.steps.accept(path, outcome, size)
                if size < wanted:
                    self.steps.resize(max(self.steps.position.size, min(RESTART, wanted)))
                return self._charged(outcome), begun.cuts
            self._cut(path, outcome, size)

    def _to_next_touch(self, path: Path, size: float) -> float:
        """Size of a step that ends just before something touches for the first time, or that crosses that; collective.

        It is where the guess shows it. Rotations are no straight path for a guess, and elastic wire needs no such step.
        """
        position = self.steps.position
        if not position.share > ELASTIC:
            return size
        guess = self.guess.along_path(path.load(position.done + size), position, path.step_length(position.done, size))
        if guess is None or self.guess.carried:
            return size
        part = self.next_touch.part(guess)
        if part == 1.0:
            return size
        short = SHORT * part * size
        return short if short > NEAR else min(size, CROSSING)

    def _cut(self, path: Path, outcome: Outcome, size: float) -> None:
        if self.steps.cut(outcome, size):
            log.info(
                "step %d: cut to %.4g of a regular step (%s)", self.number + 1, self.steps.position.size, outcome.reason
            )
        else:
            raise path.failure(outcome.reason, "" if outcome.refused else self.cause())
