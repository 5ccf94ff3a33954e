"""External actions on the wire: forces of the contacts, their resultants and lines of action, and where it bears."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from coilset.model.core.contact.base import SEAT_DOFS, Contribution
from coilset.model.core.contact.curve import STENCIL
from coilset.model.core.runtime.kernels import njit


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


@njit(cache=True)
def add_resultant(dofs: np.ndarray, forces: np.ndarray, x: np.ndarray, rotations: int, out: np.ndarray) -> bool:
    """Add to `out` the force on the wire and its moment about the origin, shape (6,), N and N mm.

    Args:
        dofs, forces: of contact elements, see Contribution; forces on rotations are left out.
        x: positions of the stations, shape (n, 3), mm.
        rotations: the first of the stations' rotations.

    Returns:
        Whether something was left out.
    """
    left_out = False
    for e in range(len(dofs)):
        for a in range(dofs.shape[1]):
            station, k = dofs[e, a] // 3, dofs[e, a] % 3
            if station < len(x):
                i, j, force = (k + 1) % 3, (k + 2) % 3, -forces[e, a]
                out[k] += force
                out[3 + i] += x[station, j] * force
                out[3 + j] -= x[station, i] * force
            left_out |= dofs[e, a] >= rotations
    return left_out


@njit(cache=True)
def add_force(point: np.ndarray, force: np.ndarray, out: np.ndarray) -> None:
    """Add to `out` a force and a moment, shape (6,), at a point, shape (3,), as `add_resultant`."""
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        out[k] += force[k]
        out[3 + k] += force[3 + k] + point[i] * force[j] - point[j] * force[i]


@njit(cache=True)
def moment_about(point: np.ndarray, force: np.ndarray, moment: np.ndarray, out: np.ndarray) -> None:
    """Write the moment about a point of a force and a moment at the origin, shape (3,) each."""
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        out[k] = moment[k] - (point[i] * force[j] - point[j] * force[i])


@njit(cache=True)
def bearing_on_seat(
    point: np.ndarray,
    pressure: np.ndarray,
    bears: np.ndarray,
    weights: np.ndarray,
    stations: np.ndarray,
    x: np.ndarray,
    lengths: np.ndarray,
    turns: np.ndarray,
    tip: int,
    faint: float,
) -> tuple[float, float, float, float]:
    """Where a seat bears on the wire.

    Args:
        point, pressure, bears: of a Contribution.
        weights, stations, lengths, turns: of the WirePoints.
        x: positions of the stations, shape (n, 3), mm.
        tip: number of the point at the wire's tip.
        faint: force that counts as none, N.

    Returns:
        Length of the wire that bears, mm, how far it reaches from the tip, turns, and x and y of the centre of
        pressure, mm, not numbers where nothing presses.
    """
    length = reach = total = force = px = py = 0.0
    for e in range(len(point)):
        force += pressure[e]
        if bears[e]:
            i = point[e]
            length, reach = length + lengths[i], max(reach, abs(turns[i] - turns[tip]))
            total += pressure[e]
            for a in range(STENCIL):
                px += pressure[e] * weights[i, a] * x[stations[i, a], 0]
                py += pressure[e] * weights[i, a] * x[stations[i, a], 1]
    if force <= faint or total <= 0.0:
        return length, reach, np.nan, np.nan
    return length, reach, px / total, py / total


@njit(cache=True)
def pressures_on(
    kind: int, point: np.ndarray, pressure: np.ndarray, bears: np.ndarray, lengths: np.ndarray, factor: float
) -> np.ndarray:
    """The points of the wire on which a kind of contact bears.

    Args:
        kind: its number.
        point, pressure, bears: of its Contribution.
        lengths: of wire assigned to each point, shape (m,), mm.
        factor: of the forces.

    Returns:
        Rows of `kind`, the point's number and force per length of wire, N/mm, by the points' numbers.
    """
    force = np.zeros(len(lengths))
    for e in range(len(point)):
        if bears[e]:
            force[point[e]] += pressure[e]
    rows, count = np.empty((np.count_nonzero(force), 3)), 0
    for i in range(len(force)):
        if force[i] != 0.0:
            rows[count, 0], rows[count, 1], rows[count, 2] = kind, i, factor * force[i] / lengths[i]
            count += 1
    return rows


@njit(cache=True)
def turns_without(share: np.ndarray, rows: np.ndarray) -> float:
    """Sum of the points' shares of turns, without those that occur in `rows`, see `pressures_on`."""
    free, total = np.ones(len(share), dtype=np.bool_), 0.0
    for row in rows:
        free[int(row[1])] = False
    for i in range(len(share)):
        if free[i]:
            total += share[i]
    return total
