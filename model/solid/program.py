"""Load programs of a coil section between its heads: compressed along the coil's axis, and released to zero force."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from coilset.model.equilibrium.path.release import release
from coilset.model.solid.heads import Motion
from coilset.model.solid.problem import SolidProblem


@dataclass(frozen=True)
class Station:
    """An equilibrium along the load program.

    Attributes:
        travel: downward displacement of the top head, mm.
        force: axial force of the top head, positive in compression, N.
        torque: moment of the top head about the coil's axis, N mm.
        iterations: linear solves since the last station.
        linear_iterations: iterations within them.
    """

    travel: float
    force: float
    torque: float
    iterations: int = 0
    linear_iterations: int = 0


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
        outcome, _cuts = self.problem.step(Motion((0.0, 0.0, -travel)), hours=hours)
        _, top = self.problem.reactions(np.zeros(3))
        station = Station(travel, -top.force[2], top.moment[2], outcome.iterations, outcome.linear_iterations)
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
        last = self.stations[-1]
        release(lambda travel: self.go(travel).force, last.travel, last.force, steps, limit)
        return self.stations[-1]
