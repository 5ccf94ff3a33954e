"""What contact does to a slice."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np


@dataclass
class Pressure:
    """Contact at an increment of the body.

    Attributes:
        gap: smallest gap, also of corners, mm.
        free: smallest gap of the points that can be in contact, mm.
        bearing: number of points in contact.
        force: pressure times area of all points, per turn of wire, N.
        forces: on the displacements, shape (blocks, 3), N; numbers: on h̄ and λ, shape (2,), N and N mm.
        rows, columns, values: entries of its stiffness; h̄ and λ follow the displacements as the last unknowns.
    """

    gap: float
    free: float
    bearing: int
    force: float
    forces: np.ndarray
    numbers: np.ndarray
    rows: np.ndarray
    columns: np.ndarray
    values: np.ndarray


NO_PRESSURE = Pressure(
    np.inf, np.inf, 0, 0.0, np.zeros((1, 1)), np.zeros(2), np.empty(0, int), np.empty(0, int), np.empty(0)
)  # where coils pass through each other


class SliceContact(Protocol):
    """Contact of a slice with the next coil.

    Attributes:
        blocks: blocks of degrees of freedom that may touch.
    """

    blocks: np.ndarray

    def evaluate(self) -> Pressure:
        """Forces and stiffness at the body's increment."""
        ...
