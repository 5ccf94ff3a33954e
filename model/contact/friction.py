"""Coulomb friction of wire on a seat and of wire on wire: regularised, its traction kept from step to step.

Since the last equilibrium the surfaces have slipped past each other where they touch by s: the difference of the
displacements of both centre lines, and of what the turns θ of the sections add at the arms a between centre line and
surface, in the plane across the normal n. With P = 1 − n nᵀ, the traction t0 of that equilibrium, the pressure p and
the stiffness c of the bedding along the surface, the traction sticks or slides:

    t* = P t0 + c s,   t = t*  if |t*| ≤ μ p,  else  μ p t*/|t*|.

The forces on both bodies do the work t · s. Their derivative is taken by the complex step, f′ = Im f(u + i h)/h, which
is exact to rounding; it is not symmetric where the traction slides, and follows p.
"""

import numpy as np

from coilset.model.contact.base import SEAT_DOFS, Contribution, one_sided
from coilset.model.contact.centreline import STENCIL
from coilset.model.contact.memory import Memory

STEP = 1e-30  # complex step
NODAL = 3 * STENCIL  # displacements, or turns, of the four stations that a point hangs on


def dot(a, b):
    """Scalar products of the last axis, which stays; also for complex numbers."""
    return (a * b).sum(axis=-1, keepdims=True)


def spread(weights, vectors):
    """Share vectors of points, shape (m, 3), out over their stations, shape (m, 12)."""
    return (weights[:, :, None] * vectors[:, None, :]).reshape(len(vectors), NODAL)


def nodal(u, first):
    """The stations' vectors in the columns from `first` on, shape (m, 4, 3)."""
    return u[:, first : first + NODAL].reshape(len(u), STENCIL, 3)


def mean(weights, vectors):
    """Vectors of the stations, shape (m, 4, 3), at the points, shape (m, 3)."""
    return (weights[:, :, None] * vectors).sum(axis=1)


class Friction:
    """What both kinds share.

    Args:
        normal: the contact whose pressure it goes with.
        mu: coefficient of friction.
        stations: stress-free positions, shape (n, 3), mm.
        seats: of both seats at the start, shape (12,), mm and rad.
    """

    guarded, points = False, None
    rolls = True  # it asks for the turns of the stations

    def __init__(self, normal, mu, stations, seats):
        self.normal, self.mu, self.end, self.name = normal, mu, normal.end, f"{normal.name} friction"
        self.memory = Memory(traction=np.zeros((*normal.memory["lift"].shape, 3)), x=stations, seats=seats)
        n = len(stations)
        self.turning = 3 * n + 2 * SEAT_DOFS  # first degree of freedom of the turns

    def depth(self, x, seats):
        """Its contact says how deep it is."""
        return 0.0

    def augment(self, x, seats):
        """Its contact is augmented."""

    def evaluate(self, x, seats, turns):
        """Tractions and their derivative at station positions, seats, and turns since the last equilibrium, (n, 3)."""
        at, dofs, constants = self.touching(x, seats)
        u = np.concatenate([x.ravel(), seats, turns.ravel()])[dofs]
        constants = [self.memory.committed("traction")[at], *constants]
        force, traction = self.forces(u, *constants)
        m, k = u.shape
        moved = u + 1j * STEP * np.eye(k)[:, None]  # one variable after the other, for all elements at once
        constants = [np.concatenate([values] * k) for values in constants]
        moved = self.forces(moved.reshape(k * m, k), *constants)[0].imag.reshape(k, m, k) / STEP
        stiffness = np.ascontiguousarray(np.moveaxis(moved, 0, 2))
        self.memory["traction"] = np.zeros_like(self.memory["traction"])
        self.memory["traction"][at] = traction
        self.memory["x"], self.memory["seats"] = x.copy(), seats.copy()
        none = np.zeros(len(force))
        return Contribution(dofs, force, stiffness, none, none, at[0])

    def slide(self, before, slip, n, pressure, c):
        """The traction after a slip."""
        trial = before + c[:, None] * slip
        trial = trial - dot(trial, n) * n
        size, limit = np.sqrt(dot(trial, trial) + 1e-300), self.mu * pressure[:, None]
        return np.where(size.real <= limit.real, trial, limit / size * trial)


class SeatFriction(Friction):
    """Wire on a seat, in its plate's coordinates; variables are four stations, the seat, and the stations' turns."""

    def touching(self, x, seats):
        """Points that bear, their degrees of freedom, and what stays the same while these vary."""
        seat, points = self.normal, self.normal.points
        i = np.flatnonzero(seat.gaps(points.at(x), seats) < seat.memory["lift"])
        turns = self.turning + points.dofs[i]
        plate = np.broadcast_to(seat.plate.dofs, (len(i), SEAT_DOFS))
        seats0 = self.memory.committed("seats")
        q0 = seat.plate.sees(points.at(self.memory.committed("x"))[i], seats0)
        θ0 = np.broadcast_to(seats0[seat.plate.own][3:], q0.shape)
        return (i,), np.hstack([points.dofs[i], plate, turns]), (i, q0, θ0)

    def forces(self, u, before, i, q0, θ0):
        """Forces on the variables, shape (m, 30), and tractions, shape (m, 3)."""
        seat = self.normal
        w, r = seat.points.weights[i], seat.points.radius[i][:, None]
        c, θ = u[:, NODAL : NODAL + 3], u[:, NODAL + 3 : NODAL + 6]
        d = mean(w, nodal(u, 0)) - c
        q = turned(d, θ, -1.0)
        n, gap = seat.surface(q)
        p = seat.pressures(i, seat.reach[i] + seat.memory["lift"][i] - gap)
        ω = turned(mean(w, nodal(u, NODAL + SEAT_DOFS)), θ, -1.0) - (θ - θ0)
        t = self.slide(before, q - q0 - r * np.cross(ω, n), n, p, seat.stiffness[i])
        on_wire, roll = turned(t, θ, 1.0), turned(r * np.cross(n, t), θ, 1.0)
        on_seat = by_turn(roll - np.cross(d, on_wire), θ)
        return np.hstack([spread(w, on_wire), -on_wire, on_seat, spread(w, -roll)]), t


def series(θ):
    """sin α/α, (1 − cos α)/α² and (α − sin α)/α³ for α = |θ|, also if complex, shape (m, 1)."""
    square = dot(θ, θ)
    small = np.abs(square) < 1e-4
    α = np.sqrt(np.where(small, 1.0, square))
    exact = np.sin(α) / α, (1.0 - np.cos(α)) / α**2, (α - np.sin(α)) / α**3
    # the next terms are below 1e-17
    near = [1 / f - square / g + square**2 / h - square**3 / k
            for f, g, h, k in ((1, 6, 120, 5040), (2, 24, 720, 40320), (6, 120, 5040, 362880))]  # fmt: skip
    return [np.where(small, a, b) for a, b in zip(near, exact, strict=True)]


def turned(v, θ, sign):
    """A v for the sign −1, Aᵀ v for +1, with A = exp(−[θ]) of plate.py."""
    s, c, _ = series(θ)
    across = np.cross(θ, v)
    return v + sign * s * across + c * np.cross(θ, across)


def by_turn(M, θ):
    """What belongs to θ of a moment M: Jᵀ M of plate.py."""
    _, c, b = series(θ)
    across = np.cross(θ, M)
    return M - c * across + b * np.cross(θ, across)


class CoilFriction(Friction):
    """Wire on wire; variables are the stations of the point and of the place on the other coil, and their turns.

    The arms reach from both centre lines to one point between them, so that no moment is left over.
    """

    def touching(self, x, seats):
        """Pairs that bear, their degrees of freedom, and what stays the same while these vary."""
        coils, points, line = self.normal, self.normal.points, self.normal.points.line
        pair, where, lift, _ = coils.pressed(x)
        i, e = pair[:, 0], pair[:, 1]
        dofs = np.hstack([points.dofs[i], line.dofs[e]])
        start = self.memory.committed("x")
        at = coils.sides(pair)
        shift = coils.overlap[at] + lift
        x0, y0 = start[points.stations[i]], start[line.stations[e]]
        return at, np.hstack([dofs, self.turning + dofs]), (i, e, where[:, 0], pair[:, 2] == 1, shift, x0, y0)

    def forces(self, u, before, i, e, xi, inside, shift, x0, y0):
        """Forces on the variables, shape (m, 48), and tractions, shape (m, 3)."""
        coils, points, line = self.normal, self.normal.points, self.normal.points.line
        w, r, radii = points.weights[i], points.radius[i][:, None], line.radius[line.stations[e]]
        X, Y, p = nodal(u, 0), nodal(u, NODAL), mean(w, nodal(u, 0))
        ξ = nearest(p, Y, radii, line.cubic[e], xi, inside)
        N = along(line.cubic[e], ξ, 0)
        q = p - mean(N, Y)
        d, other = np.sqrt(dot(q, q)), dot(N, radii)
        n = q / d
        pressure, _ = one_sided((d - r - other)[:, 0] - shift, coils.stiffness[i], coils.onset)
        arms = d * r / (r + other), d * other / (r + other)
        turn = arms[0] * mean(w, nodal(u, 2 * NODAL)) + arms[1] * mean(N, nodal(u, 3 * NODAL))
        slip = mean(w, X - x0) - mean(N, Y - y0) - np.cross(turn, n)
        t = self.slide(before, slip, n, pressure, coils.stiffness[i])
        roll = np.cross(n, t)
        parts = [spread(w, t), spread(N, -t), spread(w, -arms[0] * roll), spread(N, -arms[1] * roll)]
        return np.hstack(parts), t


def along(cubic, ξ, order):
    """Weights of the four stations at ξ, or their derivatives by it, shape (m, 4)."""
    powers = {
        0: [ξ**0, ξ, ξ**2, ξ**3],
        1: [0.0 * ξ, ξ**0, 2.0 * ξ, 3.0 * ξ**2],
        2: [0.0 * ξ, 0.0 * ξ, 2.0 * ξ**0, 6.0 * ξ],
    }[order]
    return np.einsum("mkp,pm->mk", cubic, np.array(powers))


def nearest(p, Y, radii, cubic, ξ, inside):
    """The place nearest to `p` by one step of Newton's method from the one that is known, exact to first order."""
    N, dN, ddN = (along(cubic, ξ, order) for order in range(3))
    q, dc, ddc = p - mean(N, Y), mean(dN, Y), mean(ddN, Y)
    d = np.sqrt(dot(q, q))
    n = q / d
    slope = -dot(n, dc) - dot(dN, radii)
    second = (dot(dc, dc) - dot(n, dc) ** 2) / d - dot(n, ddc) - dot(ddN, radii)
    return np.where(inside, ξ - (slope / second)[:, 0], ξ)
