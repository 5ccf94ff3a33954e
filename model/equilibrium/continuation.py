"""The walk along a path of loads: predict, solve, accept or cut; the one loop for rods, frames, probes and solids.

A solve ends in one of two ways: its trial state becomes the equilibrium, or all goes back to the last one. That
transaction is made here and nowhere else.
"""

import logging
import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from typing import TypeVar

from coilset.model.equilibrium.control import StepControl
from coilset.model.equilibrium.convergence import Outcome
from coilset.model.equilibrium.load import Load
from coilset.model.equilibrium.newton import Newton, Start
from coilset.model.errors import SolveError

log = logging.getLogger("coilset.steps")
Reading = TypeVar("Reading")


@dataclass(frozen=True)
class Path:
    """Loads along the way to a target.

    Attributes:
        load: the load from the last equilibrium to a place on the path, which is counted in regular steps.
        regular: number of regular steps.
        target: in words, for logs and errors.
        automatic: do steps grow on ease and shrink on trouble? Equal steps end on their marks, also after a cut.
        place: where the walk stands, in words.
    """

    load: Callable[[float], Load]
    regular: int = 1
    target: str = "the target"
    automatic: bool = False
    place: Callable[[], str] = lambda: "here"


@dataclass(frozen=True)
class Position:
    """Where on its path the walk stands.

    Attributes:
        done: what is behind, in regular steps.
        size: next step, in regular steps.
        cuts: how often the step in progress was cut.
        last: size of the last step, whose increments are the guess for the next one; 0 if there is no guess.
    """

    done: float = 0.0
    size: float = 1.0
    cuts: int = 0
    last: float = 0.0


class Continuation:
    """Walks.

    Args:
        newton: Newton.
        control: StepControl.
        penetration_limit: penetration beyond which a state is no equilibrium, mm.
        starts: where to begin solving a load for a step of the given size, one start after the other; default: the last
            step's increments, scaled, then the last equilibrium.

    Attributes:
        position: Position.
        number: steps so far.
    """

    def __init__(
        self,
        newton: Newton,
        control: StepControl | None = None,
        penetration_limit: float = math.inf,
        starts: Callable[[Load, float], Iterable[Start]] | None = None,
    ) -> None:
        self.newton, self.system, self.control = newton, newton.system, control or StepControl()
        self.penetration_limit, self.starts = penetration_limit, starts or self.from_last_step
        self.position, self.number, self._attempts = Position(), 0, 0

    # ---- one solve -------------------------------------------------------------------------------------------------

    def attempt(self, load: Load, starts: Iterable[Start] = (Start(),)) -> Outcome:
        """Solve a step; its state is the last equilibrium, or all is as it was before; collective."""
        outcome = self._solve(load, starts)
        if outcome.converged:
            self.system.commit()
        else:
            self.system.restore()
        return outcome

    def probe(self, load: Load, read: Callable[[], Reading]) -> tuple[Outcome, Reading]:
        """Solve a step, read something of its state, and go back to the last equilibrium; collective."""
        outcome = self._solve(load, (Start(),))
        reading = read()
        self.system.restore()
        return outcome, reading

    def _solve(self, load: Load, starts: Iterable[Start]) -> Outcome:
        outcome = None
        for start in starts:
            if outcome is not None:
                log.info("step %d: no equilibrium from the last step's direction (%s)", self.number + 1, outcome.reason)
            outcome = self.newton.solve(load, start)
            if outcome.converged:
                break
        assert outcome is not None
        return self._judged(outcome)

    def _judged(self, outcome: Outcome) -> Outcome:
        """An equilibrium in which bodies are pressed deep into each other counts as none."""
        if outcome.converged and (depth := self.system.max_penetration) > self.penetration_limit:
            reason = f"coils or seats would lie {depth:.4g} mm in each other, more than {self.penetration_limit:.4g} mm"
            return replace(outcome, converged=False, reason=reason)
        return outcome

    def from_last_step(self, load: Load, size: float) -> Iterator[Start]:
        """The last step's increments, scaled to a step of this size; then the last equilibrium."""
        if self.position.last:
            yield self.scaled_last(size / self.position.last)
        yield Start()

    def scaled_last(self, factor: float) -> Start:
        """The last step's increments times a factor."""
        guess = self.system.layout.vector(self.system.state["increments"].equilibrium.copy())
        guess.scale(factor)
        return Start(guess)

    # ---- the walk --------------------------------------------------------------------------------------------------

    def begin(self) -> None:
        """Stand at the start of a path."""
        self.position, self._attempts = Position(), 0

    def resize(self, size: float) -> None:
        """Make the next step as large as `size` regular steps."""
        self.position = replace(self.position, size=size)

    def advance(self, path: Path) -> tuple[Outcome, int]:
        """Take one step along a path, cut as often as need be; collective.

        Returns:
            The step's Outcome, and how often it was cut.

        Raises:
            SolveError: if it failed down to the smallest size, or the walk stalls; the state is that of the last
                converged step.
        """
        while True:
            self._attempts += 1
            if self._attempts > self.control.attempts * path.regular + self.control.spare_attempts:
                stalls = f"the program stalls, {self._attempts} solves on the way to {path.target}"
                raise SolveError(f"no equilibrium beyond {path.place()}: {stalls}")
            position = self.position
            size = min(position.size, path.regular - position.done)
            if not path.automatic:
                size = min(size, int(position.done + 1e-9) + 1 - position.done)
            load = path.load(position.done + size)
            outcome = self.attempt(load, self.starts(load, size))
            if outcome.converged:
                self.number += 1
                self.position = Position(position.done + size, self._following(path, outcome, size), 0, size)
                return outcome, position.cuts
            self._cut(path, outcome, size)

    def _cut(self, path: Path, outcome: Outcome, size: float) -> None:
        shorter = self.control.cut * size
        self.position = replace(self.position, size=shorter, cuts=self.position.cuts + 1, last=0.0)
        log.info("step %d: cut to %.4g of a regular step (%s)", self.number + 1, shorter, outcome.reason)
        if shorter < self.control.smallest:
            raise SolveError(f"no equilibrium beyond {path.place()} on the way to {path.target}: {outcome.reason}")

    def _following(self, path: Path, outcome: Outcome, size: float) -> float:
        """Size of the step after one of this size."""
        control = self.control
        if not path.automatic:
            return min(1.0, control.regrowth * size)
        easy, hard = outcome.iterations <= control.easy, outcome.iterations >= control.hard
        return min(control.largest, size * (control.growth if easy else control.shrinkage if hard else 1.0))
