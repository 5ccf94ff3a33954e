"""Wire against a seat: its underside bedded along the wire, touching where it is (7.1.1, Bettung).

A seat has three degrees of freedom: its level z and small tilts θx, θy about the coil's axis. Over the point (x, y) its
surface lies at z + θx y − θy x, and rises outwards with tan β on a cone.
"""

import numpy as np

from coilset.model.contact.base import SEAT_DOFS, Contribution, one_sided
from coilset.model.contact.centreline import STENCIL

CORD = 1e-3  # stiffness of the tip's cord: this share of the bedding of a wire diameter


class Seat:
    """The bottom or the top seat: where the underside sinks in, it is pushed out in proportion to the penetration.

    The wire's tip bears from its first touch, and hangs on a cord: where it lifts off it is pulled back softly, so that
    "zero force" is the one position in which both tips just touch, and the spring cannot float between the seats.

    Args:
        end: `bottom` or `top`.
        points: WirePoints.
        reach: distance from the centre line to the surface that meets the seat, at the points, shape (m,), mm.
        stations: stress-free positions, shape (n, 3), mm.
        level: of the seat that just touches the stress-free spring, mm.
        bedding: force per length of wire and penetration, N/mm per mm.
        onset: way over which contact sets in, mm.
        slope: tan β of a conical seat that rises outwards, 0 for a flat one.
        stepped: turns from the tip over which the seat follows the wire's underside; beyond it goes on level.
        tilts: may the seat tilt?
    """

    guarded = True

    def __init__(self, end, points, reach, stations, level, bedding, onset, slope=0.0, stepped=0.0, tilts=False):
        self.name, self.end, self.points, self.onset, self.slope = f"{end} seat", end, points, onset, slope
        self.number, self.side = (0, 1.0) if end == "bottom" else (1, -1.0)  # the wire lies above the bottom seat
        self.tip = 0 if end == "bottom" else len(points) - 1
        self.stiffness = bedding * points.length
        # a wire that stands on its tip bears by its end face, whatever the mesh
        self.stiffness[self.tip] = bedding * 2.0 * points.radius[self.tip]
        self.lengths = self.stiffness / bedding
        self.cord = CORD * self.stiffness[self.tip]
        self.reach = np.array(reach, dtype=float)
        start = np.zeros(2 * SEAT_DOFS)
        start[SEAT_DOFS * self.number] = level
        gap = self.gaps(points.at(stations), start)
        if stepped:
            away = np.abs(points.turns - points.turns[self.tip])
            on_step = away <= stepped + 1e-9
            last = np.flatnonzero(on_step)[-1 if self.side > 0 else 0]
            self.reach += np.where(on_step, gap, gap[last])
        else:
            self.reach += gap.min()  # zero on a flat seat; a cone is moved until it touches
        seat = np.arange(SEAT_DOFS * self.number, SEAT_DOFS * (self.number + 1))
        self.dofs = np.hstack([points.dofs, np.tile(3 * len(stations) + seat, (len(points), 1))])
        # on a flat seat that cannot tilt, only z of wire and seat take part
        self.variables = np.arange(3 * STENCIL + SEAT_DOFS)
        if not (tilts or slope):
            self.variables = np.append(np.arange(2, 3 * STENCIL, 3), 3 * STENCIL)

    def gaps(self, p, seats):
        """Gap of the underside at the points `p`, shape (m, 3), negative where it sinks in, shape (m,), mm."""
        z, θx, θy = seats[SEAT_DOFS * self.number : SEAT_DOFS * (self.number + 1)]
        above = self.side * (p[:, 2] - z - θx * p[:, 1] + θy * p[:, 0])
        if self.slope:
            above = (above - self.slope * np.hypot(p[:, 0], p[:, 1])) / np.hypot(1.0, self.slope)
        return above - self.reach

    def depth(self, x, seats):
        """Greatest penetration, mm."""
        return -self.gaps(self.points.at(x), seats).min(initial=0.0)

    def evaluate(self, x, seats):
        """Forces across the seat's surface, for the points that touch, and for the tip on its cord."""
        p = self.points.at(x)
        gap = self.gaps(p, seats)
        bearing = np.flatnonzero((gap < 0.0) | (np.arange(len(gap)) == self.tip))
        gap, p = gap[bearing], p[bearing]
        pressure, c = one_sided(gap, self.stiffness[bearing], self.onset)
        force, tip = pressure.copy(), np.flatnonzero(bearing == self.tip)
        c[tip] = np.where(gap[tip] > 0.0, self.cord, self.stiffness[self.tip])
        force[tip] = -c[tip] * gap[tip]
        pressure[tip] = np.maximum(force[tip], 0.0)
        grad, hessian = self._derivatives(p, seats, self.points.weights[bearing])
        k = c[:, None, None] * grad[:, :, None] * grad[:, None, :] - force[:, None, None] * hessian
        pick = self.variables
        return Contribution(
            self.dofs[np.ix_(bearing, pick)], -force[:, None] * grad[:, pick], k[np.ix_(np.arange(len(k)), pick, pick)],
            pressure, -gap, bearing,
        )  # fmt: skip

    def _derivatives(self, p, seats, weights):
        """Gradient and second derivative of the gaps by four stations and the seat, shapes (m, 15) and (m, 15, 15)."""
        θx, θy = seats[SEAT_DOFS * self.number + 1 : SEAT_DOFS * self.number + 3]
        m, x, y = len(p), p[:, 0], p[:, 1]
        one = np.ones(m)
        # by x, y, z of the point, then level and tilts of the seat
        grad = self.side * np.stack([θy * one, -θx * one, one, -one, -y, x], axis=1)
        hessian = np.zeros((m, 6, 6))
        hessian[:, 1, 4] = hessian[:, 4, 1] = -self.side
        hessian[:, 0, 5] = hessian[:, 5, 0] = self.side
        if self.slope:
            ρ = np.hypot(x, y)
            e = p[:, :2] / ρ[:, None]
            grad[:, :2] -= self.slope * e
            hessian[:, :2, :2] -= self.slope * (np.eye(2) - e[:, :, None] * e[:, None, :]) / ρ[:, None, None]
            grad, hessian = grad / np.hypot(1.0, self.slope), hessian / np.hypot(1.0, self.slope)
        spread = np.zeros((m, 3 * STENCIL + SEAT_DOFS, 6))  # from the point's variables to those of its stations
        for k in range(3):
            spread[:, k : 3 * STENCIL : 3, k] = weights
            spread[:, 3 * STENCIL + k, 3 + k] = 1.0
        return (spread @ grad[:, :, None])[..., 0], spread @ hessian @ np.swapaxes(spread, 1, 2)
