"""The `spring:` section of the case file, and what is built from it."""

from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Discriminator, Field, Tag, model_validator
from scipy.optimize import brentq

from coilset.meshes import functions
from coilset.meshes.checks import refuse
from coilset.meshes.ends import OPEN, Ends, bottom_and_top, pitch_with_ends, touching_pitch
from coilset.meshes.entry import Strict
from coilset.meshes.geometry import Spring
from coilset.meshes.measured import MeasuredSpec
from coilset.meshes.shapes import DiameterProfile, Length, Profile, profile_function
from coilset.model.errors import InputError

__all__ = ["MeasuredSpec", "Spring", "SpringEntry", "SpringSpec"]


class SpringSpec(Strict):
    """A spring as on a drawing: three lengths over the turns, hand and ends. Lengths in mm."""

    wire_diameter: Annotated[Profile, Field(description="wire diameter, mm; a number or a table over the turns")]
    mean_diameter: Annotated[DiameterProfile, Field(description="mean coil diameter, mm; a number, a table or a shape")]
    turns: Annotated[float, Field(ge=0.1, le=1000, strict=True, description="all turns, end turns included")]
    pitch: Annotated[
        Profile | None, Field(description="rise in a turn of the body, mm; a number or a table; or give free_length")
    ] = None
    free_length: Annotated[
        Length | None, Field(description="outer length of the unloaded spring, mm; or give pitch")
    ] = None
    hand: Annotated[Literal["right", "left"], Field(description="the way the coils turn")] = "right"
    end_coils: Ends = OPEN

    @model_validator(mode="after")
    def _has_length(self):
        if self.pitch is None and self.free_length is None:
            raise ValueError("pitch and free_length are both missing; give one of them")
        return self

    def build(self):
        """The geometry.

        Returns:
            `Spring`.

        Raises:
            InputError: entries that contradict each other, with their place.
        """
        wire, diameter = self._function("wire_diameter"), self._function("mean_diameter")
        radius = functions.PPoly(0.5 * diameter.c, diameter.x)
        ends_and_transitions = sum(end.end_turns + end.transition_turns for end in bottom_and_top(self.end_coils))
        if ends_and_transitions >= self.turns:
            raise InputError(
                f"{self.turns:g} turns are too few: end turns and transitions alone are {ends_and_transitions:g}",
                "spring.turns",
            )

        def spring(pitch):
            height = self._pitch_with_ends(pitch, wire, radius).antiderivative()
            return Spring(radius, height, wire, 1 if self.hand == "right" else -1, *bottom_and_top(self.end_coils))

        if self.pitch is None:
            return refuse(self._with_free_length(spring, self.turns - ends_and_transitions))
        built = spring(self._function("pitch"))
        if self.free_length is not None and abs(built.free_length - self.free_length) > 1e-6 * self.free_length:
            raise InputError(
                f"{self.free_length:g} mm contradicts the pitch, which makes {built.free_length:.6g} mm; "
                "leave one of the two out",
                "spring.free_length",
            )
        return refuse(built)

    def _function(self, entry):
        try:
            return profile_function(getattr(self, entry), self.turns)
        except ValueError as error:
            raise InputError(str(error), f"spring.{entry}") from error

    def _pitch_with_ends(self, pitch, wire, radius):
        slope = radius.derivative()

        def touching(start, end):
            t = np.linspace(start, end, 65)
            return touching_pitch(wire(t), slope(t)).max()

        return pitch_with_ends(pitch, *bottom_and_top(self.end_coils), touching)

    def _with_free_length(self, spring, body_turns):
        """The spring whose body has the pitch that makes the free length; this grows with the pitch."""

        def too_long(pitch):
            return spring(functions.constant(pitch, self.turns)).free_length - self.free_length

        least = too_long(0.0) + self.free_length
        if least >= self.free_length:
            raise InputError(
                f"{self.free_length:g} mm leave no pitch: end coils and wire alone need {least:.4g} mm",
                "spring.free_length",
            )
        # the body alone rises by the greatest pitch times its turns
        pitch = brentq(too_long, 0.0, self.free_length / body_turns, xtol=1e-12, rtol=1e-14)
        return spring(functions.constant(pitch, self.turns))


def _origin(value: Any) -> str:
    measured = isinstance(value, MeasuredSpec) or (isinstance(value, dict) and "file" in value)
    return "(measured)" if measured else "(drawn)"


SpringEntry = Annotated[
    Annotated[SpringSpec, Tag("(drawn)")] | Annotated[MeasuredSpec, Tag("(measured)")], Discriminator(_origin)
]
"""The `spring:` section of the case file; a spring with the entry `file` was measured."""
