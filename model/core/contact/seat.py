"""Wire against a seat: bedding along the underside of the wire, in its current position (7.1.1, Bettung).

In the coordinates q of its plate (plate.py) a flat seat is the plane qz = 0; a conical one rises outwards with tan β.
"""

import numpy as np

from coilset.model.core.contact.base import LEVEL, Contact, Contribution, Memory, TrialPositions, one_sided
from coilset.model.core.contact.curve import POINTS_PER_ELEMENT, STENCIL, WirePoints
from coilset.model.core.contact.elements import FLAT, FlatSeat, flat_seat_elements
from coilset.model.core.contact.plate import Plate, radial

# Stiffness of the spring that holds a lifted tip, as a fraction of the bedding of one wire diameter. 1e-4 changed the
# set of a spring whose tips lift off at the end of the release by 0.24 mm of 37.7 mm, 1e-6 by less than 0.01 mm.
TIP_SPRING_OF_BEDDING = 1e-6


class Seat(Contact):
    """The bottom or the top seat: it pushes the wire's underside out in proportion to the penetration.

    The wire's tip is in contact from first touch, and a soft spring holds it: if it lifts off farther than in the
    stress-free state it is pulled back, so that "zero force" is the single position in which both ends just touch, and
    the spring cannot float between the seats.

    Args:
        end: `bottom` or `top`.
        points: WirePoints.
        distance: from the centre line to the surface that meets the seat, at the points, shape (m,), mm.
        stations: stress-free positions, shape (n, 3), mm.
        seats: of both seats in the stress-free state, shape (12,), mm and rad.
        bedding: force per length of wire and penetration, N/mm per mm.
        onset: distance over which contact sets in, mm.
        slope: tan β of a conical seat that rises outwards, 0 for a flat one.
        stepped: turns from the tip over which the seat follows the wire's underside; beyond it goes on level.
        moves: whether the seat has degrees of freedom besides its axial position.

    Attributes:
        multiplier_offset: by which each point is pressed in addition to its penetration, shape (m,), mm.
    """

    limits_step = True
    points: WirePoints
    memory: Memory
    multiplier_offset: np.ndarray
    aside = STENCIL  # no other part of the wire matters

    def __init__(
        self,
        end: str,
        points: WirePoints,
        distance: np.ndarray,
        stations: np.ndarray,
        seats: np.ndarray,
        bedding: float,
        onset: float,
        slope: float = 0.0,
        stepped: float = 0.0,
        moves: bool = False,
    ):
        self.name, self.end, self.points, self.onset, self.slope = f"{end} seat", end, points, onset, slope
        self.side = 1.0 if end == "bottom" else -1.0  # the wire lies above the bottom seat
        self.plate = Plate(end, len(stations))
        # on a flat seat that moves along the axis only, the gap depends on z of wire and seat alone, linearly
        self.linear = not (moves or slope)
        self.tip = points.tip(end)
        self.stiffness = bedding * points.length
        # a wire on its tip is supported by its end face, whatever the mesh
        self.stiffness[self.tip] = bedding * 2.0 * points.radius[self.tip]
        self.lengths = self.stiffness / bedding
        self.tip_spring = TIP_SPRING_OF_BEDDING * self.stiffness[self.tip]
        self.distance = np.array(distance, dtype=float)
        gap = self.gaps(points.at(stations), seats)
        if stepped:
            away = np.abs(points.turns - points.turns[self.tip])
            on_step = away <= stepped + 1e-9
            last = np.flatnonzero(on_step)[-1 if self.side > 0 else 0]
            self.distance += np.where(on_step, gap, gap[last])
        else:
            self.distance += gap.min()  # zero on a flat seat; a cone is moved until it touches
        self.memory = Memory({"multiplier_offset": points.stations[:, 0]}, multiplier_offset=np.zeros(len(points)))
        self.multiplier_offset = self.memory["multiplier_offset"]
        self.slack = 0.0 if stepped else gap[self.tip] - gap.min()
        self.dofs, self._level = self.plate.dofs_with(points), self.plate.own.start + LEVEL
        if self.linear:
            levels = np.append(np.arange(2, 3 * STENCIL, 3), 3 * STENCIL + LEVEL)
            self.dofs = np.ascontiguousarray(self.dofs[:, levels])
        self._flat_seat = FlatSeat(
            points.stations,
            points.weights,
            self.dofs,
            self.side,
            self.distance,
            self.multiplier_offset,
            self.stiffness,
            onset,
            self.tip,
            self.tip_spring,
            self.slack,
        )

    def gaps(self, p: np.ndarray, seats: np.ndarray, points: np.ndarray | slice = slice(None)) -> np.ndarray:
        """Gap of the underside at all points or the `points`, at `p`, shape (m, 3), negative for penetration, mm."""
        if self.linear:
            return self.side * (p[:, 2] - seats[self.plate.own][LEVEL]) - self.distance[points]
        return self._above(self.plate.to_seat_frame(p, seats)) - self.distance[points]

    def _above(self, q: np.ndarray) -> np.ndarray:
        """Distance of the points `q` from the surface, mm."""
        above = self.side * q[:, 2]
        return (above - self.slope * np.hypot(q[:, 0], q[:, 1])) / np.hypot(1.0, self.slope) if self.slope else above

    def pressures(self, i: np.ndarray, pressed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Forces on the points `i` for penetrations `pressed` > 0, mm: N, and their derivatives, N/mm."""
        force, hardness = one_sided(-pressed, self.stiffness[i], self.onset)
        hardness[i == self.tip] = self.stiffness[self.tip]
        return np.where(i == self.tip, hardness * pressed, force), hardness

    def gap_derivatives(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """∂g/∂q, the normal towards the wire, and ∂²g/∂q², shapes (m, 3) and (m, 3, 3)."""
        g, H = np.zeros((len(q), 3)), np.zeros((len(q), 3, 3))
        g[:, 2] = self.side
        if self.slope:
            _, e, ee = radial(q)
            g, H = (g - self.slope * e) / np.hypot(1.0, self.slope), -self.slope * ee / np.hypot(1.0, self.slope)
        return g, H

    def max_penetration(self, trial: TrialPositions) -> float:
        """Maximum penetration, mm."""
        points = trial.points(self.points)
        return -self.gaps(self.points.at(trial.x, points), trial.seats, points).min(initial=0.0)

    def acts_on_seats(self, stations: np.ndarray, x: np.ndarray, seats: np.ndarray, span: np.ndarray) -> np.ndarray:
        """Those of which a neighbour may be in contact, and those of the tip; see Contact."""
        points = POINTS_PER_ELEMENT * stations
        along_wire = span[2] if self.linear else np.linalg.norm(span)
        near = self.gaps(x, seats, points) < self.multiplier_offset.max() + 2.0 * along_wire
        return near | np.isin(stations, self.points.stations[self.tip])

    def evaluate(self, trial: TrialPositions) -> Contribution:
        """Forces across the seat's surface, for the points that touch, and for the tip on its spring."""
        return self._flat(trial) if self.linear else self._curved(trial)

    def _flat(self, trial: TrialPositions) -> Contribution:
        """On a flat seat that moves along the axis only."""
        numbers = trial.points(self.points)
        room = Contribution.room(len(numbers), FLAT)  # for as many as could press, most of them never written
        count = flat_seat_elements(numbers, trial.x, trial.seats[self._level], self._flat_seat, room)
        return Contribution(*[part[:count] for part in room])

    def _curved(self, trial: TrialPositions) -> Contribution:
        """On a cone, or on a seat that moves in any way."""
        points = trial.points(self.points)
        p, offset = self.points.at(trial.x, points), self.multiplier_offset[points]
        gap = self.gaps(p, trial.seats, points)
        found = np.flatnonzero((gap < offset) | (points == self.tip))
        bearing, penetration, gap, p = points[found], -gap[found], (gap - offset)[found], p[found]
        onset_force = self.stiffness[bearing] * self.onset
        pressure, c = one_sided(gap, self.stiffness[bearing], self.onset)
        force, tip = pressure.copy(), np.flatnonzero(bearing == self.tip)
        taut = np.where(gap[tip] > 0.0, np.maximum(gap[tip] - self.slack, 0.0), gap[tip])
        c[tip] = np.where(gap[tip] > 0.0, self.tip_spring * (gap[tip] >= self.slack), self.stiffness[self.tip])
        force[tip] = -c[tip] * taut
        pressure[tip] = np.maximum(force[tip], 0.0)
        derivatives = self.gap_derivatives(self.plate.to_seat_frame(p, trial.seats))
        grad, hessian = self.plate.derivatives(p, trial.seats, self.points.weights[bearing], *derivatives)
        k = c[:, None, None] * grad[:, :, None] * grad[:, None, :] - force[:, None, None] * hessian
        return Contribution(self.dofs[bearing], -force[:, None] * grad, k, pressure, penetration, bearing, onset_force)

    def augment(self, trial: TrialPositions) -> None:
        """Increase each point's offset by its penetration."""
        points = trial.points(self.points)
        gap = self.gaps(self.points.at(trial.x, points), trial.seats, points)
        self.multiplier_offset[points] = np.maximum(self.multiplier_offset[points] - gap, 0.0)
