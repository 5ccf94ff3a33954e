"""Reactions at both ends of the spring, pressure along the wire, active turns."""

import math
from collections.abc import Sequence
from dataclasses import fields
from typing import Any

import numpy as np

from coilset.model.core.base.agreement import sum_of_ranks
from coilset.model.core.contact.base import ENDS, SEAT_DOFS, Contact, Contribution
from coilset.model.core.equilibrium.system.heads import Heads
from coilset.model.core.equilibrium.system.layout import LineLayout
from coilset.model.core.equilibrium.system.system import System
from coilset.model.core.results.records.record import ForceLine, SeatReaction, SeatReactions
from coilset.model.core.rod.rod import Rod
from coilset.model.core.rotations.kernels import exponential
from coilset.model.core.runtime.kernels import njit
from coilset.model.physics.reactions.resultants import Wrench, bearing_on_seat, pressures_on, turns_without

ON_LINE = tuple(item.name for item in fields(SeatReactions) if item.name.startswith(("line_", "damper_")))


Parts = Sequence[tuple[Contact, Contribution]]
OnWire = Sequence[tuple[int, Any, Contribution]]  # contacts that act on points of the wire, with their numbers


def seat_reactions(
    system: System,
    control: Heads,
    turns: np.ndarray,
    step: int,
    greatest_force: float,
    line: ForceLine | None = None,
) -> SeatReactions:
    """Reactions at the equilibrium just reached; collective.

    Args:
        system: System of a Rod.
        control: Heads.
        turns: of the stations, shape (n + 1,).
        step: number of the step.
        greatest_force: magnitude of the largest axial force so far, this one's included, N.
        line: ForceLine, if it is requested.

    Returns:
        SeatReactions, the same on every rank.
    """
    observer = _Observer(system, control)
    rod, pressure = observer.layout.rod, pressures(observer.on_wire)
    faint = rod.faint_force(greatest_force)
    wrenches = {end: observer.wrench(end) for end in ENDS}
    bottom, top = (observer.reaction(end, wrenches[end], faint) for end in ENDS)
    active = active_turns(rod, turns, control.force) if abs(control.force) > faint else np.nan
    side = math.hypot(top.lateral_x_N, top.lateral_y_N)
    free = free_turns(observer.on_wire, pressure)
    whole = observer.others() + wrenches["bottom"] + wrenches["top"]
    numbers = dict(zip(ON_LINE, on_line(wrenches["top"], line, faint), strict=True))
    numbers["imbalance_N"], numbers["imbalance_Nmm"] = map(float, map(np.linalg.norm, (whole.force, whole.moment)))
    return SeatReactions(step, active, free, side, **numbers, bottom=bottom, top=top, pressure=pressure)


def on_line(wrench: Wrench, line: ForceLine | None, faint: float) -> tuple[float, ...]:
    """Where the line of a force crosses two planes, x and y of each, mm, its moments for a damper, N mm, and friction.

    Args:
        wrench: of the top head on the spring; its opposite acts on the body above.
        line: ForceLine; None: nothing is evaluated.
        faint: force that counts as none, N.
    """
    if line is None:
        return (math.nan,) * 7
    lower, upper = (
        (math.nan, math.nan)
        if height is None or abs(wrench.force[2]) <= faint
        else wrench.about(np.array([0.0, 0.0, height])).crossing()
        for height in (line.lower, line.upper)
    )
    moment = -wrench.about(np.array(line.point)).moment
    axis = np.array(line.direction) / np.linalg.norm(line.direction)
    about = float(moment @ axis)
    across = moment - about * axis
    return *lower, *upper, float(np.linalg.norm(across)), about, _friction(-wrench.force, across, axis, line)


def _friction(force: np.ndarray, moment: np.ndarray, axis: np.ndarray, line: ForceLine) -> float:
    """μ (|R1| + |R2|), N: reactions of two guides at a and b on the rod, R1 + R2 = −S, a e × R1 + b e × R2 = −M.

    Args:
        force, moment: F and M on the rod about the damper's point, M across the axis, shape (3,), N and N mm.
        axis: e, unit vector; S is what of F is across it.
        line: ForceLine.
    """
    if not line.guides:
        return math.nan
    a, b = line.guides
    side = force - (force @ axis) * axis
    second = np.cross(axis, moment - a * np.cross(axis, side)) / (b - a)
    return line.friction * float(np.linalg.norm(side + second) + np.linalg.norm(second))


class _Observer:
    """Evaluates forces, moments and contact at the ends of a spring."""

    def __init__(self, system: System, control: Heads) -> None:
        assert isinstance(system.layout, LineLayout)
        self.layout, self.system, self.control = system.layout, system, control
        self.x = self.layout.gather(system.state["x"].trial)
        self.chart = self.layout.gather(self.layout.rod.chart)
        self.parts: Parts = list(zip(system.contacts, system.gathered_contacts(), strict=True))
        self.on_wire: OnWire = [(kind, *part) for kind, part in enumerate(self.parts) if part[0].points is not None]

    def wrench(self, end: str) -> Wrench:
        """Resultant of an end's seat, or of its prescribed unknowns, on the wire."""
        own = [part for contact, part in self.parts if contact.end == end]
        station, _ = self.control.tips[end]
        return Wrench.of_contacts(own, self.x, self.chart, station, self.control.on_tip(end))

    def others(self) -> Wrench:
        """Resultant of all contacts that are no end's: of arbor, sleeve, and coils on each other, which is none."""
        others = [part for contact, part in self.parts if contact.end not in ENDS]
        return Wrench.of_contacts(others, self.x, self.chart, 0, np.zeros(6))

    def reaction(self, end: str, whole: Wrench, faint: float) -> SeatReaction:
        """The SeatReaction of an end, from its `wrench`."""
        wrench = whole.about(self.control.centre(end, self.x))
        side = 1.0 if end == "bottom" else -1.0  # the bottom pushes up
        lateral_x, lateral_y, along = wrench.force.tolist()
        crossing = wrench.crossing() if abs(along) > faint else (math.nan, math.nan)
        spot, length, down = (np.nan, np.nan), 0.0, 0.0
        for _, contact, part in self.on_wire:
            if contact.end == end:
                wire = contact.points
                bears, reach, x, y = bearing_on_seat(
                    part.point,
                    part.pressure,
                    part.bears,
                    wire.weights,
                    wire.stations,
                    self.x,
                    wire.length,
                    wire.turns,
                    wire.tip(end),
                    faint,
                )
                length, down = length + bears, max(down, reach)
                if not math.isnan(x):
                    spot = x, y
        axial = side * along
        if not self.control.clamped and axial < -faint:
            axial = 0.0  # a seat cannot pull: tension comes from the spring that holds a lifted tip
        mx, my, mz = wrench.moment.tolist()
        return SeatReaction(
            axial,
            lateral_x,
            lateral_y,
            mx,
            my,
            mz,
            *crossing,
            math.hypot(*crossing),
            *spot,
            length,
            down,
            *self.pose(end),
        )

    def pose(self, end: str) -> tuple[float, ...]:
        """Angle between the axes of a seat and of the spring, rad; its shift, mm, and its rotation vector, degrees."""
        first, R = SEAT_DOFS * ENDS.index(end), np.empty((3, 3))
        x, y, _, *rotation = self.system.seats[first : first + SEAT_DOFS].tolist()
        exponential(np.array(rotation), R)
        return math.atan2(math.hypot(R[0, 2], R[1, 2]), R[2, 2]), x, y, *(math.degrees(angle) for angle in rotation)


def active_turns(rod: Rod, turns: np.ndarray, force: float) -> float:
    """∫ (Mt/(F r))² dt over all turns, Mt the mean torque of each element, r the distance of its middle; collective.

    The middle of the chord, since a straight element bears F at that lever.

    Args:
        rod: Rod.
        turns: of the stations, shape (n + 1,).
        force: axial force F, N.
    """
    torque = rod.coefficients.s[:, :, 3] @ np.array(rod.element.weights)
    return sum_of_ranks(rod.comm, _active_turns(torque, force, rod.x, rod.cells, turns, rod.line.element))


@njit(cache=True)
def _active_turns(
    torque: np.ndarray,
    force: float,
    x: np.ndarray,
    cells: np.ndarray,
    turns: np.ndarray,
    element: np.ndarray,
) -> float:
    """That of the owned elements; `x` of the nodes, `cells`: nodes of the elements, `element`: their numbers."""
    active = 0.0
    for c in range(len(torque)):
        middle = 0.5 * (x[cells[c, 0]] + x[cells[c, 1]])
        share = torque[c] / (force * math.hypot(middle[0], middle[1]))
        active += share * share * (turns[element[c] + 1] - turns[element[c]])
    return active


def pressures(parts: OnWire) -> np.ndarray:
    """Rows of SeatReactions.pressure: forces of each kind of contact, summed at each point."""
    rows: list[np.ndarray] = [np.empty((0, 3))]
    for kind, contact, part in parts:
        if not len(part.point):
            continue
        halves = 1.0 if contact.end else 2.0
        rows.append(pressures_on(kind, part.point, part.pressure, part.bears, contact.lengths, halves))
    return np.concatenate(rows)


def free_turns(parts: OnWire, pressure: np.ndarray) -> float:
    """Turns of wire without contact, weighted by the turns assigned to each point."""
    if not parts:
        return float("nan")
    return turns_without(parts[0][1].points.share_of_turns, pressure)
