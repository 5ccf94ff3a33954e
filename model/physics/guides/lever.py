"""A node that is fixed to a rigid head: its unknowns are the head's, the motion of a point of it and its rotation.

A head with its point at c carries the node at the arm r = x − c. With the increments (d, ψ) of the head since the last
equilibrium the node is at

    x = x₀ + d + (exp[ψ] − 1) r₀,    δx = δd + X δψ,    X = ∂(exp[ψ] r₀)/∂ψ,

and has the head's rotation. A force f on the node therefore acts on ψ by Xᵀ f, the moment r × f in the chart, and the
tangent of the node's unknowns becomes Gᵀ K G + f · ∂²x/∂ψ², with G = (1, X; 0, 1): it stays symmetric.
"""

import weakref
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from coilset.model.core.contact.base import SEAT_DOFS, Contribution
from coilset.model.core.equilibrium.system.system import System
from coilset.model.core.rotations.vectors import nearest_vector, rotation_derivatives, rotation_matrix


class Swing(NamedTuple):
    """How a node goes with the trial rotation of its head.

    Attributes:
        shift: (exp[ψ] − 1) r₀, shape (3,), mm.
        first: X, by component and rotation, shape (3, 3), mm.
        second: ∂²x/∂ψ∂ψ, by rotations and component, shape (3, 3, 3), mm.
    """

    shift: np.ndarray
    first: np.ndarray
    second: np.ndarray

    @classmethod
    def of(cls, ψ: np.ndarray, arm: np.ndarray) -> "Swing":
        """By the rotation vector ψ since the last equilibrium, rad, where the arm was r₀, mm; shape (3,) each."""
        _, dR, ddR = rotation_derivatives(ψ)
        return cls((rotation_matrix(ψ) - np.eye(3)) @ arm, (dR @ arm).T, ddR @ arm)

    def of_force(self, force: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Xᵀ f and f · ∂²x/∂ψ², shapes (3,) and (3, 3), of a force on the node, shape (3,), N."""
        return self.first.T @ force, self.second @ force


class Lever:
    """A local node of a rod, and the cells of this rank that end in it.

    Args:
        node: number of the local node.
        arm: from the head's point to the node in the stress-free state, shape (3,), mm.
        u, rotations: the node's unknowns, shape (3,) each.
        cells: nodes of this rank's cells, shape (cells, 2); elements: their unknowns, shape (cells, k).

    Attributes:
        swing: trial Swing.
        forces: of the cells on the node, by their numbers, kept for the tangent, shape (3,) each, N.
    """

    def __init__(
        self,
        node: int,
        arm: np.ndarray,
        u: np.ndarray,
        rotations: np.ndarray,
        cells: np.ndarray,
        elements: np.ndarray,
    ) -> None:
        self.node, self.arm, self.u, self.rotations = node, arm, u, rotations
        self._cells = [
            (int(cell), _places(elements[cell], u), _places(elements[cell], rotations))
            for cell in np.flatnonzero((cells == node).any(axis=1))
        ]
        self.swing, self.forces = Swing.of(np.zeros(3), arm), dict[int, np.ndarray]()

    def carry(self, increments: np.ndarray, R: np.ndarray) -> None:
        """Replace the head's increments by the node's; `R`: rotation of the node at the last equilibrium."""
        self.swing = Swing.of(increments[self.rotations], R @ self.arm)
        increments[self.u] += self.swing.shift

    def carry_correction(self, correction: np.ndarray) -> None:
        """Replace a small correction of the head's unknowns by that of the node's."""
        correction[self.u] += self.swing.first @ correction[self.rotations]

    def carry_forces(self, cells: slice, forces: np.ndarray) -> None:
        """Replace forces of cells on the node by those on the head, shape (cells, k), N and N mm."""
        for cell, u, rotations in self._within(cells):
            forces[cell, rotations] += self.swing.of_force(forces[cell, u])[0]

    def keep_force(self, cells: slice, forces: np.ndarray) -> None:
        """Keep the forces of cells on the node, shape (cells, k), for `carry_tangents`."""
        for cell, u, _ in self._within(cells):
            self.forces[cells.start + cell] = forces[cell, u].copy()

    def carry_tangents(self, cells: slice, K: np.ndarray) -> None:
        """Replace tangents of cells by the node's unknowns by those by the head's, shape (cells, k, k)."""
        for cell, u, rotations in self._within(cells):
            X, one = self.swing.first, K[cell]
            one[rotations] += X.T @ one[u]
            one[:, rotations] += one[:, u] @ X
            one[np.ix_(rotations, rotations)] += self.swing.of_force(self.forces[cells.start + cell])[1]

    def _within(self, cells: slice) -> list[tuple[int, np.ndarray, np.ndarray]]:
        return [(cell - cells.start, u, r) for cell, u, r in self._cells if cells.start <= cell < cells.stop]


def _places(unknowns: np.ndarray, of: np.ndarray) -> np.ndarray:
    """Places of some unknowns among those of a cell."""
    return np.array([int(np.flatnonzero(unknowns == dof)[0]) for dof in of])


class FixedStation:
    """A station whose unknowns are those of a rigid head that rotates; made on every rank, before the first step.

    Args:
        system: of the rod whose station it is.
        station: its number.
        point: of the head in the stress-free state, shape (3,), mm.
    """

    def __init__(self, system: System, station: int, point: np.ndarray) -> None:
        self._system: System = weakref.proxy(system)  # that the end of an analysis frees it at once
        self._station, rod = station, system.line.rod
        self._swing: Swing | None = None  # of the last evaluation
        self._at_bottom = 2 * station < len(system.line.station_dofs)
        self._arm = rod.arms[station] = rod.line.stations[station] - point
        for node in np.flatnonzero(rod.line.node == station):
            unknowns = rod.numbering.u[node], rod.numbering.rotations[node]
            rod.levers.append(Lever(int(node), self._arm, *unknowns, rod.cells, rod.numbering.elements))

    def follow(self) -> None:
        """Write the head's pose in the trial state, and how the station goes with it; collective."""
        line, state, station, arm = self._system.line, self._system.state, self._station, self._arm
        rod, own = line.rod, slice(0, SEAT_DOFS) if self._at_bottom else slice(SEAT_DOFS, 2 * SEAT_DOFS)
        increments = rod.increment.x.array
        x, ψ = (line.at_station(values, station) for values in (rod.x, increments[rod.rotation_dofs]))
        R = line.at_station(state["R"].equilibrium, station)
        self._swing = swing = Swing.of(ψ, R @ arm)
        θ = nearest_vector(rotation_matrix(ψ) @ R, state["seats"].equilibrium[own][3:])
        state["seats"].trial[own] = np.concatenate([x - R @ arm - swing.shift, θ])

    def carried(self, parts: list[Contribution]) -> list[Contribution]:
        """Contact elements, those on the station with the head's rotations among their unknowns."""
        if self._swing is None:
            return parts
        stations = len(self._system.line.station_dofs)
        return [one for part in parts for one in carried(part, self._station, stations, self._swing)]


def carried(part: Contribution, station: int, stations: int, swing: Swing) -> list[Contribution]:
    """Contact elements, those on a station of a rigid head with the head's rotations among their unknowns.

    Args:
        part: elements; their unknowns are the displacement of the station.
        station: its number, of so many `stations`.
        swing: how it goes with the head.

    Returns:
        The elements that do not act on the station, and the others. The first and the last unknown of an element stay
        so: they identify it.
    """
    own = (part.dofs // 3 == station) & (part.dofs < 3 * stations)
    on_head = own.any(axis=1)
    if not on_head.any():
        return [part]
    rest, part, own = part.only(~on_head), part.only(on_head), own[on_head]
    m, k = part.dofs.shape
    J = np.zeros((m, k, k + 3))
    J[:, np.arange(k), np.arange(k)] = 1.0
    J[:, :, k:] = np.where(own[..., None], swing.first[part.dofs % 3], 0.0)
    force = np.zeros((m, 3))
    for axis in range(3):
        force[:, axis] = np.where(own & (part.dofs % 3 == axis), part.forces, 0.0).sum(axis=1)
    stiffness = np.swapaxes(J, 1, 2) @ part.stiffness @ J
    stiffness[:, k:, k:] += np.einsum("kli,mi->mkl", swing.second, force)
    rotations = 3 * stations + 2 * SEAT_DOFS + 3 * station + np.arange(3)
    dofs = np.hstack([part.dofs, np.tile(rotations, (m, 1))])
    forces = np.einsum("mij,mi->mj", J, part.forces)
    order = np.array([*range(k - 1), *range(k, k + 3), k - 1])
    stiffness = stiffness[:, order[:, None], order]
    return [rest, replace(part, dofs=dofs[:, order], forces=forces[:, order], stiffness=stiffness)]
