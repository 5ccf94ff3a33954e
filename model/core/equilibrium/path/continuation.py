"""Continuation along a load path: predict, solve, accept or cut; one loop for rods, frames, probes and solids.

A solve ends in one of two ways: its trial state becomes the equilibrium, or the last equilibrium is restored. The
estimate of a step's error and the departure from an unstable path are passed in.
"""

import logging
import math
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any, TypeVar

from coilset.model.core.equilibrium.newton.newton import Newton, Start
from coilset.model.core.equilibrium.newton.outcome import Estimate, Outcome
from coilset.model.core.equilibrium.path.guess import Guess
from coilset.model.core.equilibrium.path.step_sizes import Path, StepSizes, tolerates
from coilset.model.core.equilibrium.settings import StepControl
from coilset.model.core.equilibrium.system.load import Load

log = logging.getLogger("coilset.steps")
Reading = TypeVar("Reading")
# what the state remembers of the last steps on a path: the guess, and the parabola of the finer path
OF_PATH = "increments", "increments_before", "strain_increment"


class Continuation:
    """Takes a body along paths of loads.

    Args:
        penetration_limit: penetration beyond which a state is rejected, mm.
        starts: starting points for solving a load for a step of the given length, to be tried in order; default: the
            guess of the last steps, then the last equilibrium.
        branches: makes of this the Branches that judge stability and leave unstable paths; None: nothing does.
        step_error: StepError; None: the error is unknown, and automatic steps depend on convergence alone.

    Attributes:
        refusal: why the trial state is impossible although forces balance, in words; None if it is possible.
        overshoots: what happens within the step to the trial state and asks for a shorter one, in words; None if
            nothing does.
        cause: what gives way at the last equilibrium, in words.
        steps: StepSizes, which also hold the position on the path.
        number: of steps so far; in_vain: evaluations that found no equilibrium.
        negative_pivots: of the tangent at the last equilibrium; 0 if it is stable.
    """

    def __init__(
        self,
        newton: Newton,
        control: StepControl | None = None,
        penetration_limit: float = math.inf,
        starts: Callable[[Load, float], Iterable[Start]] | None = None,
        branches: Callable[["Continuation"], Any] | None = None,
        step_error: Any = None,
    ) -> None:
        self.newton, self.system, self.control = newton, newton.system, control or StepControl()
        self.penetration_limit, self.starts = penetration_limit, starts
        self.negative_pivots, self.step_error = 0, step_error
        self.refusal: Callable[[], str | None] = lambda: None
        self.overshoots: Callable[[], str | None] = lambda: None
        self.cause: Callable[[], str] = lambda: ""
        self.steps, self.number, self.in_vain = StepSizes(self.control), 0, 0
        self.guess = Guess(self.system)
        self._spent: list[Outcome] = []  # all solves of the step in progress
        self.branches = None if branches is None else branches(self)

    # ---- one solve -------------------------------------------------------------------------------------------------

    def attempt(self, load: Load, starts: Iterable[Start] = (Start(),)) -> Outcome:
        """Solve a step; its state becomes the last equilibrium, or everything is restored; collective."""
        self._spent.clear()
        return self._charged(self._attempt(load, starts))

    def _attempt(self, load: Load, starts: Iterable[Start], size: float = 0.0, accurately: bool = False) -> Outcome:
        began = self.system.evaluations
        solved = self.solve(load, starts)
        if solved.converged and self.branches is not None:
            solved = self.branches.judged(solved, load)
        judged = self._short_enough(solved, size)
        outcome = self.conclude(load, judged, size, accurately)
        self.in_vain += 0 if outcome.converged or judged is not solved else self.system.evaluations - began
        return outcome

    def solve_from(self, load: Load, start: Start) -> Outcome:
        """Solve a load from one start; collective."""
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

    def conclude(self, load: Load, outcome: Outcome, size: float, accurately: bool = False) -> Outcome:
        """Commit or restore; collective.

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
        outcome = self.solve(load, (Start(),))
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

    def solve(self, load: Load, starts: Iterable[Start]) -> Outcome:
        """Solve a load from several starts until one leads to a possible state; collective."""
        outcome = None
        for start in starts:
            if outcome is not None:
                log.info("step %d: no equilibrium from the last step's direction (%s)", self.number + 1, outcome.reason)
            outcome = self.solve_from(load, start)
            # stagnation recurs from other starts too, and partial steps lead away from the start: shorten the step
            if outcome.converged or outcome.stagnated or outcome.failed_solves:
                break
        assert outcome is not None
        return self.judged(outcome)

    def judged(self, outcome: Outcome) -> Outcome:
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
        if self.branches is not None:
            self.branches.begin()
        outcome: Outcome | None = None
        while True:
            if self.steps.stalls(path, self.in_vain):
                tried = f"more than {self.control.patience} states were tried in vain within a hundredth of the way"
                raise path.failure(tried, "" if outcome is None else outcome.reason, self.cause())
            begun = self.steps.position
            wanted = self.steps.size(path)
            size = wanted
            if path.automatic and self.step_error is not None:
                size = self.step_error.to_next_touch(self.guess, path, begun, wanted)
            load, length = path.load(begun.done + size), path.step_length(begun.done, size)
            if path.moment is not None:
                self.system.pass_time(path.moment(begun.done + 0.5 * size), path.moment(begun.done + size))
            outcome = self._attempt(load, (self.starts or self.from_last_step)(load, length), length, path.automatic)
            if path.gives_way and not (outcome.converged or outcome.refused):
                raise path.failure(outcome.reason)
            # no snaps while time passes: a path that ends there ends the run
            if not outcome.converged and path.moment is None and self.branches is not None:
                outcome, size = self.branches.leave(path, size, outcome)
            if outcome.converged:
                self.number += 1
                self.steps.accept(path, outcome, size)
                if size < wanted:
                    self.steps.restart(wanted)
                return self._charged(outcome), begun.cuts
            self._cut(path, outcome, size)

    def _cut(self, path: Path, outcome: Outcome, size: float) -> None:
        if self.steps.cut(outcome, size):
            log.info(
                "step %d: cut to %.4g of a regular step (%s)", self.number + 1, self.steps.position.size, outcome.reason
            )
        else:
            raise path.failure(outcome.reason, "" if outcome.refused else self.cause())
