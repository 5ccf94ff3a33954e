"""Coulomb friction of wire on a seat and of wire on wire: regularised, with tractions kept from step to step.

Since the last equilibrium the surfaces in contact have moved relative to each other by s: the difference of the
displacements of both centre lines, plus the contribution of the sections' rotations φ at the arms a between centre line
and surface, in the plane normal to n. With P = 1 − n nᵀ, the traction t0 of that equilibrium, the pressure p
and the tangential stiffness c of the bedding, the contact sticks or slides:

    t* = P T,  T = t0 + c s,   t = t*  if |t*| ≤ μ p,  else  μ p t*/|t*|.

The forces on both bodies do the work t · s. Their stiffness is the derivative of this projection onto the cone:

    dt = B (P dT − ((n · T) 1 + n Tᵀ) dn) + e μ dp,   B = μ p/|t*| (1 − e eᵀ),  e = t*/|t*|,

with B = 1 and e = 0 where it sticks. It is not symmetric where the contact slides, for t changes with p, p not with t.

This B has no stiffness along e: Newton's method goes past the point where a slip reverses, and back, for ever. The
tangent of an iteration has therefore the traction λ that the last correction has predicted,

    B = μ p/|t*| (1 − λ/(μ p) eᵀ),   λ = t + B Δt* + e μ Δp   of the iterate before, brought into the cone,

which is Newton's method for λ max(μ p, |t*|) = μ p t* with tractions as unknowns of their own (semi-smooth, with the
active set of what slides): where a slip reverses, it is the chord from one side of the cone to the other. λ is t in
equilibrium, and B exact. See T. Chan, G. Golub, P. Mulet, SIAM J. Sci. Comput. 20 (1999) 1964 for the idea, and
S. Hüeber, G. Stadler, B. Wohlmuth, SIAM J. Sci. Comput. 30 (2008) 572 for friction.
"""

from abc import abstractmethod
from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np

from coilset.model.core.contact.base import SEAT_DOFS, Contact, Contribution, Memory, TrialPositions
from coilset.model.core.contact.coils import Coils
from coilset.model.core.contact.curve import STENCIL, curve_weights
from coilset.model.core.contact.elements import one_sided_at
from coilset.model.core.contact.seat import Seat
from coilset.model.core.rotations.triples import Triple, axis, back, cross, dot, plus, scaled, times, triple
from coilset.model.core.rotations.vectors import chart_derivatives, rotation_derivatives
from coilset.model.core.runtime.kernels import COMPILED, njit
from coilset.model.physics.guides.hold import Guide

NODAL = 3 * STENCIL  # displacements, or rotations, of the four stations that a point depends on
Pair = tuple[np.ndarray, np.ndarray]
Tractions = tuple[np.ndarray, np.ndarray, np.ndarray]
ON_SEAT, ON_COIL = 2 * NODAL + SEAT_DOFS, 4 * NODAL  # unknowns of an element
PREDICTED = 7  # what is kept of an iterate: t*, μ p, λ


class Friction(Contact):
    """Common parts of all kinds.

    Args:
        normal: the contact that provides the pressure.
        mu: coefficient of friction.
        stations: stress-free positions, shape (n, 3), mm.
        seats: of both seats at the start, shape (12,), mm and rad.
    """

    needs_rotations = True
    has_potential = False
    memory: Memory

    def __init__(self, normal: Seat | Guide | Coils, mu: float, stations: np.ndarray, seats: np.ndarray):
        self.aside = normal.aside
        self.normal, self.mu, self.end, self.name = normal, mu, normal.end, f"{normal.name} friction"
        n = len(stations)
        rows = {"traction": normal.points.stations[:, 0], "x": np.arange(n)}
        traction = np.zeros((*normal.multiplier_offset.shape, 3))
        self.memory = Memory(rows, traction=traction, x=stations, seats=seats)
        self.first_rotation = 3 * n + 2 * SEAT_DOFS  # number of the first degree of freedom of the stations' rotations
        self._iterate = np.zeros((*traction.shape[:-1], PREDICTED))  # of the tangent before
        self._trial: tuple[tuple[np.ndarray, ...], np.ndarray]  # of the last evaluation, where it bears
        self._trial = (np.empty(0, np.int64),), np.empty((0, PREDICTED))

    @abstractmethod
    def touching(self, trial: TrialPositions) -> tuple[np.ndarray, ...]:
        """Indices into the tractions of all that bear."""

    @abstractmethod
    def dofs(self, trial: TrialPositions, at: tuple[np.ndarray, ...]) -> np.ndarray:
        """Degrees of freedom of all that bear, at indices `at` into the tractions, shape (m, k)."""

    @abstractmethod
    def rub(self, trial: TrialPositions, at: tuple[np.ndarray, ...], tractions: Tractions, room: Pair) -> None:
        """Write the forces and their derivatives.

        Args:
            trial: TrialPositions.
            at: as `touching` has found.
            tractions: of the last equilibrium, and written, of now, shape (m, 3), N; what is kept of the iterate
                before, overwritten by the same of now, shape (m, PREDICTED).
            room: written, forces and stiffness, shapes (m, k) and (m, k, k).
        """

    def evaluate(self, trial: TrialPositions) -> Contribution:
        """Tractions and their derivative."""
        if trial.rotations is None:
            raise ValueError("friction needs the stations' rotations")
        at = self.touching(trial)
        before, dofs, none = self.memory.committed("traction")[at], self.dofs(trial, at), np.zeros(len(at[0]))
        traction = np.empty_like(before)
        room, iterate = (np.empty(dofs.shape), np.empty((*dofs.shape, dofs.shape[1]))), self._iterate[at]
        if len(before):
            self.rub(trial, at, (before, traction, iterate), room)
        self._trial = at, iterate
        self.memory["traction"] = 0.0
        self.memory["traction"][at] = traction
        self.memory["x"], self.memory["seats"] = trial.x, trial.seats
        return Contribution(dofs, *room, none, none, at[0], none)

    def iterate(self) -> None:
        """Keep the last evaluation as the iterate from which a correction starts."""
        at, found = self._trial
        self._iterate[:] = 0.0
        self._iterate[at] = found

    def forget_iterate(self) -> None:
        """Forget the last iterate."""
        self._iterate[:] = 0.0

    @property
    def reach(self) -> float:
        """That of the contact that presses; see Contact."""
        return self.normal.reach

    def acts_on_seats(self, stations: np.ndarray, x: np.ndarray, seats: np.ndarray, span: np.ndarray) -> np.ndarray:
        """As the contact that presses; see Contact."""
        return self.normal.acts_on_seats(stations, x, seats, span)


class SeatFriction(Friction):
    """Wire on a seat, in its plate's frame; unknowns are four stations, the seat, and the stations' rotations."""

    normal: Seat | Guide
    _plate: tuple[np.ndarray, Pair, Pair] | None = None  # rotation vector, rotation and chart of the last evaluation

    def _turned(self, θ: np.ndarray) -> tuple[Pair, Pair]:
        """Rotation and chart of the plate with their derivatives; most plates never turn."""
        if self._plate is None or not np.array_equal(θ, self._plate[0]):
            self._plate = θ.copy(), rotation_derivatives(θ)[:2], chart_derivatives(θ)
        return self._plate[1:]

    def touching(self, trial: TrialPositions) -> tuple[np.ndarray, ...]:
        """Numbers of the points that bear."""
        seat, points = self.normal, self.normal.points
        known, seats = trial.points(points), self.poses(trial.seats)
        return (known[seat.gaps(points.at(trial.x, known), seats, known) < seat.multiplier_offset[known]],)

    def poses(self, seats: np.ndarray) -> np.ndarray:
        """Of both plates, shape (12,), where the seats are at `seats`."""
        return seats

    @cached_property
    def _dofs(self) -> np.ndarray:
        """Degrees of freedom of all points, shape (m, ON_SEAT)."""
        points = self.normal.points
        return np.hstack([self.normal.plate.dofs_with(points), self.first_rotation + points.dofs()])

    def dofs(self, trial: TrialPositions, at: tuple[np.ndarray, ...]) -> np.ndarray:
        """See Friction."""
        return self._dofs[at]

    def rub(self, trial: TrialPositions, at: tuple[np.ndarray, ...], tractions: Tractions, room: Pair) -> None:
        """See Friction."""
        (i,), seat, points, plate = at, self.normal, self.normal.points, self.normal.plate
        assert trial.rotations is not None
        seats0, seats = self.poses(self.memory.committed("seats")), self.poses(trial.seats)
        start = plate.to_seat_frame(points.at(self.memory.committed("x"), i), seats0)
        c, θ = np.split(seats[plate.own], 2)
        p = points.at(trial.x, i)
        q = plate.to_seat_frame(p, seats)
        pressure, hardness = seat.pressures(i, seat.multiplier_offset[i] - seat.gaps(p, seats, i))
        _rub_on_seat(
            np.stack([p - c, points.at(trial.rotations, i), q - start], axis=1),
            np.column_stack([points.radius[i], seat.stiffness[i], self.mu * pressure, self.mu * hardness]),
            points.weights[i],
            *seat.gap_derivatives(q),
            θ - seats0[plate.own][3:],
            *self._turned(θ),
            tractions,
            room,
        )


class GuideFriction(SeatFriction):
    """Wire on an arbor or in a sleeve: as on a seat that stays where it is and takes the forces."""

    normal: Guide

    def poses(self, seats: np.ndarray) -> np.ndarray:
        """See SeatFriction: at the origin."""
        return np.zeros_like(seats)

    @cached_property
    def _dofs(self) -> np.ndarray:
        """Degrees of freedom of all points, shape (m, 2 NODAL)."""
        points = self.normal.points
        return np.hstack([points.dofs(), self.first_rotation + points.dofs()])

    def rub(self, trial: TrialPositions, at: tuple[np.ndarray, ...], tractions: Tractions, room: Pair) -> None:
        """See Friction."""
        m, wire = len(at[0]), np.r_[:NODAL, NODAL + SEAT_DOFS : ON_SEAT]
        whole = np.empty((m, ON_SEAT)), np.empty((m, ON_SEAT, ON_SEAT))
        super().rub(trial, at, tractions, whole)
        room[0][:], room[1][:] = whole[0][:, wire], whole[1][:, wire][:, :, wire]


class CoilFriction(Friction):
    """Wire on wire; unknowns are the stations of the point and of the element that it touches, and their rotations.

    The arms reach from both centre lines to a common point between them, so that moments balance.
    """

    normal: Coils

    def touching(self, trial: TrialPositions) -> tuple[np.ndarray, ...]:
        """Numbers of the points that bear, and the places of the coils on which they do."""
        return self.normal.places(*self.normal.pressed(trial)[:2])

    def dofs(self, trial: TrialPositions, at: tuple[np.ndarray, ...]) -> np.ndarray:
        """See Friction."""
        pair, points = self.normal.pressed(trial)[0], self.normal.points
        dofs = np.hstack([points.dofs(pair[:, 0]), points.line.dofs[pair[:, 1]]])
        return np.hstack([dofs, self.first_rotation + dofs])

    def rub(self, trial: TrialPositions, at: tuple[np.ndarray, ...], tractions: Tractions, room: Pair) -> None:
        """See Friction."""
        coils, points, line = self.normal, self.normal.points, self.normal.points.line
        pair, where, offset, _ = coils.pressed(trial)
        i, e = pair[:, 0], pair[:, 1]
        _rub_on_coils(
            (trial.x, trial.rotations, line.radius),
            self.memory.committed("x"),
            (points.stations[i], line.stations[e]),
            np.array([points.weights[i], *(curve_weights(line.cubic[e], where[:, 0], order) for order in range(3))]),
            pair[:, 2] == 1,
            np.column_stack([points.radius[i], coils.stiffness[i], coils.overlap[at] + offset]),
            (coils.onset, self.mu),
            tractions,
            room,
        )


def frictions(friction: Any, contacts: list[Contact], stations: np.ndarray, seats: np.ndarray) -> list[Contact]:
    """Friction of some of the contacts.

    Args:
        friction: coefficients, the `friction` section of a case's `contact`.
        contacts: all kinds of contact.
        stations: positions, shape (n, 3), mm.
        seats: at the start, shape (12,), mm and rad.
    """
    found: list[Contact] = []
    for contact in contacts:
        if isinstance(contact, Seat) and friction.seats:
            found.append(SeatFriction(contact, friction.seats, stations, seats))
        elif isinstance(contact, Guide) and friction.guides:
            found.append(GuideFriction(contact, friction.guides, stations, seats))
        elif isinstance(contact, Coils) and friction.coils:
            found.append(CoilFriction(contact, friction.coils, stations, seats))
    return found


@njit(**COMPILED)
def _within(t: Triple, limit: float) -> Triple:
    """Shorten t to the cone."""
    size = np.sqrt(dot(t, t))
    return t if size <= limit else scaled(limit / size, t)


@njit(**COMPILED)
def _foreseen(t: Triple, limit: float, iterate: np.ndarray, before: Triple) -> Triple:
    """The traction λ that the correction from the last iterate to t* = `t` and μ p = `limit` has predicted.

    Where nothing touched then, it is that of the last equilibrium.
    """
    star, limit0, λ = triple(iterate), iterate[3], (iterate[4], iterate[5], iterate[6])
    if limit0 <= 0.0:
        return before
    size = np.sqrt(dot(star, star))
    if size <= limit0:
        return t
    e, change = scaled(1.0 / size, star), plus(t, -1.0, star)
    change = plus(scaled(limit0, change), -dot(e, change), λ)
    return plus(scaled(limit, e), 1.0 / size, change)


@njit(**COMPILED)
def on_cone(
    T: Triple, n: Triple, limit: float, before: Triple, iterate: np.ndarray
) -> tuple[Triple, tuple[Triple, Triple, float]]:
    """Project T onto the cone: the traction, e (zero where it sticks), λ/(μ p), and the factor μ p/|t*| (1 where it
    sticks). The iterate before is overwritten by this one."""
    star = plus(T, -dot(T, n), n)
    size = np.sqrt(dot(star, star))
    λ = _foreseen(star, limit, iterate, before)
    λ = _within(plus(λ, -dot(λ, n), n), limit)
    for k in range(3):
        iterate[k], iterate[4 + k] = star[k], λ[k]
    iterate[3] = limit
    if size <= limit:
        return star, ((0.0, 0.0, 0.0), λ, 1.0)
    e = scaled(1.0 / size, star)
    return scaled(limit, e), (e, scaled(1.0 / limit, λ) if limit > 0.0 else λ, limit / size)


@njit(**COMPILED)
def along_cone(
    T: Triple, n: Triple, cone: tuple[Triple, Triple, float], dT: Triple, dn: Triple, dlimit: float
) -> Triple:
    """Change of the traction in a direction in which T, n and μ p change by dT, dn, dlimit, with B as above."""
    e, λ, factor = cone
    change = plus(plus(dT, -dot(T, n), dn), -dot(T, dn) - dot(n, dT), n)
    return plus(scaled(factor, plus(change, -dot(e, change), λ)), dlimit, e)


@njit(**COMPILED)
def _spread(blocks: Sequence[int], weights: np.ndarray, local: Pair, f: np.ndarray, K: np.ndarray) -> None:
    """Write an element's forces and stiffness from those on three vectors of local unknowns.

    Args:
        blocks, weights: of each three unknowns: the local vector on which they act, and their weight in it.
        local: forces, shape (9,), and stiffness, shape (9, 9 or more).
        f, K: written, shapes (k,) and (k, k).
    """
    force, stiffness = local
    for g, to in enumerate(blocks):
        for k in range(3):
            row, own = K[3 * g + k], stiffness[3 * to + k]
            f[3 * g + k] = weights[g] * force[3 * to + k]
            for h, of in enumerate(blocks):
                w = weights[g] * weights[h]
                for l in range(3):
                    row[3 * h + l] = w * own[3 * of + l]


ON_PLATE = (0, 0, 0, 0, 0, 1, 2, 2, 2, 2)  # blocks of four stations, plate's centre and rotation, four rotations
ON_WIRE = (*(0,) * 2 * STENCIL, *(1,) * STENCIL, *(2,) * STENCIL)  # of two times four stations, and their rotations


@njit(**COMPILED)
def _rub_on_seat(
    vectors: np.ndarray,
    numbers: np.ndarray,
    weights: np.ndarray,
    normals: np.ndarray,
    bends: np.ndarray,
    turned: np.ndarray,
    rotation: Pair,
    chart: Pair,
    tractions: Tractions,
    room: Pair,
) -> None:
    """Write what points that bear on a seat do to their stations and to the seat.

    In the frame of the plate, with d from its centre to the point and ω = Rᵀ φ − (θ − θ0), the slip is
    s = q − q0 − r ω × n, and the moment about the centre line m = r n × t. In space the wire gets the force R t and the
    moment R m, the plate their reactions in its chart, Tᵀ (R m − d × R t). Local unknowns are d, θ, φ.

    Args:
        vectors: d, the section's rotation φ, and q − q0, shape (m, 3, 3).
        numbers: wire radius, tangential stiffness, μ p, and its derivative by the penetration, shape (m, 4).
        weights: of the four stations, shape (m, 4).
        normals, bends: n and its derivative by q, shapes (m, 3) and (m, 3, 3).
        turned: θ − θ0 of the plate, shape (3,).
        rotation, chart: R and T of the plate, each with its derivatives by θ, shapes (3, 3) and (3, 3, 3).
        tractions: see Friction.rub, in the frame of the plate.
        room: forces and stiffness, written, shapes (m, ON_SEAT) and (m, ON_SEAT, ON_SEAT).
    """
    (R, dR), (C, dC), (before, traction, iterate), none = rotation, chart, tractions, (0.0, 0.0, 0.0)
    force, K, all_weights = np.empty(9), np.empty((9, 9)), np.ones(ON_SEAT // 3)
    all_weights[STENCIL] = -1.0
    for e in range(len(vectors)):
        d, φ, moved = triple(vectors[e, 0]), triple(vectors[e, 1]), triple(vectors[e, 2])
        r, c, limit, hardness = numbers[e]
        n = triple(normals[e])
        ω = plus(back(R, φ), -1.0, triple(turned))
        T = plus(triple(before[e]), c, plus(moved, -r, cross(ω, n)))
        t, cone = on_cone(T, n, limit, triple(before[e]), iterate[e])
        m = scaled(r, cross(n, t))
        push, turn = times(R, t), times(R, m)
        on_plate = plus(turn, -1.0, cross(d, push))
        in_chart = back(C, on_plate)
        for k in range(3):
            traction[e, k], force[k], force[3 + k], force[6 + k] = t[k], push[k], in_chart[k], -turn[k]
        for j in range(9):
            k, of = j % 3, j // 3
            dd, dq, dω = none, none, none
            if of == 0:
                dd, dq = axis(k), triple(R[k])
            elif of == 1:
                dq, dω = back(dR[k], d), plus(back(dR[k], φ), -1.0, axis(k))
            else:
                dω = triple(R[k])
            dn = times(bends[e], dq)
            dT = scaled(c, plus(dq, -r, plus(cross(dω, n), 1.0, cross(ω, dn))))
            dt = along_cone(T, n, cone, dT, dn, -hardness * dot(n, dq))
            dm = scaled(r, plus(cross(dn, t), 1.0, cross(n, dt)))
            dpush, dturn, dchart = times(R, dt), times(R, dm), none
            if of == 1:
                dpush, dturn = plus(dpush, 1.0, times(dR[k], t)), plus(dturn, 1.0, times(dR[k], m))
                dchart = back(dC[k], on_plate)
            across = plus(cross(dd, push), 1.0, cross(d, dpush))
            dchart = plus(dchart, 1.0, back(C, plus(dturn, -1.0, across)))
            for l in range(3):
                K[l, j], K[3 + l, j], K[6 + l, j] = dpush[l], dchart[l], -dturn[l]
        for a in range(STENCIL):
            all_weights[a] = all_weights[STENCIL + 2 + a] = weights[e, a]
        _spread(ON_PLATE, all_weights, (force, K), room[0][e], room[1][e])


@njit(**COMPILED)
def _rub_on_coils(
    now: tuple[np.ndarray, np.ndarray, np.ndarray],
    start: np.ndarray,
    stations: Pair,
    weights: np.ndarray,
    inside: np.ndarray,
    numbers: np.ndarray,
    laws: tuple[float, float],
    tractions: Tractions,
    room: Pair,
) -> None:
    """Write what pairs of a point and a location on another coil do to the stations of both.

    With q from the location to the point, d = |q| and the radii r of both, the arms are a = d r/(r + r') and
    a' = d r'/(r + r'), and the slip is s = D − (a φ + a' φ') × n, where D is the displacement of the point relative to
    that of the other curve at ξ. Moments about the centre lines are a n × t and a' n × t. Local unknowns are D, φ, φ';
    to their stiffness comes what follows from the change of ξ, which stays where the gap is least, see
    elements.coil_elements.

    Args:
        now: of the stations, positions and rotations, shape (n, 3), and radii.
        start: positions at the last equilibrium, shape (n, 3), mm.
        stations: of the points and of the elements that they touch, shapes (m, 4).
        weights: those of the points, and of the locations with two derivatives by ξ, shape (4, m, 4).
        inside: whether the location is inside the wire.
        numbers: wire radius at the point, tangential stiffness, and the gap at which they touch, shape (m, 3).
        laws: distance over which contact sets in, mm, and μ.
        tractions: see Friction.rub.
        room: forces and stiffness, written, shapes (m, ON_COIL) and (m, ON_COIL, ON_COIL).
    """
    (x, rotations, radii), (onset, μ), (before, traction, iterate) = now, laws, tractions
    none = (0.0, 0.0, 0.0)
    force, K, w, dw, slope = np.empty(9), np.empty((9, 10)), np.empty(16), np.zeros(16), np.zeros(24)
    for e in range(len(inside)):
        own, others, (r, c, shift) = stations[0][e], stations[1][e], numbers[e]
        q = moved = φ = φ2 = tangent = bend = moved_by_ξ = φ2_by_ξ = none
        r2 = r2_by_ξ = r2_bend = 0.0
        for a in range(STENCIL):
            i, o = own[a], others[a]
            W, N, dN, ddN = weights[0, e, a], weights[1, e, a], weights[2, e, a], weights[3, e, a]
            w[a], w[4 + a], w[8 + a], w[12 + a], dw[4 + a], dw[12 + a] = W, -N, W, N, -dN, dN
            there, shifted = triple(x[o]), plus(triple(x[o]), -1.0, triple(start[o]))
            q = plus(plus(q, W, triple(x[i])), -N, there)
            moved = plus(plus(moved, W, plus(triple(x[i]), -1.0, triple(start[i]))), -N, shifted)
            tangent, bend, moved_by_ξ = plus(tangent, dN, there), plus(bend, ddN, there), plus(moved_by_ξ, -dN, shifted)
            turned = triple(rotations[o])
            φ, φ2, φ2_by_ξ = plus(φ, W, triple(rotations[i])), plus(φ2, N, turned), plus(φ2_by_ξ, dN, turned)
            r2, r2_by_ξ, r2_bend = r2 + N * radii[o], r2_by_ξ + dN * radii[o], r2_bend + ddN * radii[o]
        d = np.sqrt(dot(q, q))
        n = scaled(1.0 / d, q)
        pressure, hardness = one_sided_at(d - r - r2 - shift, c, onset)
        arm, arm2 = d * r / (r + r2), d * r2 / (r + r2)
        swing = plus(scaled(arm, φ), arm2, φ2)
        T = plus(triple(before[e]), c, plus(moved, -1.0, cross(swing, n)))
        t, cone = on_cone(T, n, μ * pressure, triple(before[e]), iterate[e])
        roll = cross(n, t)
        for k in range(3):
            traction[e, k], force[k], force[3 + k], force[6 + k] = t[k], t[k], -arm * roll[k], -arm2 * roll[k]
        for j in range(10):
            of, dq, dD, dφ, dφ2, dr2 = j // 3, none, none, none, none, 0.0
            if of == 0:
                dq = dD = axis(j)
            elif of == 1:
                dφ = axis(j - 3)
            elif of == 2:
                dφ2 = axis(j - 6)
            else:
                dq, dD, dφ2, dr2 = scaled(-1.0, tangent), moved_by_ξ, φ2_by_ξ, r2_by_ξ
            dd = dot(n, dq)
            dn = scaled(1.0 / d, plus(dq, -dd, n))
            part = d / (r + r2) ** 2 * dr2
            darm, darm2 = r * (dd / (r + r2) - part), dd * r2 / (r + r2) + r * part
            dswing = plus(plus(plus(scaled(darm, φ), darm2, φ2), arm, dφ), arm2, dφ2)
            dT = scaled(c, plus(plus(dD, -1.0, cross(dswing, n)), -1.0, cross(swing, dn)))
            dt = along_cone(T, n, cone, dT, dn, μ * hardness * (dr2 - dd))
            droll = plus(cross(dn, t), 1.0, cross(n, dt))
            for l in range(3):
                K[l, j], K[3 + l, j] = dt[l], -darm * roll[l] - arm * droll[l]
                K[6 + l, j] = -darm2 * roll[l] - arm2 * droll[l]
        forces, stiffness = room[0][e], room[1][e]
        _spread(ON_WIRE, w, (force, K), forces, stiffness)
        across = scaled(1.0 / d, plus(tangent, -dot(n, tangent), n))  # P c' of elements.coil_elements
        second = dot(tangent, across) - dot(n, bend) - r2_bend
        if not (inside[e] and second > 0.0):
            continue
        for g in range(8):
            for k in range(3):
                slope[3 * g + k] = (w[g] * across[k] - dw[g] * n[k]) / second
        for g, of in enumerate(ON_WIRE):
            for k in range(3):
                by_ξ = w[g] * K[3 * of + k, 9] + dw[g] * force[3 * of + k]
                for u in range(24):
                    stiffness[3 * g + k, u] += by_ξ * slope[u]
