"""Coulomb friction of wire on a seat and of wire on wire: regularised, with tractions kept from step to step.

Since the last equilibrium the surfaces in contact have moved relative to each other by s: the difference of the
displacements of both centre lines, plus the contribution of the sections' rotations θ at the arms a between centre line
and surface, in the plane normal to n. With P = 1 − n nᵀ, the traction t0 of that equilibrium, the pressure p
and the tangential stiffness c of the bedding, the contact sticks or slides:

    t* = P t0 + c s,   t = t*  if |t*| ≤ μ p,  else  μ p t*/|t*|.

The forces on both bodies do the work t · s. Their derivative is computed by the complex step, f′ = Im f(u + i h)/h,
which is exact to rounding; it includes the change of p, and is not symmetric where the contact slides.
"""

from abc import abstractmethod

import numpy as np

from coilset.model.contact.base import SEAT_DOFS, Contact, Contribution, TrialPositions, one_sided
from coilset.model.contact.coils import Coils
from coilset.model.contact.curve import STENCIL, curve_weights
from coilset.model.contact.memory import Memory
from coilset.model.contact.seat import Seat
from coilset.model.rotations.vectors import moment_to_chart, rotate, rotate_back

COMPLEX_STEP = 1e-30  # in mm and rad
NODAL = 3 * STENCIL  # displacements, or rotations, of the four stations that a point depends on


def dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Scalar products over the last axis, which is kept; also for complex numbers."""
    return (a * b).sum(axis=-1, keepdims=True)


def spread(weights: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Distribute vectors of points, shape (m, 3), over their stations, shape (m, 12)."""
    return (weights[:, :, None] * vectors[:, None, :]).reshape(len(vectors), NODAL)


def nodal(u: np.ndarray, first: int) -> np.ndarray:
    """The stations' vectors in the columns from `first` on, shape (m, 4, 3)."""
    return u[:, first : first + NODAL].reshape(len(u), STENCIL, 3)


def mean(weights: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Vectors of the stations, shape (m, 4, 3), at the points, shape (m, 3)."""
    return (weights[:, :, None] * vectors).sum(axis=1)


class Friction(Contact):
    """Common parts of both kinds.

    Args:
        normal: the contact that provides the pressure.
        mu: coefficient of friction.
        stations: stress-free positions, shape (n, 3), mm.
        seats: of both seats at the start, shape (12,), mm and rad.
    """

    needs_rotations = True
    memory: Memory

    def __init__(self, normal: Seat | Coils, mu: float, stations: np.ndarray, seats: np.ndarray):
        self.aside = normal.aside
        self.normal, self.mu, self.end, self.name = normal, mu, normal.end, f"{normal.name} friction"
        n = len(stations)
        rows = {"traction": normal.points.stations[:, 0], "x": np.arange(n)}
        traction = np.zeros((*normal.multiplier_offset.shape, 3))
        self.memory = Memory(rows, traction=traction, x=stations, seats=seats)
        self.first_rotation = 3 * n + 2 * SEAT_DOFS  # number of the first degree of freedom of the stations' rotations

    @abstractmethod
    def touching(self, trial: TrialPositions) -> tuple[tuple, np.ndarray, tuple]:
        """Points that bear, their degrees of freedom, and what stays the same while these vary."""

    @abstractmethod
    def forces(self, u: np.ndarray, before: np.ndarray, *constants: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Forces on the variables `u`, of its shape, N, and tractions, shape (m, 3), N; also if complex.

        Args:
            u: variables of each point that bears, shape (m, k), mm and rad.
            before: tractions of the last equilibrium, shape (m, 3), N.
            constants: as returned by `touching`.
        """

    def evaluate(self, trial: TrialPositions) -> Contribution:
        """Tractions and their derivative."""
        x, seats, rotations = trial.x, trial.seats, trial.rotations
        if rotations is None:
            raise ValueError("friction needs the stations' rotations")
        at, dofs, constants = self.touching(trial)
        u = np.concatenate([x.ravel(), seats, rotations.ravel()])[dofs]
        constants = (self.memory.committed("traction")[at], *constants)
        force, traction = self.forces(u, *constants)
        m, k = u.shape
        moved = u + 1j * COMPLEX_STEP * np.eye(k)[:, None]  # one variable after the other, for all elements at once
        copies = (np.concatenate([values] * k) for values in constants)
        moved = self.forces(moved.reshape(k * m, k), *copies)[0].imag.reshape(k, m, k) / COMPLEX_STEP
        stiffness = np.ascontiguousarray(np.moveaxis(moved, 0, 2))
        self.memory["traction"] = np.zeros_like(self.memory["traction"])
        self.memory["traction"][at] = traction
        self.memory["x"], self.memory["seats"] = x.copy(), seats.copy()
        none = np.zeros(len(force))
        return Contribution(dofs, force, stiffness, none, none, at[0], none)

    @property
    def reach(self) -> float:
        """That of the contact that presses; see Contact."""
        return self.normal.reach

    def acts_on_seats(self, stations: np.ndarray, x: np.ndarray, seats: np.ndarray, span: np.ndarray) -> np.ndarray:
        """As the contact that presses; see Contact."""
        return self.normal.acts_on_seats(stations, x, seats, span)

    def slide(
        self, before: np.ndarray, slip: np.ndarray, n: np.ndarray, pressure: np.ndarray, c: np.ndarray
    ) -> np.ndarray:
        """The traction after a slip."""
        trial = before + c[:, None] * slip
        trial = trial - dot(trial, n) * n
        size, limit = np.sqrt(dot(trial, trial) + 1e-300), self.mu * pressure[:, None]
        return np.where(size.real <= limit.real, trial, limit / size * trial)


class SeatFriction(Friction):
    """Wire on a seat, in its plate's frame; variables are four stations, the seat, and the stations' rotations."""

    normal: Seat

    def touching(self, trial: TrialPositions) -> tuple[tuple, np.ndarray, tuple]:
        """Points that bear, their degrees of freedom, and what stays the same while these vary."""
        seat, points = self.normal, self.normal.points
        known = trial.points(points)
        i = known[seat.gaps(points.at(trial.x, known), trial.seats, known) < seat.multiplier_offset[known]]
        rotations = self.first_rotation + points.dofs(i)
        plate = np.broadcast_to(seat.plate.dofs, (len(i), SEAT_DOFS))
        seats0 = self.memory.committed("seats")
        q0 = seat.plate.to_seat_frame(points.at(self.memory.committed("x"), i), seats0)
        θ0 = np.broadcast_to(seats0[seat.plate.own][3:], q0.shape)
        return (i,), np.hstack([points.dofs(i), plate, rotations]), (i, q0, θ0)

    def forces(self, u: np.ndarray, before: np.ndarray, *constants: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Forces on the variables, shape (m, 30), and tractions, shape (m, 3)."""
        (i, q0, θ0), seat = constants, self.normal
        w, r = seat.points.weights[i], seat.points.radius[i][:, None]
        c, θ = u[:, NODAL : NODAL + 3], u[:, NODAL + 3 : NODAL + 6]
        d = mean(w, nodal(u, 0)) - c
        q = rotate_back(d, θ)
        n, gap = seat.surface(q)
        p = seat.pressures(i, seat.distance[i] + seat.multiplier_offset[i] - gap)
        ω = rotate_back(mean(w, nodal(u, NODAL + SEAT_DOFS)), θ) - (θ - θ0)
        t = self.slide(before, q - q0 - r * np.cross(ω, n), n, p, seat.stiffness[i])
        on_wire, roll = rotate(t, θ), rotate(r * np.cross(n, t), θ)
        on_seat = moment_to_chart(roll - np.cross(d, on_wire), θ)
        return np.hstack([spread(w, on_wire), -on_wire, on_seat, spread(w, -roll)]), t


class CoilFriction(Friction):
    """Wire on wire; variables are the stations of the point and of the element that it touches, and their rotations.

    The arms reach from both centre lines to a common point between them, so that moments balance.
    """

    normal: Coils

    def touching(self, trial: TrialPositions) -> tuple[tuple, np.ndarray, tuple]:
        """Pairs that bear, their degrees of freedom, and what stays the same while these vary."""
        coils, points, line = self.normal, self.normal.points, self.normal.points.line
        pair, where, offset, _ = coils.pressed(trial)
        i, e = pair[:, 0], pair[:, 1]
        dofs = np.hstack([points.dofs(i), line.dofs[e]])
        start = self.memory.committed("x")
        at = coils.places(pair, where)
        shift = coils.overlap[at] + offset
        x0, y0 = start[points.stations[i]], start[line.stations[e]]
        return at, np.hstack([dofs, self.first_rotation + dofs]), (i, e, where[:, 0], pair[:, 2] == 1, shift, x0, y0)

    def forces(self, u: np.ndarray, before: np.ndarray, *constants: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Forces on the variables, shape (m, 48), and tractions, shape (m, 3)."""
        i, e, xi, inside, shift, x0, y0 = constants
        coils, points, line = self.normal, self.normal.points, self.normal.points.line
        w, r, radii = points.weights[i], points.radius[i][:, None], line.radius[line.stations[e]]
        X, Y, p = nodal(u, 0), nodal(u, NODAL), mean(w, nodal(u, 0))
        ξ = nearest(p, Y, radii, line.cubic[e], xi, inside)
        N = curve_weights(line.cubic[e], ξ)
        q = p - mean(N, Y)
        d, other = np.sqrt(dot(q, q)), dot(N, radii)
        n = q / d
        pressure, _ = one_sided((d - r - other)[:, 0] - shift, coils.stiffness[i], coils.onset)
        arms = d * r / (r + other), d * other / (r + other)
        swing = arms[0] * mean(w, nodal(u, 2 * NODAL)) + arms[1] * mean(N, nodal(u, 3 * NODAL))
        slip = mean(w, X - x0) - mean(N, Y - y0) - np.cross(swing, n)
        t = self.slide(before, slip, n, pressure, coils.stiffness[i])
        roll = np.cross(n, t)
        parts = [spread(w, t), spread(N, -t), spread(w, -arms[0] * roll), spread(N, -arms[1] * roll)]
        return np.hstack(parts), t


def nearest(
    p: np.ndarray, Y: np.ndarray, radii: np.ndarray, cubic: np.ndarray, ξ: np.ndarray, inside: np.ndarray
) -> np.ndarray:
    """ξ nearest to `p` by one step of Newton's method from the one that is known, exact to first order."""
    N, dN, ddN = (curve_weights(cubic, ξ, order) for order in range(3))
    q, dc, ddc = p - mean(N, Y), mean(dN, Y), mean(ddN, Y)
    d = np.sqrt(dot(q, q))
    n = q / d
    slope = -dot(n, dc) - dot(dN, radii)
    second = (dot(dc, dc) - dot(n, dc) ** 2) / d - dot(n, ddc) - dot(ddN, radii)
    return np.where(inside, ξ - (slope / second)[:, 0], ξ)
