"""Load programs of a coil section between its heads: pressed along the coil's axis, and released to zero force."""

from dataclasses import dataclass

import numpy as np

from coilset.model.errors import SolveError
from coilset.model.solid.heads import Motion

MAX_RELEASE_STEPS = 20
PROBE = 0.01  # part of the travel by which the rate of release is measured


@dataclass(frozen=True)
class Station:
    """An equilibrium on the way.

    Attributes:
        travel: how far the top head has come down, mm.
        force: axial force of the top head, positive in compression, N.
        torque: moment of the top head about the coil's axis, N mm.
        iterations: linear solves from the last station to here.
        linear_iterations: iterations inside them.
    """

    travel: float
    force: float
    torque: float
    iterations: int = 0
    linear_iterations: int = 0


class AxialProgram:
    """Moves the top head of a SolidProblem along z, without turning it, and records what it meets.

    Args:
        problem: SolidProblem of a coil about the z axis; the bottom head stays.
        report: called with every Station.

    Attributes:
        stations: those reached so far, the unloaded one first.
    """

    def __init__(self, problem, report=lambda station: None):
        self.problem, self.report = problem, report
        self.stations = [Station(0.0, 0.0, 0.0)]

    def go(self, travel):
        """Go to a travel in one step.

        Returns:
            Station.

        Raises:
            SolveError: if there is no equilibrium.
        """
        effort = self.problem.step(Motion((0.0, 0.0, -travel)))
        _, top = self.problem.reactions(np.zeros(3))
        station = Station(travel, -top.force[2], top.moment[2], effort.iterations, effort.linear_iterations)
        self.stations.append(station)
        self.report(station)
        return station

    def press(self, travel, steps):
        """Go to a travel in equal steps."""
        for part in np.arange(1, steps + 1) / steps:
            self.go(travel * part)

    def release(self, steps, precision=1e-5):
        """Go back to zero axial force: in equal steps to where the rate of release brings it, then by secants.

        Args:
            steps: of the first part, after a small one that shows the rate.
            precision: force that is left, over the greatest force so far.

        Returns:
            Station at zero force; its travel is the set.

        Raises:
            SolveError: if there is no equilibrium, or the force does not come to zero.
        """
        limit = precision * max(abs(station.force) for station in self.stations)
        last = self.stations[-1]
        first = self.go(last.travel * (1 - PROBE))
        rate = (last.force - first.force) / (last.travel - first.travel)
        for part in np.arange(1, steps + 1) / steps:
            station = self.go(first.travel - first.force / rate * part)
        for _ in range(MAX_RELEASE_STEPS):
            if abs(station.force) <= limit:
                return station
            before = self.stations[-2]
            secant = (station.force - before.force) / (station.travel - before.travel)
            station = self.go(station.travel - station.force / np.clip(secant, 0.5 * rate, 1.5 * rate))
        raise SolveError(f"the force does not come below {limit:g} N on release")
