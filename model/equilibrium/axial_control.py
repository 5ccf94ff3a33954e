"""Application of an axial force or height to a spring, by its top seat or its clamped top end."""

from collections.abc import Sequence
from typing import Literal

import numpy as np

from coilset.model.base.agreement import sum_of_ranks
from coilset.model.contact.base import ENDS, LEVEL, SEAT_DOFS
from coilset.model.equilibrium.layout import LineLayout
from coilset.model.equilibrium.load import Load
from coilset.model.equilibrium.system import System


class AxialControl:
    """The spring between its heads: the held unknowns, the driven one, and the definition of force and height.

    Args:
        system: System of a rod with its LineLayout.
        free_length: height of the unloaded spring, mm.
        clamped: whether the end nodes belong to rigid heads that move along the axis only; else they stand on seats.
        tips_held: on seats: whether the wire's tips are held sideways and against rotation, as in pockets; else
            contacts alone hold the wire.
        seats_held: on seats: held degrees of freedom of the bottom and the top seat, without the axial position.

    Attributes:
        tips: station of each end and its components that are held or driven and therefore have reactions.
    """

    def __init__(
        self,
        system: System,
        free_length: float,
        clamped: bool,
        tips_held: bool = True,
        seats_held: Sequence[Sequence[int]] = ((), ()),
    ) -> None:
        layout = system.layout
        assert isinstance(layout, LineLayout)
        self.system, self.layout, self.free_length, self.clamped = system, layout, free_length, clamped
        bottom, top = layout.station_dofs[0], layout.station_dofs[-1]
        if clamped:
            self.axial, components = int(top[2]), np.arange(6)
            held = [*bottom, *np.delete(top, 2), *layout.seat_dofs]
        else:
            self.axial = int(layout.seat_dofs[SEAT_DOFS + LEVEL])
            components = np.delete(np.arange(6), 2) if tips_held else np.arange(0)
            held = [*bottom[components], *top[components], layout.seat_dofs[LEVEL]]
            for number, dofs in enumerate(seats_held):
                held += [layout.seat_dofs[SEAT_DOFS * number + dof] for dof in dofs]
        self.held = {int(dof): 0.0 for dof in held}
        self._higher = Load.of(layout, {**self.held, self.axial: 1.0}, {})  # by 1 mm
        self._pulled = Load.of(layout, self.held, {self.axial: 1.0})  # by 1 N
        self.tips = {"bottom": (0, components), "top": (len(layout.station_dofs) - 1, components)}
        self._start = self._level("equilibrium")

    def to_height(self, height: float) -> Load:
        """The load that brings the spring from the last equilibrium to a height, mm."""
        return self._higher.scaled(height - self.height)

    def to_force(self, force: float) -> Load:
        """The load that brings the spring to an axial force, compression positive, N."""
        return self._pulled.scaled(-force)

    @property
    def height(self) -> float:
        """At the last equilibrium, mm."""
        return self.free_length + (self._level("equilibrium") - self._start)

    @property
    def trial_height(self) -> float:
        """In the trial state, mm; collective."""
        return self.free_length + (self._level("trial") - self._start)

    @property
    def force(self) -> float:
        """Axial force at the last equilibrium, compression positive, N; collective."""
        return self._force(self.system.state["reactions"].equilibrium)

    @property
    def trial_force(self) -> float:
        """Axial force in the trial state, compression positive, N; collective."""
        return self._force(self.system.state["reactions"].trial)

    def _level(self, when: Literal["equilibrium", "trial"]) -> float:
        """Axial position of the driven head, mm; collective."""
        state = self.system.state
        if self.clamped:
            return float(self.layout.at_station(getattr(state["x"], when), len(self.layout.station_dofs) - 1)[2])
        return float(getattr(state["seats"], when)[SEAT_DOFS + LEVEL])

    def _force(self, reactions: np.ndarray) -> float:
        here = self.axial - self.layout.start
        mine = float(reactions[here]) if 0 <= here < len(reactions) else 0.0
        return -sum_of_ranks(self.layout.comm, mine)

    def centre(self, end: str, x: np.ndarray) -> np.ndarray:
        """Centre of the seat, or where the axis meets the head, at station positions `x`, shape (3,), mm."""
        if self.clamped:
            return np.array([0.0, 0.0, x[self.tips[end][0], 2]])
        first = SEAT_DOFS * ENDS.index(end)
        return self.system.seats[first : first + 3]
