"""The stress-free spring and the sections of its wire in numbers, as records and what follows from them need them."""

from dataclasses import dataclass

import numpy as np

Cut = tuple[int, int, np.ndarray, np.ndarray]
"""A section of its own: element and section, points in wire radii, (m, 2), and their shares of the disk, (m,)."""


@dataclass(frozen=True)
class Drawn:
    """The stress-free spring; lengths in mm.

    Attributes:
        free_length, block_height: between the planes of its ends.
        turns: of the coil, without hooks and arms.
        middle: the first and the last turn between the end coils.
        hand: +1 right, −1 left.
        mean_diameter: of the coil at half of its turns.
        end_radius: of the coil at the bottom tip.
        wire_diameter: at the stations, shape (n + 1,).
        below, above: distances of the stations from the wire's surface that faces the bottom and the top seat, shape
            (n + 1,).
        has_tails: whether it has hooks or arms.
        is_straight: whether its axis is the z axis.
        measured_axis: offset, mm, and tilt, degrees, of a measured spring's axis; None of a drawn one.
    """

    free_length: float
    block_height: float
    turns: float
    middle: tuple[float, float]
    hand: int
    mean_diameter: float
    end_radius: float
    wire_diameter: np.ndarray
    below: np.ndarray
    above: np.ndarray
    has_tails: bool = False
    is_straight: bool = True
    measured_axis: tuple[float, float] | None = None


@dataclass(frozen=True)
class SectionPoints:
    """The sections of the elements.

    Attributes:
        kind: plane, curved or warping.
        rule: name of the quadrature.
        abscissae: of an element's sections, over its length, shape (g,).
        points: y and z in wire radii, shape (m, 2).
        weights: their shares of the disk, shape (m,).
        cut: sections that grinding has cut.
        outline: closed outline of wire that is not round, in wire radii, shape (k, 2); None of round wire.
        curvature, torsion: of the wire, 1/mm, shape (n, g); 0 where sections ignore it.
    """

    kind: str
    rule: str
    abscissae: np.ndarray
    points: np.ndarray
    weights: np.ndarray
    curvature: np.ndarray
    torsion: np.ndarray
    cut: tuple[Cut, ...] = ()
    outline: np.ndarray | None = None
