"""Lateral support of the end coil by a seat, and support of the seat itself: linear springs without gaps."""

import numpy as np
from numpy.typing import ArrayLike

from coilset.model.contact.base import Contact, Contribution, TrialPositions
from coilset.model.contact.curve import STENCIL, WirePoints
from coilset.model.contact.plate import Plate, radial


class Groove(Contact):
    """The end coil is in a smooth round groove of its seat, its tip against the groove's end.

    Each point keeps its stress-free distance from the seat's axis by the potential ½ c (ρ − ρ0)², the tip its position
    along the groove by ½ c (s − s0)². Both sides of the groove support the wire, whether it is on the bottom or not.
    Along
    the groove and away from the seat the wire is free, and it may roll and tilt: the seat takes no moment except that
    of forces.

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
        q = self.plate.to_seat_frame(p, trial.seats)
        s, g, H = radial(q)
        end = own == self.stop
        s[end], g[end], H[end] = q[end] @ self.along, self.along, 0.0
        force = stiffness * (s - self.start[own])
        grad, hessian = self.plate.derivatives(p, trial.seats, self.wire.weights[at], g, H)
        k = stiffness[:, None, None] * grad[:, :, None] * grad[:, None, :] + force[:, None, None] * hessian
        none = np.zeros(len(force))
        return Contribution(self.dofs[own], force[:, None] * grad, k, none, none, at, none)

    def acts_on_seats(self, stations: np.ndarray, x: np.ndarray, seats: np.ndarray, span: np.ndarray) -> np.ndarray:
        """Those of the groove; see Contact."""
        return np.isin(stations, self.wire.stations[self.at])


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
