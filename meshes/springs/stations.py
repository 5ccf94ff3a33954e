"""Positions of the nodes of a line mesh along the wire."""

from itertools import pairwise
from typing import Annotated, Protocol

import numpy as np
from annotated_types import Unit
from pydantic import Discriminator, Field, Tag

from coilset.meshes.springs import functions
from coilset.meshes.springs.shapes import Table, form_of_entry
from coilset.model.core.base.errors import InputError

LEAST, MOST = 3, 1_000_000  # elements per turn
ALL = 10_000_000  # elements of a whole spring

ElementsPerTurn = Annotated[
    Annotated[float, Unit("1"), Field(ge=LEAST, le=MOST, strict=True), Tag("(number)")]
    | Annotated[Table, Tag("(table)")],
    Discriminator(form_of_entry, custom_error_type="form", custom_error_message="must be a number or a table"),
]
"""Number of elements per turn, or a table of it over the turns for a graded mesh."""


class CentreLine(Protocol):
    """The properties of a spring that determine where its nodes are; turns t, shape (n,)."""

    @property
    def turns(self) -> float:
        """The last turn."""

    @property
    def breaks(self) -> np.ndarray:
        """Turns at which some function of the spring is not smooth, including the first and the last."""

    @property
    def corners(self) -> np.ndarray:
        """Turns where the coil or a piece of a hook or arm ends."""

    def speed(self, t: np.ndarray) -> np.ndarray:
        """Length of wire per turn, mm."""

    def curvature(self, t: np.ndarray) -> np.ndarray:
        """1/mm."""


def stations(spring: CentreLine, elements_per_turn: ElementsPerTurn = 16, sagitta: float | None = None) -> np.ndarray:
    """Turns at which the nodes are.

    The number of elements per turn is a density over the turn; its integral, rounded up, is the number of elements,
    and every element has an equal share of it. Each piece of a hook or arm has as many elements as the end of the coil
    has over its length, or over its angle if that is more.

    Args:
        spring: its centre line.
        elements_per_turn: a number, or a `Table` of numbers over the turns.
        sagitta: if given, elements are also short enough that their chord deviates no more than this, mm, from the arc.

    Returns:
        Increasing turns from tip to tip, shape (elements + 1,).

    Raises:
        InputError: a table that does not end at the last turn, or too few or too many elements per turn.
    """
    try:
        given = (
            elements_per_turn.function(spring.turns)
            if isinstance(elements_per_turn, Table)
            else functions.constant(elements_per_turn, spring.turns)
        )
    except ValueError as error:
        raise InputError(str(error), "mesh.elements_per_turn") from None

    def density(t: np.ndarray) -> np.ndarray:
        of_coil = given(np.clip(t, 0.0, spring.turns))
        if sagitta is None:
            return of_coil
        # sagitta = κ h²/8 with the element length h
        return np.maximum(of_coil, spring.speed(t) * np.sqrt(spring.curvature(t) / (8 * sagitta)))

    breaks = np.unique(np.concatenate([spring.breaks, given.x]))
    densities = density(breaks)
    if not LEAST <= densities.min() <= densities.max() <= MOST:
        raise InputError(
            f"{densities.min():.4g} to {densities.max():.4g} elements per turn; must be {LEAST} to {MOST}", "mesh"
        )
    count = np.concatenate([[0.0], np.cumsum(functions.integral(density, breaks, points=2))])
    if count[-1] > ALL:
        raise InputError(f"{count[-1]:.4g} elements; must be {ALL:,} at most", "mesh")
    elements = int(np.ceil(count[-1] * (1 - 1e-9)))
    if np.ptp(densities) == 0:
        coil = np.linspace(0.0, spring.turns, elements + 1)
    else:
        coil = np.interp(np.linspace(0.0, count[-1], elements + 1), count, breaks)

    def of_piece(start: float, end: float) -> np.ndarray:
        """All turns but the last."""
        middle = np.array([0.5 * (start + end)])
        over_angle = spring.speed(middle) * spring.curvature(middle) / (2.0 * np.pi)
        most = density(middle) * np.maximum(1.0, over_angle)
        return np.linspace(start, end, int(np.ceil((end - start) * most[0] - 1e-9)) + 1)[:-1]

    below, above = (spring.corners[there] for there in (spring.corners <= 0.0, spring.corners >= spring.turns))
    bottom, top = ([of_piece(*pair) for pair in pairwise(corners.tolist())] for corners in (below, above))
    return np.concatenate([*bottom, coil[:-1], *top, above[-1:]])
