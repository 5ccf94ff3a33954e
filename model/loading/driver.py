"""How an axial force or height is put on a spring: by its top seat, or by its clamped top end."""

import numpy as np

from coilset.model.contact.base import ENDS, SEAT_DOFS
from coilset.model.contact.seat import Seat


class Drive:
    """The spring between its heads: which dofs are held, which one is driven, and what force and height mean.

    Args:
        system: System.
        ends: `clamped`: the end nodes belong to rigid heads that move along the axis only; `seats`: the wire's tips
            are held sideways and against turning, as by the pockets of a seat, and rest on it one-sidedly.
        free_length: height of the unloaded spring, mm.

    Attributes:
        tips: station of each end and those of its six components that are held or driven, so that they bear reactions.
    """

    def __init__(self, system, ends, free_length):
        self.system, self.ends, self.free_length = system, ends, free_length
        bottom, top = system.station_dofs[0], system.station_dofs[-1]
        if ends == "clamped":
            self.axial = int(top[2])
            held, components = [*bottom, *np.delete(top, 2), *system.seat_dofs], np.arange(6)
        else:
            components = np.delete(np.arange(6), 2)
            self.axial = int(system.seat_dofs[SEAT_DOFS])
            held = [*np.delete(bottom, 2), *np.delete(top, 2), *np.delete(system.seat_dofs, SEAT_DOFS)]
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
        """Where the spring's axis meets the seat or head at the station positions `x`, shape (3,), mm."""
        station = self.tips[end][0]
        level = x[station, 2] if self.ends == "clamped" else self.system.seats[SEAT_DOFS * ENDS.index(end)]
        return np.array([0.0, 0.0, level])

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
