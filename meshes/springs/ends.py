"""End coils: how a spring begins and ends, and how that shapes its pitch."""

from collections.abc import Callable
from typing import Annotated, Any, Literal, Self

import numpy as np
from annotated_types import Unit
from pydantic import Discriminator, Field, Tag, model_validator

from coilset.meshes.springs import functions
from coilset.meshes.springs.piecewise import PiecewisePolynomial
from coilset.model.core.base.strict_entries import Strict

ENDS = ("bottom", "top")

CLOSED_TURNS, CLOSED_TRANSITION, GROUND_TIP = 1.0, 0.5, 0.25

_Turns = Annotated[float, Unit("turns"), Field(ge=0.01, allow_inf_nan=False, strict=True)]


class EndCoils(Strict):
    """One end of a spring, or both.

    Open: the wire is cut off. Closed: the end turns touch each other and carry no load of their own; a transition
    leads from their pitch to that of the body. Closed and ground: the closed end is ground flat, so that the wire's tip
    keeps only part of its thickness. A tip of a quarter of the diameter is usual: with end turns that touch each
    other, it means a flat over three quarters of a turn.
    """

    form: Annotated[Literal["open", "closed", "closed and ground"], Field(description="how the end is made")] = "open"
    turns: Annotated[_Turns | None, Field(description=f"end turns, {CLOSED_TURNS:g} if not given")] = None
    transition: Annotated[
        _Turns | None,
        Field(description=f"turns over which the pitch changes to the body's, {CLOSED_TRANSITION:g} if not given"),
    ] = None
    tip: Annotated[
        float | None,
        Unit("wire diameters"),
        Field(gt=0, lt=1, strict=True, description=f"thickness of the ground tip over d, {GROUND_TIP:g} if not given"),
    ] = None

    @model_validator(mode="before")
    @classmethod
    def _from_word(cls, value: Any) -> Any:
        """`closed` is short for `{form: closed}`."""
        return {"form": value} if isinstance(value, str) else value

    @model_validator(mode="after")
    def _belongs(self) -> Self:
        if self.form == "open" and (self.turns is not None or self.transition is not None):
            raise ValueError("open ends have no end turns and no transition; leave these out or make the form closed")
        if self.form != "closed and ground" and self.tip is not None:
            raise ValueError(f"tip is for ends that are closed and ground, not for {self.form} ends")
        return self

    @property
    def is_closed(self) -> bool:
        """Whether the end turns touch each other."""
        return self.form != "open"

    @property
    def end_turns(self) -> float:
        """Number of end turns, 0 for open ends."""
        return (self.turns or CLOSED_TURNS) if self.is_closed else 0.0

    @property
    def transition_turns(self) -> float:
        """Number of turns over which the pitch changes from the end coil's to the body's, 0 for open ends."""
        return (self.transition or CLOSED_TRANSITION) if self.is_closed else 0.0

    @property
    def tip_thickness(self) -> float:
        """Thickness of the wire left at its tip, in wire diameters; 1 if it is not ground."""
        return (self.tip or GROUND_TIP) if self.form == "closed and ground" else 1.0


OPEN = EndCoils()


class BothEnds(Strict):
    """Two different ends."""

    bottom: Annotated[EndCoils, Field(description="the bottom end")] = OPEN
    top: Annotated[EndCoils, Field(description="the top end")] = OPEN


def _number_of_forms(value: Any) -> str:
    two = isinstance(value, BothEnds) or (isinstance(value, dict) and ("bottom" in value or "top" in value))
    return "(two)" if two else "(one)"


Ends = Annotated[
    Annotated[EndCoils, Tag("(one)")] | Annotated[BothEnds, Tag("(two)")],
    Discriminator(_number_of_forms),
    Field(description="form of both ends, or bottom and top with their own"),
]
"""The ends of a spring as the case file gives them."""


def bottom_and_top(ends: EndCoils | BothEnds) -> tuple[EndCoils, EndCoils]:
    """Bottom and top `EndCoils` of an entry `Ends`."""
    return (ends.bottom, ends.top) if isinstance(ends, BothEnds) else (ends, ends)


def touching_pitch(diameter: np.ndarray, slope: np.ndarray, section: Any = None) -> np.ndarray:
    """Pitch at which a coil touches its neighbour: of round wire the centres are a diameter apart, d² = p² + r′².

    0 for coils whose radius changes by more than the wire's width per turn: they pass each other.

    Args:
        diameter: wire diameter, or height of a wire that is not round, mm.
        slope: change of the mean radius, mm per turn.
        section: Boundary of a wire that is not round; None of a round one.
    """
    if section is not None:
        return 0.5 * diameter * section.touching(2.0 * slope / diameter)
    return np.sqrt(np.maximum(diameter**2 - slope**2, 0.0))


def pitch_with_ends(
    body: PiecewisePolynomial, bottom: EndCoils, top: EndCoils, touching: Callable[[float, float], float]
) -> PiecewisePolynomial:
    """The pitch over the turns: end turns, transitions (cubic, with continuous slope) and body.

    Args:
        body: pitch of a spring without end turns, a function of the turn, mm.
        bottom: `EndCoils` at turn 0.
        top: `EndCoils` at the last turn.
        touching: function that gives the maximum touching pitch between two turns, mm.

    Returns:
        The pitch as a function of the turn, mm per turn.
    """
    last = body.x[-1]
    marks = np.array(
        [
            0.0,
            bottom.end_turns,
            bottom.end_turns + bottom.transition_turns,
            last - top.end_turns - top.transition_turns,
            last - top.end_turns,
            last,
        ]
    )
    parts = [functions.restricted(body, marks[2], marks[3])]
    if bottom.is_closed:
        coil = functions.polynomial([touching(*marks[:2])], *marks[:2])
        parts = [coil, functions.blended(coil, body, *marks[1:3]), *parts]
    if top.is_closed:
        coil = functions.polynomial([touching(*marks[4:])], *marks[4:])
        parts = [*parts, functions.blended(body, coil, *marks[3:5]), coil]
    return functions.joined(parts)
