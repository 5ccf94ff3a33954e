"""How an axial force or height is put on a spring: by its top seat, or by its clamped top end."""

import numpy as np

from coilset.model.contact.base import ENDS, LEVEL, SEAT_DOFS
from coilset.model.contact.seat import Seat
from coilset.model.rotations.vectors import rotation_matrix


class Drive:
    """The spring between its heads: which dofs are held, which one is driven, and what force and height mean.

    Args:
        system: System.
        ends: `clamped`: the end nodes belong to rigid heads that move along the axis only; `seats`: they stand on
            seats that bear one-sidedly.
        free_length: height of the unloaded spring, mm.
        seats: SeatsSpec. With `hold: tips` the wire's tips are held sideways and against turning, as by pockets;
            else contacts alone hold the wire.

    Attributes:
        tips: station of each end and those of its six components that are held or driven, so that they bear reactions.
    """

    def __init__(self, system, ends, free_length, seats=None):
        self.system, self.ends, self.free_length = system, ends, free_length
        bottom, top = system.station_dofs[0], system.station_dofs[-1]
        if ends == "clamped":
            self.axial = int(top[2])
            held, components = [*bottom, *np.delete(top, 2), *system.seat_dofs], np.arange(6)
        else:
            components = np.delete(np.arange(6), 2) if seats.hold == "tips" else np.arange(0)
            self.axial = int(system.seat_dofs[SEAT_DOFS + LEVEL])
            held = [*bottom[components], *top[components], system.seat_dofs[LEVEL]]
            for number, seat in enumerate((seats.bottom, seats.top)):
                held += [system.seat_dofs[SEAT_DOFS * number + dof] for dof in seat.held()]
        self.held = {int(dof): 0.0 for dof in held}
        self.tips = {"bottom": (0, components), "top": (len(system.station_dofs) - 1, components)}
        self.height = free_length
        self.force = 0.0

    def by_height(self, height):
        """Prescribe the height at the end of the step, mm."""
        self.system.fixed = {**self.held, self.axial: height - self.height}
        self.system.forces = {}

    def by_force(self, force):
        """Prescribe the axial force at the end of the step, compression positive, N."""
        self.system.fixed = dict(self.held)
        self.system.forces = {self.axial: -force}

    def read(self, X):
        """Height (mm) and force (N) at the trial state with increments `X`."""
        return self.height + self.system.value(X, self.axial), -self.system.value(self.system.internal, self.axial)

    def centre(self, end, x):
        """Centre of the seat, or where the axis meets the head, at station positions `x`, shape (3,), mm."""
        station = self.tips[end][0]
        if self.ends == "clamped":
            return np.array([0.0, 0.0, x[station, 2]])
        first = SEAT_DOFS * ENDS.index(end)
        return self.system.seats[first : first + 3]

    def tilt(self, end):
        """Angle between the axes of a seat and of the spring, rad."""
        axis = rotation_matrix(self.system.seats[SEAT_DOFS * ENDS.index(end) :][3:SEAT_DOFS])[:, 2]
        return float(np.arctan2(np.hypot(axis[0], axis[1]), axis[2]))

    def accept(self, height, force):
        """The trial state has become the equilibrium."""
        self.height, self.force = height, force

    @property
    def contacts(self):
        """Closed contact elements; the seats' tips count as such."""
        return sum(part.closed for part in self.system.contributions)

    @property
    def has_seats(self):
        """Does the spring stand between one-sided seats?"""
        return any(isinstance(contact, Seat) for contact in self.system.contacts)
