"""Load programs of a coil section between its heads: compressed along the coil's axis, and released to zero force."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from coilset.model.core.base.errors import SolveError
from coilset.model.physics.solid.heads import Motion
from coilset.model.physics.solid.problem import SolidProblem

MAX_SECANTS = 20
PROBE = 0.01  # part of the travel by which the rate of release is measured
SOFTEST, STIFFEST = 0.02, 1.5  # slopes that a secant may have, over the elastic rate


@dataclass(frozen=True)
class Station:
    """An equilibrium along the load program.

    Attributes:
        travel: downward displacement of the top head, mm.
        force: axial force of the top head, positive in compression, N.
        torque: moment of the top head about the coil's axis, N mm.
        iterations: linear solves since the last station.
        linear_iterations: iterations within them.
        cuts: of the step.
    """

    travel: float
    force: float
    torque: float
    iterations: int = 0
    linear_iterations: int = 0
    cuts: int = 0


class AxialProgram:
    """Moves the top head of a SolidProblem along z, without rotating it, and records the reactions.

    Args:
        problem: SolidProblem of a coil about the z axis; the bottom head is fixed.
        report: called with every Station.

    Attributes:
        stations: those reached so far, the unloaded one first.
    """

    def __init__(self, problem: SolidProblem, report: Callable[[Station], object] = lambda station: None) -> None:
        self.problem, self.report = problem, report
        self.stations = [Station(0.0, 0.0, 0.0)]

    def go(self, travel: float, hours: float = 0.0) -> Station:
        """Go to a travel in one step, which takes some hours.

        Raises:
            SolveError: if there is no equilibrium.
        """
        outcome, cuts = self.problem.step(Motion((0.0, 0.0, -travel)), hours=hours)
        _, top = self.problem.reactions(np.zeros(3))
        station = Station(travel, -top.force[2], top.moment[2], outcome.iterations, outcome.linear_iterations, cuts)
        self.stations.append(station)
        self.report(station)
        return station

    def press(self, travel: float, steps: int) -> None:
        """Go to a travel in equal steps."""
        for part in np.arange(1, steps + 1) / steps:
            self.go(travel * part)

    def release(self, steps: int, precision: float = 1e-5) -> Station:
        """Go back to zero axial force: in equal steps to the travel that the rate of release predicts, then by secants.

        Args:
            steps: number in the first part, after a small step that gives the rate.
            precision: remaining force over the maximum force so far.

        Returns:
            Station at zero force; its travel is the set.

        Raises:
            SolveError: if there is no equilibrium, or the force does not reach zero.
        """
        limit = precision * max(abs(station.force) for station in self.stations)
        begin = self.stations[-1]
        first = self.go(begin.travel * (1.0 - PROBE))
        rate = (begin.force - first.force) / (begin.travel - first.travel)
        for part in np.arange(1, steps + 1) / steps:
            self.go(first.travel - part * first.force / rate)
        return self.reach(0.0, rate, limit)

    def reach(self, force: float, rate: float, limit: float) -> Station:
        """Go on to an axial force by secants of the last steps.

        Args:
            force: N; limit: how far off it may be, N.
            rate: elastic, N/mm, which bounds the secants, and takes the place of one that leads back.

        Raises:
            SolveError: if there is no equilibrium, or the force is not reached.
        """
        before, last = self.stations[-2:]
        for _secant in range(MAX_SECANTS):
            if abs(last.force - force) <= limit:
                return last
            goes_on = (last.travel - before.travel) * (force - last.force) > 0.0
            secant = (last.force - before.force) / (last.travel - before.travel) if goes_on else rate
            slope = np.clip(secant, SOFTEST * rate, STIFFEST * rate)
            before, last = last, self.go(float(last.travel + (force - last.force) / slope))
        raise SolveError(f"the force does not come within {limit:g} N of {force:g} N")
