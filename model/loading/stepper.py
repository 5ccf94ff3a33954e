"""Walk through a load program: equal steps, cut where the solve fails, each converged step committed and reported."""

from dataclasses import dataclass

from coilset.model.errors import SolveError

SMALLEST = 2.0**-10  # smallest share of a regular step before the program is given up


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


class Stepper:
    """Drives a spring through phases.

    Args:
        drive: Drive.
        solver: Solver.
        block_height: height that `to: block` means, mm.
    """

    def __init__(self, drive, solver, block_height):
        self.drive, self.solver, self.system, self.block_height = drive, solver, drive.system, block_height
        self.number = 0

    def _prescribe(self, phase, start, t):
        """Set the step's end at share `t` of the phase; heights and forces go linearly from where the phase began."""
        to, drive = phase.to, self.drive
        if to != "block" and to.force is not None:
            drive.by_force(start[1] + t * (to.force - start[1]))
            return
        if to == "block":
            target = self.block_height
        else:
            target = to.height if to.height is not None else drive.free_length - to.travel
        drive.by_height(start[0] + t * (target - start[0]))

    def run_phase(self, index, phase, report=lambda step: None):
        """Go to the phase's target; `report` is called with every converged Step.

        Raises:
            SolveError: if a step failed down to the smallest size; the state is that of the last converged step.
        """
        start = (self.drive.height, self.drive.force)
        done, size, cuts, last = 0.0, 1.0, 0, None  # in regular steps; last: increments of the last step and its size
        while done < phase.steps:
            size = min(size, phase.steps - done, int(done + 1e-9) + 1 - done)
            self._prescribe(phase, start, (done + size) / phase.steps)
            guess = None
            if last is not None:
                guess = last[0].copy()
                guess.scale(size / last[1])
            outcome = self.solver.solve(guess)
            if not outcome.converged and guess is not None:
                outcome = self.solver.solve(None)
            if not outcome.converged:
                self.system.restore()
                size, cuts, last = 0.5 * size, cuts + 1, None
                if size < SMALLEST:
                    raise SolveError(
                        f"no equilibrium beyond {self.drive.height:.6g} mm and {self.drive.force:.6g} N "
                        f"on the way to {phase.label}: {outcome.reason}"
                    )
                continue
            last = (self.solver.X.copy(), size)
            height, force = self.drive.read(self.solver.X)
            self.system.commit()
            self.drive.accept(height, force)
            done += size
            self.number += 1
            report(Step(self.number, index, done / phase.steps, height, self.drive.free_length - height, force,
                        outcome.iterations, cuts, self.drive.contacts))  # fmt: skip
            size, cuts = min(1.0, 2.0 * size), 0
