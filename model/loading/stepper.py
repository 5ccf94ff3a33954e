"""Walk through a load program: stations hit exactly, steps cut on failure and grown on ease, every decision logged."""

import logging
import math
from dataclasses import dataclass, replace

from coilset.model.errors import SolveError

log = logging.getLogger("coilset.steps")

SMALLEST = 2.0**-10  # smallest share of a regular step before the program is given up
ATTEMPTS = 40  # solves per regular step, and 200 more, before a phase is said to creep
AUTOMATIC = 16  # regular steps of an automatic phase, for its first step
EASY, HARD = 5, 10  # iterations up to which a step counts as easy, and from which as hard
GROWTH, SHRINKAGE, LARGEST = 1.5, 0.7, 2.0  # LARGEST in regular steps


@dataclass(frozen=True)
class Step:
    """One converged step."""

    number: int
    phase: int
    progress: float
    seat_height_mm: float
    travel_mm: float
    force_N: float
    iterations: int
    cuts: int
    contacts: int
    penetration_mm: float


@dataclass
class Walk:
    """Where in the program the spring stands; part of every checkpoint.

    Attributes:
        phase: number of the phase, done: share of it that is behind, in regular steps.
        height, force: where the phase began, mm and N.
        size: next step, in regular steps.
        cuts: how often the step in progress was cut.
        last: size of the last step, whose increments are the guess for the next one; 0 if there is no guess.
    """

    phase: int = 0
    done: float = 0.0
    height: float = 0.0
    force: float = 0.0
    size: float = 1.0
    cuts: int = 0
    last: float = 0.0


def regular_steps(phase):
    """Number of regular steps of a phase."""
    return AUTOMATIC if phase.steps == "auto" else phase.steps


class Stepper:
    """Drives a spring through phases.

    Args:
        drive: Drive.
        solver: Solver.
        block_height: height that `to: block` means, mm.
        deepest: penetration beyond which a step is no equilibrium, mm.

    Attributes:
        walk: Walk; replaced by a checkpoint's on resume, together with `guess`, the last step's increments.
        number: steps so far.
    """

    def __init__(self, drive, solver, block_height, deepest=math.inf):
        self.drive, self.solver, self.system = drive, solver, drive.system
        self.block_height, self.deepest = block_height, deepest
        self.number, self.walk, self.guess = 0, Walk(height=drive.height), drive.system.vector()

    def begin(self, index):
        """Stand at the start of a phase."""
        self.walk = Walk(index, height=self.drive.height, force=self.drive.force)

    def target(self, phase):
        """Kind (`force` or `height`) and value of a phase's end, N or mm."""
        to = phase.to
        if to == "block":
            return "height", self.block_height
        if to.force is not None:
            return "force", to.force
        return "height", to.height if to.height is not None else self.drive.free_length - to.travel

    def run_phase(self, phase, report=lambda step: None):
        """Go on from `walk` to the phase's target; `report` is called with every converged Step.

        Raises:
            SolveError: if a step failed down to the smallest size, or the phase creeps; the state is that of the last
                converged step.
        """
        self.phase, attempts = phase, 0
        while self.walk.done < (regular := regular_steps(self.phase)):
            phase, attempts = self.phase, attempts + 1
            if attempts > ATTEMPTS * regular + 200:
                raise SolveError(f"{self._where()}: the program creeps, {attempts} solves on the way to {phase.label}")
            outcome, size = self._try(phase, regular)
            if outcome.converged:
                self._accept(phase, regular, outcome, size, report)
            else:
                self._cut(phase, outcome, size)

    def redirect(self, phase):
        """Go to another target from here on, in place of the phase in progress."""
        self.begin(self.walk.phase)
        self.phase = phase

    def resize(self, size):
        """Make the next step as large as `size` regular steps."""
        self.walk = replace(self.walk, size=size)

    def _where(self):
        return f"no equilibrium beyond {self.drive.height:.6g} mm and {self.drive.force:.6g} N"

    def _try(self, phase, regular):
        """Solve the next step, first from the last step's increments; the outcome and the step's size."""
        walk = self.walk
        size = min(walk.size, regular - walk.done)
        if phase.steps != "auto":  # equal steps end on their marks, also after a cut
            size = min(size, int(walk.done + 1e-9) + 1 - walk.done)
        kind, end = self.target(phase)
        share = (walk.done + size) / regular
        begin = walk.force if kind == "force" else walk.height
        value = end if walk.done + size >= regular else begin + share * (end - begin)
        (self.drive.by_force if kind == "force" else self.drive.by_height)(value)
        if walk.last:
            guess = self.guess.copy()
            guess.scale(size / walk.last)
            outcome = self.solver.solve(guess)
            if outcome.converged:
                return self._judged(outcome), size
            log.info("step %d: no equilibrium from the last step's direction (%s)", self.number + 1, outcome.reason)
        return self._judged(self.solver.solve(None)), size

    def _judged(self, outcome):
        """An equilibrium in which bodies are pressed deep into each other counts as none."""
        if outcome.converged and (depth := self.system.depth) > self.deepest:
            reason = f"coils or seats would lie {depth:.4g} mm in each other, more than {self.deepest:.4g} mm"
            return replace(outcome, converged=False, reason=reason)
        return outcome

    def _cut(self, phase, outcome, size):
        self.system.restore()
        self.walk = replace(self.walk, size=0.5 * size, cuts=self.walk.cuts + 1, last=0.0)
        log.info("step %d: cut to %.4g of a regular step (%s)", self.number + 1, 0.5 * size, outcome.reason)
        if self.walk.size < SMALLEST:
            raise SolveError(f"{self._where()} on the way to {phase.label}: {outcome.reason}")

    def _accept(self, phase, regular, outcome, size, report):
        """Make the trial state the equilibrium, and choose the next size."""
        walk, drive = self.walk, self.drive
        self.solver.X.copy(self.guess)
        height, force = drive.read(self.solver.X)
        self.system.commit()
        drive.accept(height, force)
        self.number += 1
        following = min(1.0, 2.0 * size)
        if phase.steps == "auto":
            factor = GROWTH if outcome.iterations <= EASY else SHRINKAGE if outcome.iterations >= HARD else 1.0
            following = min(LARGEST, factor * size)
        done = walk.done + size
        self.walk = replace(walk, done=done, size=following, cuts=0, last=size)
        log.info("step %d: %.6g mm, %.6g N, %d iterations, out of balance %.1e; next %.4g of a regular step",
                 self.number, height, force, outcome.iterations, outcome.ratio, following)  # fmt: skip
        report(Step(self.number, walk.phase, done / regular, height, drive.free_length - height, force,
                    outcome.iterations, walk.cuts, drive.contacts, self.system.depth))  # fmt: skip
