"""What holds and drives a spring: its two heads, each a rigid body of six freedoms.

The head of an end is its seat, or the clamp of the wire's tip. Each freedom is held, free, or on a spring (a Mount),
and a load program may prescribe any of them, by its value or by the force or moment that is conjugate to it.
Displacements are those of the head's point on the spring's axis, rotations the components of a rotation vector since
the start.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Literal, NamedTuple

import numpy as np

from coilset.model.core.base.agreement import sum_of_ranks
from coilset.model.core.body.state import Where
from coilset.model.core.contact.base import ENDS, LEVEL, SEAT_DOFS
from coilset.model.core.equilibrium.system.layout import SEATS, LineLayout
from coilset.model.core.equilibrium.system.load import Load
from coilset.model.core.equilibrium.system.system import System
from coilset.model.core.rotations.kernels import logarithm
from coilset.model.core.rotations.vectors import rotation_matrix

AXIAL = SEAT_DOFS + LEVEL  # the freedom that height and force drive: the top head along the axis
When = Literal["equilibrium", "trial"]


class Holding(NamedTuple):
    """What holds the ends of a spring.

    Attributes:
        clamped: whether the end nodes belong to rigid heads; else they are on seats.
        tips: on seats: whether the wire's tips are held sideways and against rotation, as in pockets; else contacts
            alone hold the wire.
        heads: held freedoms of the bottom and of the top head, without the axial ones.
        fix: of clamped ends with heads that rotate: fixes a station of a system to the point of a head, see
            FixedStation; None: no head ever rotates.
        stations: of clamped ends: those that belong to the heads, from the first and from the last one.
        at_station: of clamped ends: whether a head's point is at its station, as of a hook, and not on the axis.
        on_point: of clamped ends: whether a contact holds the wire in the head instead, a Support.
    """

    clamped: bool
    tips: bool = True
    heads: Sequence[Sequence[int]] = ((0, 1, 3, 4, 5), (0, 1, 3, 4, 5))
    fix: Callable[[System, int, np.ndarray], object] | None = None
    stations: tuple[int, int] = (0, -1)
    at_station: tuple[bool, bool] = (False, False)
    on_point: tuple[bool, bool] = (False, False)


class Heads:
    """The spring between its heads: the held unknowns, the driven ones, and the definition of force and height.

    Args:
        system: System of a rod with its LineLayout.
        free_length: height of the unloaded spring, mm.
        holding: Holding.
        radius: mean radius of the coil, by which rotations and moments become displacements and forces in `travel`.

    Attributes:
        tips: station of each end and its components that are held or driven and therefore have reactions.
        measure: the freedom by which steps are measured, the one that the load program drives most.
    """

    def __init__(self, system: System, free_length: float, holding: Holding, radius: float = 1.0) -> None:
        layout = system.layout
        assert isinstance(layout, LineLayout)
        self.system, self.layout, self.free_length, self.radius = system, layout, free_length, radius
        self.clamped, self.measure, self._turning = holding.clamped, AXIAL, holding.fix is not None
        first, last = (station % len(layout.station_dofs) for station in holding.stations)
        self._points = [
            layout.rod.line.stations[station] * ([1.0, 1.0, 1.0] if there else [0.0, 0.0, 1.0])
            for station, there in zip((first, last), holding.at_station, strict=True)
        ]
        held = [LEVEL, *holding.heads[0], *(SEAT_DOFS + freedom for freedom in holding.heads[1])]
        on_tips = np.delete(np.arange(6), LEVEL) if holding.tips and not holding.clamped else np.arange(0)
        self.rigid = [holding.clamped and not on_point for on_point in holding.on_point]
        parts: list[np.ndarray] = []
        others: list[int] = []
        self.tips: dict[str, tuple[int, np.ndarray]] = {}
        for end, rigid, station, point in zip(ENDS, self.rigid, (first, last), self._points, strict=True):
            seat, own = np.split(layout.seat_dofs, 2)[ENDS.index(end)], layout.station_dofs[station]
            components = np.arange(6) if rigid else on_tips
            parts.append(own if rigid else seat)
            others.extend(seat if rigid else own[components])
            self.tips[end] = station, components
            if rigid and holding.fix is not None:
                system.fixed.append(holding.fix(system, station, point))
        self.dofs = np.concatenate(parts)
        self.held = {int(dof): 0.0 for dof in (*others, *self.dofs[held])}
        if holding.clamped and self._turning:
            seats = system.state["seats"]
            start = np.concatenate([np.pad(point, (0, 3)) for point in self._points])
            seats.trial[:] = seats.equilibrium[:] = start
        self._start = system.state.add("free_level", np.array([self._level("equilibrium")]), Where.SHARED)

    def begin_here(self) -> None:
        """Count the height from the last equilibrium on, as that of the free spring."""
        self._start.trial[0] = self._start.equilibrium[0] = self._level("equilibrium")

    # ---- loads -----------------------------------------------------------------------------------------------------

    def load(self, values: Mapping[int, float], forces: Mapping[int, float], kept: Collection[int] = ()) -> Load:
        """The load from the last equilibrium to values, mm and rad, and forces, N and N mm, of freedoms, by number.

        Freedoms that are held or `kept` and have neither stay where they are. If all rotations of a head are prescribed
        or stay, it goes to the rotation vector of their values; if one is free, the others are about fixed axes.
        """
        now = self.freedoms("equilibrium")
        fixed = self.held | {int(self.dofs[freedom]): 0.0 for freedom in kept}
        for freedom in forces:
            fixed.pop(int(self.dofs[freedom]), None)
        fixed |= {int(self.dofs[freedom]): value - now[freedom] for freedom, value in values.items()}
        for rigid, first in zip(self.rigid, (3, SEAT_DOFS + 3), strict=True):
            dofs = [int(dof) for dof in self.dofs[first : first + 3]]
            if rigid and all(dof in fixed for dof in dofs):
                change = self._between(now[first : first + 3], np.array([fixed[dof] for dof in dofs]))
                fixed |= dict(zip(dofs, change.tolist(), strict=True))
        return Load.of(self.layout, fixed, {int(self.dofs[freedom]): force for freedom, force in forces.items()})

    def _between(self, now: np.ndarray, change: np.ndarray) -> np.ndarray:
        """The rotation vector from one to another that differs by `change`: the same where both are parallel."""
        if not np.cross(now, change).any():
            return change
        between = np.empty(3)
        logarithm(rotation_matrix(now + change) @ rotation_matrix(now).T, between)
        return between

    def to_height(self, height: float) -> Load:
        """The load that brings the spring from the last equilibrium to a height, mm, all else held as it is."""
        return self.load({AXIAL: self.freedom_at(height)}, {})

    def to_force(self, force: float) -> Load:
        """The load that brings the spring to an axial force, compression positive, N."""
        return self.load({}, {AXIAL: -force})

    def to_travel(self, travel: float) -> Load:
        """The load that drives the measured freedom by a further travel, mm; others are held, or keep their forces."""
        size = self.radius if self.measure % SEAT_DOFS >= 3 else 1.0
        value = float(self.freedoms("equilibrium")[self.measure]) - travel / size
        forces = enumerate(self.reactions("equilibrium").tolist())
        kept = {one: force for one, force in forces if one != self.measure and int(self.dofs[one]) not in self.held}
        return self.load({self.measure: value}, kept)

    # ---- the spring that nothing holds: its bottom tip stays, which then carries no force -------------------------

    def tip_forces(self) -> dict[int, float]:
        """What the heads do to the wire at the last equilibrium, by its unknowns, but at the bottom tip; collective."""
        stay = {*self._bottom_tip(), *map(int, self.layout.seat_dofs)}
        dofs = [dof for dof in {*self.held, *map(int, self.dofs)} if dof not in stay]
        return dict(
            zip(dofs, self.layout.values(self.system.internal, np.array(dofs, dtype=int)).tolist(), strict=True)
        )

    @property
    def held_stations(self) -> list[int]:
        """Stations by which bottom and top are held."""
        return [station for station, _ in self.tips.values()]

    def tip_triads(self) -> tuple[np.ndarray, np.ndarray]:
        """Triads of bottom and top tip at the last equilibrium, shape (3, 3) each; collective."""
        R = self.system.state["R"].equilibrium
        bottom, top = (self.layout.at_station(R, station) for station in self.held_stations)
        return bottom, top

    def let_go(self, forces: Mapping[int, float], share: float) -> Load:
        """The load under which only a share of `tip_forces` is left."""
        fixed = dict.fromkeys([*self._bottom_tip(), *map(int, self.layout.seat_dofs)], 0.0)
        return Load.of(self.layout, fixed, {dof: share * force for dof, force in forces.items()})

    def carry(self, R: np.ndarray, lift: float, seat: float) -> Load:
        """The load that turns a free spring about its bottom tip and lifts it as a rigid body; collective.

        Args:
            R: rotation, shape (3, 3).
            lift: along the axis, mm; seat: that of the top seat, mm.
        """
        rod, station, ψ = self.layout.rod, self.tips["bottom"][0], np.empty(3)
        logarithm(np.ascontiguousarray(R), ψ)
        motion = np.array([0.0, 0.0, lift])
        if station in rod.arms:  # its unknowns are those of the head's point
            triad = self.layout.at_station(self.system.state["R"].equilibrium, station)
            motion -= (R - np.eye(3)) @ triad @ rod.arms[station]
        fixed = dict.fromkeys(map(int, self.layout.seat_dofs), 0.0)
        fixed[int(self.layout.seat_dofs[AXIAL])] = seat
        fixed |= dict(zip(self._bottom_tip(), [*motion, *ψ], strict=True))
        return Load.of(self.layout, fixed, {})

    def _bottom_tip(self) -> list[int]:
        return [int(dof) for dof in self.layout.station_dofs[self.tips["bottom"][0]]]

    def freedom_at(self, height: float) -> float:
        """Value of the axial freedom at a height, mm."""
        return self._level("equilibrium") + (height - self.height)

    # ---- values and reactions --------------------------------------------------------------------------------------

    def freedoms(self, when: When) -> np.ndarray:
        """Values of all freedoms, shape (12,): x, y, z, mm, and rotation vector, rad, of bottom and top; collective."""
        values: np.ndarray = getattr(self.system.state["seats"], when).copy()
        if self.clamped and not self._turning:
            for end, (station, _) in enumerate(self.tips.values()):
                x = self.layout.at_station(getattr(self.system.state["x"], when), station)
                values[SEAT_DOFS * end : SEAT_DOFS * end + 3] = (
                    x - self.layout.rod.line.stations[station] + self._points[end]
                )
        return values

    def reactions(self, when: When) -> np.ndarray:
        """Forces of the heads on the spring that are conjugate to the freedoms, shape (12,), N and N mm; collective.

        Those of held tips in their pockets act on the wire and are not among them.
        """
        mine, forces = np.zeros(SEATS), getattr(self.system.state["reactions"], when)
        here = self.dofs - self.layout.start
        own = (here >= 0) & (here < len(forces))
        mine[own] = forces[here[own]]
        return mine if self.layout.comm.size == 1 else self.layout.comm.allreduce(mine)

    @property
    def height(self) -> float:
        """At the last equilibrium, mm."""
        return self.free_length + float(self._level("equilibrium") - self._start.equilibrium[0])

    @property
    def trial_height(self) -> float:
        """In the trial state, mm; collective."""
        return self.free_length + float(self._level("trial") - self._start.equilibrium[0])

    @property
    def force(self) -> float:
        """Axial force at the last equilibrium, compression positive, N; collective."""
        return self._force("equilibrium", AXIAL)

    @property
    def trial_force(self) -> float:
        """Axial force in the trial state, compression positive, N; collective."""
        return self._force("trial", AXIAL)

    @property
    def turn(self) -> float:
        """Rotation of the top head about the axis less that of the bottom one, rad."""
        values = self.system.state["seats"].equilibrium
        return float(values[AXIAL + 3] - values[LEVEL + 3])

    @property
    def torque(self) -> float:
        """What turns the spring about the top head's axis at the last equilibrium, N mm; collective.

        For a seat with a groove, the moment that is conjugate to its turn.
        """
        if not len(self.tips["top"][1]):
            return float(self.reactions("equilibrium")[AXIAL + 3])
        held = self.on_tip("top")
        x = self.layout.at_station(self.layout.rod.x, self.tips["top"][0])
        arm = x - self.centre("top", x[None])
        return float(held[5] + arm[0] * held[1] - arm[1] * held[0])

    def measured(self, when: When) -> tuple[float, float]:
        """Value and force by which steps are measured, mm and N; of a rotation at the mean radius; collective.

        The signs are those of travel and force.
        """
        if self.measure == AXIAL:
            return -self._level(when), self._force(when, AXIAL)
        size = self.radius if self.measure % SEAT_DOFS >= 3 else 1.0
        return -size * float(self.freedoms(when)[self.measure]), self._force(when, self.measure) / size

    def _level(self, when: When) -> float:
        """Axial position of the driven head, mm; collective."""
        state = self.system.state
        if self.clamped and not self._turning:
            return float(self.layout.at_station(getattr(state["x"], when), self.tips["top"][0])[2])
        return float(getattr(state["seats"], when)[AXIAL])

    def _force(self, when: When, freedom: int) -> float:
        reactions = getattr(self.system.state["reactions"], when)
        here = int(self.dofs[freedom]) - self.layout.start
        mine = float(reactions[here]) if 0 <= here < len(reactions) else 0.0
        return -sum_of_ranks(self.layout.comm, mine)

    def on_tip(self, end: str) -> np.ndarray:
        """Force and moment on the wire by what holds its tip at an end, N and N mm, shape (6,); collective.

        On the rotations of a tip that is held the moment m acts by Tᵀ m, and on those of a head by Tᵀ (m + r × f).
        """
        station, components = self.tips[end]
        held = np.zeros(6)
        held[components] = self.layout.values(self.system.internal, self.layout.station_dofs[station, components])
        if self.rigid[ENDS.index(end)] and self._turning:
            chart = self.layout.at_station(self.layout.rod.chart, station)
            x = self.layout.at_station(self.layout.rod.x, station)
            held[3:] = np.linalg.solve(chart.T, held[3:]) - np.cross(x - self.centre(end, x[None]), held[:3])
        return held

    def centre(self, end: str, x: np.ndarray) -> np.ndarray:
        """Centre of the seat, or the head's point, at station positions `x`, shape (3,), mm."""
        if self.clamped and not self._turning:
            height: float = x[self.tips[end][0] if len(x) > 1 else 0, 2]
            return self._points[ENDS.index(end)] * [1.0, 1.0, 0.0] + [0.0, 0.0, height]
        first = SEAT_DOFS * ENDS.index(end)
        return self.system.seats[first : first + 3]
