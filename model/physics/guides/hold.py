"""Lateral support: of an end coil by a groove, of an arm by a point, of coils by arbor or sleeve; and of the seat."""

import numpy as np
from numpy.typing import ArrayLike

from coilset.model.core.contact.base import Contact, Contribution, Memory, TrialPositions, one_sided
from coilset.model.core.contact.curve import STENCIL, WirePoints
from coilset.model.core.contact.plate import Plate, radial


class Groove(Contact):
    """The end coil is in a smooth round groove of its seat, its tip against the groove's end.

    Each point keeps its stress-free distance from the seat's axis by the potential ½ c (ρ − ρ0)², the tip its position
    along the groove by ½ c (s − s0)². Both sides of the groove support the wire, whether it is on the bottom or not.
    Along the groove and away from the seat the wire is free, and it may roll and tilt: the seat takes no moment except
    that of forces.

    Args:
        end: `bottom` or `top`.
        points: WirePoints.
        turns: length of the groove from the tip, in turns.
        stations: stress-free positions, shape (n, 3), mm.
        bedding: force per length of wire and displacement, N/mm per mm.
        seats: of both seats at the stress-free state, shape (12,).
    """

    aside = STENCIL  # no other part of the wire matters

    def __init__(
        self, end: str, points: WirePoints, turns: float, stations: np.ndarray, bedding: float, seats: np.ndarray
    ):
        self.name, self.end = f"{end} groove", end
        self.plate, self.wire = Plate(end, len(stations)), points
        tip = points.tip(end)
        inside = np.flatnonzero(np.abs(points.turns - points.turns[tip]) <= turns + 1e-9)
        self.at, self.stop = np.append(inside, tip), len(inside)  # the last element is the groove's end
        self.stiffness = bedding * np.append(points.length[inside], 2.0 * points.radius[tip])
        self.dofs = self.plate.dofs_with(points)[self.at]
        q = self.plate.to_seat_frame(points.at(stations)[self.at], seats)
        along = np.array([-q[-1, 1], q[-1, 0], 0.0])
        self.along = along / np.linalg.norm(along)
        self.start = np.append(np.hypot(*q[:-1, :2].T), q[-1] @ self.along)

    def evaluate(self, trial: TrialPositions) -> Contribution:
        """Forces across the groove, and along it at its end."""
        own = np.flatnonzero(np.isin(self.at, trial.points(self.wire)))
        at, stiffness = self.at[own], self.stiffness[own]
        p = self.wire.at(trial.x, at)
        s, g, H = self.held(self.plate.to_seat_frame(p, trial.seats), own)
        force = stiffness * (s - self.start[own])
        grad, hessian = self.plate.derivatives(p, trial.seats, self.wire.weights[at], g, H)
        k = stiffness[:, None, None] * grad[:, :, None] * grad[:, None, :] + force[:, None, None] * hessian
        none = np.zeros(len(force))
        return Contribution(self.dofs[own], force[:, None] * grad, k, none, none, at, none)

    def held(self, q: np.ndarray, own: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """What is held of the points `q` in the plate's frame, mm, with two derivatives; `own`: their elements."""
        s, g, H = radial(q)
        end = own == self.stop
        s[end], g[end], H[end] = q[end] @ self.along, self.along, 0.0
        return s, g, H

    def acts_on_seats(self, stations: np.ndarray, x: np.ndarray, seats: np.ndarray, span: np.ndarray) -> np.ndarray:
        """Those of the groove; see Contact."""
        return np.isin(stations, self.wire.stations[self.at])


class Support(Groove):
    """The end of an arm is in a smooth straight slot of its head, along the arm.

    It keeps both its positions across the slot by the potential ½ c (s − s0)², slides along it, and tilts freely.

    Args:
        end: `bottom` or `top`.
        points: WirePoints.
        stations: stress-free positions, shape (n, 3), mm.
        bedding: force per length of wire and displacement, N/mm per mm.
        seats: of both heads at the stress-free state, shape (12,).
        along: direction of the slot, unit vector, shape (3,).
    """

    def __init__(
        self, end: str, points: WirePoints, stations: np.ndarray, bedding: float, seats: np.ndarray, along: np.ndarray
    ):
        self.name, self.end = f"{end} support", end
        self.plate, self.wire = Plate(end, len(stations)), points
        tip = points.tip(end)
        self.at, self.stiffness = np.array([tip, tip]), np.full(2, bedding * 2.0 * points.radius[tip])
        self.dofs = self.plate.dofs_with(points)[self.at]
        self.across = np.linalg.svd(along[None])[2][1:]
        q = self.plate.to_seat_frame(points.at(stations)[self.at], seats)
        self.start = np.sum(q * self.across, axis=1)

    def held(self, q: np.ndarray, own: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """See Groove."""
        across = self.across[own]
        return np.sum(q * across, axis=1), across, np.zeros((len(q), 3, 3))


class Guide(Contact):
    """A smooth rigid cylinder about the spring's axis, fixed in space: an arbor inside the coils, or a sleeve around.

    The gap is the distance of the centre line from the cylinder less the wire's radius, g = ±(ρ − R) − r.

    Args:
        name: `arbor` or `sleeve`.
        points: WirePoints.
        radius: R of the cylinder, mm.
        bedding: force per length of wire and penetration, N/mm per mm.
        onset: distance over which contact sets in, mm.
    """

    limits_step = True
    points: WirePoints
    memory: Memory
    multiplier_offset: np.ndarray
    aside = STENCIL  # no other part of the wire matters

    def __init__(self, name: str, points: WirePoints, radius: float, bedding: float, onset: float):
        self.name = self.end = name
        self.points, self.radius, self.onset = points, radius, onset
        self.plate = Plate("bottom", len(points.line.turns))  # for friction: the frame of a plate that never moves
        self.side = 1.0 if name == "arbor" else -1.0
        self.lengths, self.stiffness, self.dofs = points.length, bedding * points.length, points.dofs()
        self.memory = Memory({"multiplier_offset": points.stations[:, 0]}, multiplier_offset=np.zeros(len(points)))
        self.multiplier_offset = self.memory["multiplier_offset"]

    def gaps(self, p: np.ndarray, seats: np.ndarray, points: np.ndarray) -> np.ndarray:
        """Gaps of the `points` at `p`, shape (m, 3), negative for penetration, mm; wherever the seats are."""
        return self.side * (np.hypot(p[:, 0], p[:, 1]) - self.radius) - self.points.radius[points]

    def evaluate(self, trial: TrialPositions) -> Contribution:
        """Forces across the cylinder's surface, for the points that touch."""
        points = trial.points(self.points)
        p, offset = self.points.at(trial.x, points), self.multiplier_offset[points]
        gap = self.gaps(p, trial.seats, points)
        found = np.flatnonzero(gap < offset)
        at, p, gap = points[found], p[found], gap[found]
        force, c = self.pressures(at, offset[found] - gap)
        weights, (normal, bend) = self.points.weights[at], self.gap_derivatives(p)
        grad = (weights[:, :, None] * normal[:, None, :]).reshape(len(at), 3 * STENCIL)
        k = c[:, None, None] * normal[:, :, None] * normal[:, None, :] - force[:, None, None] * bend
        k = np.einsum("ma,mij,mb->maibj", weights, k, weights).reshape(len(at), 3 * STENCIL, 3 * STENCIL)
        onset_force = self.stiffness[at] * self.onset
        return Contribution(self.dofs[at], -force[:, None] * grad, k, force, -gap, at, onset_force)

    def pressures(self, i: np.ndarray, pressed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Forces on the points `i` for penetrations `pressed`, mm: N, and their derivatives, N/mm."""
        return one_sided(-pressed, self.stiffness[i], self.onset)

    def gap_derivatives(self, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The normal towards the wire at `p`, and its derivative, shapes (m, 3) and (m, 3, 3)."""
        _, e, ee = radial(p)
        return self.side * e, self.side * ee

    def max_penetration(self, trial: TrialPositions) -> float:
        """Maximum penetration, mm."""
        points = trial.points(self.points)
        return -float(self.gaps(self.points.at(trial.x, points), trial.seats, points).min(initial=0.0))

    def augment(self, trial: TrialPositions) -> None:
        """Increase each point's offset by its penetration."""
        points = trial.points(self.points)
        gap = self.gaps(self.points.at(trial.x, points), trial.seats, points)
        self.multiplier_offset[points] = np.maximum(self.multiplier_offset[points] - gap, 0.0)


class Mount(Contact):
    """A seat on linear springs; they press on the seat, not on the wire.

    Args:
        end: `bottom` or `top`.
        stations: number of stations.
        stiffness: of the seat's six degrees of freedom, shape (6,), N/mm and N mm/rad.
        seats: of both seats, shape (12,), where the springs are slack.
    """

    aside = 0

    def __init__(self, end: str, stations: int, stiffness: ArrayLike, seats: np.ndarray):
        plate = Plate(end, stations)
        self.name, self.own, self.dofs = f"{end} mount", plate.own, plate.dofs[None]
        self.stiffness, self.slack = np.diag(stiffness)[None], np.array(seats[plate.own])

    def evaluate(self, trial: TrialPositions) -> Contribution:
        """Forces of the springs."""
        force = self.stiffness[0] @ (trial.seats[self.own] - self.slack)
        none = np.zeros(1)
        return Contribution(self.dofs, force[None], self.stiffness, none, none, np.zeros(1, dtype=int), none)
