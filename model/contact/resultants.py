"""External actions on the wire: forces of the contacts, their resultant wrenches and lines of action."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from coilset.model.contact.base import SEAT_DOFS, Contribution
from coilset.model.contact.bearing import add_force, add_resultant, moment_about


def station_forces(parts: Iterable[Contribution], stations: int) -> np.ndarray:
    """Forces of contacts on the wire.

    Args:
        parts: Contributions.
        stations: number of stations n.

    Returns:
        shape (n, 3), N.
    """
    force = np.zeros(3 * stations)
    for part in parts:
        on_wire = part.dofs < 3 * stations
        np.subtract.at(force, part.dofs[on_wire], part.forces[on_wire])
    return force.reshape(-1, 3)


def station_moments(parts: Iterable[Contribution], charts: np.ndarray) -> np.ndarray:
    """Moments of friction on the wire's sections, from its work on their rotations: M · δω = f · δv, δω = T δv.

    Args:
        parts: Contributions.
        charts: T of the stations, shape (n, 3, 3).

    Returns:
        shape (n, 3), N mm.
    """
    n = len(charts)
    moment, first = np.zeros(3 * n), 3 * n + 2 * SEAT_DOFS
    for part in parts:
        on_rotations = part.dofs >= first
        np.subtract.at(moment, part.dofs[on_rotations] - first, part.forces[on_rotations])
    if not moment.any():
        return moment.reshape(n, 3)
    return np.linalg.solve(np.swapaxes(charts, 1, 2), moment.reshape(n, 3, 1))[..., 0]


def levers(x: np.ndarray, forces: np.ndarray) -> np.ndarray:
    """Σ x × f, from the matrix Σ x fᵀ; shapes (n, 3) each."""
    C = x.T @ forces
    return np.array([C[1, 2] - C[2, 1], C[2, 0] - C[0, 2], C[0, 1] - C[1, 0]])


@dataclass(frozen=True)
class Wrench:
    """Force, shape (3,), N, and its moment about the origin or another point, shape (3,), N mm."""

    force: np.ndarray
    moment: np.ndarray

    @classmethod
    def of(cls, forces: np.ndarray, x: np.ndarray, moments: np.ndarray | float = 0.0) -> "Wrench":
        """The resultant of `forces` and `moments`, shape (n, 3), at the points `x`, shape (n, 3), mm."""
        turning = np.broadcast_to(moments, np.shape(forces))
        return cls(np.sum(forces, axis=0), levers(x, forces) + np.sum(turning, axis=0))

    @classmethod
    def of_contacts(
        cls, parts: Sequence[Contribution], x: np.ndarray, charts: np.ndarray, station: int, held: np.ndarray
    ) -> "Wrench":
        """The resultant of contacts on the wire, and of what holds one of its stations.

        Args:
            parts: Contributions.
            x, charts: positions and T of the stations, shapes (n, 3) and (n, 3, 3), mm.
            station: that is held; held: force on it, N, and moment, N mm, shape (6,).
        """
        sums, rotations = np.zeros(6), 3 * len(x) + 2 * SEAT_DOFS
        turn = [part for part in parts if add_resultant(part.dofs, part.forces, x, rotations, sums)]
        if turn:
            sums[3:] += station_moments(turn, charts).sum(axis=0)
        add_force(x[station], held, sums)
        return cls(sums[:3], sums[3:])

    def __add__(self, other: "Wrench") -> "Wrench":
        return Wrench(self.force + other.force, self.moment + other.moment)

    def about(self, point: np.ndarray) -> "Wrench":
        """The same with its moment about a `point`, shape (3,), mm, instead of the origin."""
        moment = np.empty(3)
        moment_about(point, self.force, self.moment, moment)
        return Wrench(self.force, moment)

    def crossing(self) -> tuple[float, float]:
        """Where the resultant crosses the plane z = const through the point about which its moment is, relative to it.

        There its moments about x and y vanish: ex = −My/Fz, ey = Mx/Fz.

        Returns:
            ex, ey, mm.
        """
        mx, my, _ = self.moment.tolist()
        along = float(self.force[2])
        return -my / along, mx / along
