"""The `spring:` section of the case file, and the geometry built from it."""

from collections.abc import Callable
from typing import Annotated, Any, Literal, Self

import numpy as np
from annotated_types import Unit
from pydantic import Discriminator, Field, Tag, model_validator
from pydantic_core import PydanticCustomError

from coilset.meshes.springs import functions
from coilset.meshes.springs.checks import refuse
from coilset.meshes.springs.ends import OPEN, Ends, bottom_and_top, pitch_with_ends, touching_pitch
from coilset.meshes.springs.geometry import Spring
from coilset.meshes.springs.piecewise import PiecewisePolynomial
from coilset.meshes.springs.shapes import CurvedAxis, DiameterProfile, Length, Profile, profile_function
from coilset.model.core.base.errors import InputError
from coilset.model.core.base.package import Entry
from coilset.model.core.base.strict_entries import Strict

PAST = "made_by", "peening", "initial_tension"  # entries that leave stress in the wire before its first load
DIAMETERS = {"mean_diameter": 0, "outer_diameter": -1, "inner_diameter": 1}  # wire diameters to add for the mean one

__all__ = ["Spring", "SpringEntry", "SpringSpec"]


class SpringSpec(Strict):
    """A spring as on a drawing: wire, coil diameter and pitch over the turns, hand and ends; lengths in mm."""

    wire_diameter: Annotated[
        Profile | None,
        Field(
            description="wire diameter, mm; a number or a table over the turns; beside `wire` its height, to which the "
            "section is scaled"
        ),
    ] = None
    wire: Annotated[
        Any,
        Entry("coilset.meshes.sections.wire_section:WireSpec"),
        Field(description="section of a wire that is not round"),
    ] = None
    mean_diameter: Annotated[
        DiameterProfile | None, Field(description="mean coil diameter D, mm; a number, a table or a shape")
    ] = None
    outer_diameter: Annotated[
        DiameterProfile | None, Field(description="outer coil diameter De = D + d, mm, in place of the mean one")
    ] = None
    inner_diameter: Annotated[
        DiameterProfile | None, Field(description="inner coil diameter Di = D − d, mm, in place of the mean one")
    ] = None
    turns: Annotated[
        float,
        Unit("turns"),
        Field(ge=0.1, le=1000, strict=True, description="total number of turns, end turns included"),
    ]
    pitch: Annotated[
        Profile | None,
        Unit("mm"),
        Field(description="rise of the body per turn, mm; a number or a table; or give free_length"),
    ] = None
    free_length: Annotated[
        Length | None, Field(description="outer length of the unloaded spring, mm; or give pitch")
    ] = None
    axis: Annotated[
        CurvedAxis | None, Field(description="offsets of the coil's centre over the turns; left out: a straight axis")
    ] = None
    hand: Annotated[Literal["right", "left"], Field(description="direction of the helix")] = "right"
    end_coils: Ends = OPEN
    made_by: Annotated[
        Literal["coiling"] | None,
        Field(
            description="coiling: straight wire was bent and twisted and sprang back to this shape, which leaves "
            "residual stress; left out: the wire is free of stress"
        ),
    ] = None
    relieved: Annotated[
        Any,
        Entry("coilset.model.physics.manufacture.entries:Relief"),
        Field(description="stress relief of the coiled wire, before peening and before the first load"),
    ] = None
    initial_tension: Annotated[
        float | None,
        Unit("N"),
        Field(
            gt=0,
            description="force F0 with which coils wound onto each other press: the wire is twisted elastically "
            "towards a tighter helix; leave out pitch and free_length",
        ),
    ] = None
    peening: Annotated[
        Any,
        Entry("coilset.model.physics.manufacture.entries:Peening"),
        Field(description="shot peening of the wire, before the first load; left out: none"),
    ] = None
    hooks: Annotated[
        Any,
        Entry("coilset.meshes.tails:Hooks"),
        Field(description="hooks of an extension spring, by which it is pulled; left out: none"),
    ] = None
    arms: Annotated[
        Any,
        Entry("coilset.meshes.tails:Arms"),
        Field(description="arms of a torsion spring, at whose ends it is held and turned; left out: none"),
    ] = None

    @model_validator(mode="after")
    def _has_one_diameter(self) -> Self:
        given = [name for name in DIAMETERS if getattr(self, name) is not None]
        if len(given) != 1:
            found = f"{', '.join(given)} are given" if given else "the coil diameter is missing"
            raise ValueError(f"{found}; give one of mean_diameter, outer_diameter (De) and inner_diameter (Di)")
        return self

    @model_validator(mode="after")
    def _has_wire(self) -> Self:
        if self.wire_diameter is None and self.wire is None:
            hint = "wire diameter, mm; a number or a table over the turns"
            problem = "this entry is required; give {hint}"
            raise PydanticCustomError("missing_entry", problem, {"entry": "wire_diameter", "hint": hint})
        past = next((name for name in PAST if getattr(self, name) is not None), None)
        if self.wire is not None and past:
            raise ValueError(f"{past} is for round wire; leave it out, or wire")
        return self

    @model_validator(mode="after")
    def _relief_belongs(self) -> Self:
        if self.relieved and not self.made_by:
            raise ValueError("there is no stress to relieve; give made_by: coiling, or leave relieved out")
        return self

    @model_validator(mode="after")
    def _tails_belong(self) -> Self:
        if self.hooks is None and self.arms is None:
            return self
        name = "arms" if self.hooks is None else "hooks"
        if self.hooks is not None and self.arms is not None:
            raise ValueError("hooks are those of an extension spring, arms those of a torsion spring; leave one out")
        if self.wire is not None:
            raise ValueError(f"{name} are of round wire; leave them out, or wire")
        if self.end_coils != OPEN:
            raise ValueError(f"{name} go on from open ends; leave end_coils out")
        return self

    @property
    def diameter_entry(self) -> str:
        """Name of the entry that gives the coil diameter."""
        return next(name for name in DIAMETERS if getattr(self, name) is not None)

    @model_validator(mode="after")
    def _has_length(self) -> Self:
        if self.initial_tension is not None:
            if self.pitch is not None or self.free_length is not None or self.end_coils != OPEN:
                raise ValueError(
                    "coils with initial_tension are wound onto each other; leave pitch, free_length and end_coils out"
                )
            return self
        if self.pitch is None and self.free_length is None:
            raise ValueError("pitch and free_length are both missing; give one of them")
        return self

    def build(self) -> Spring:
        """The geometry.

        Returns:
            `Spring`.

        Raises:
            InputError: contradictory entries, with their place.
        """
        section, wire = self._wire()
        mean = self._mean_diameter(wire, 1.0 if section is None else 0.5 * float(np.ptp(section.polygon[:, 0])))
        radius = PiecewisePolynomial(0.5 * mean.c, mean.x)
        ends_and_transitions = sum(end.end_turns + end.transition_turns for end in bottom_and_top(self.end_coils))
        if ends_and_transitions >= self.turns:
            raise InputError(
                f"{self.turns:g} turns are too few: end turns and transitions alone are {ends_and_transitions:g}",
                "spring.turns",
            )

        try:
            axis = self.axis.functions(self.turns) if self.axis else None
        except ValueError as error:
            raise InputError(str(error), "spring.axis") from error

        def spring(pitch: PiecewisePolynomial) -> Spring:
            height = self._pitch_with_ends(pitch, wire, radius, section).antiderivative()
            hand, ends = 1 if self.hand == "right" else -1, bottom_and_top(self.end_coils)
            return Spring(radius, height, wire, hand, *ends, section=section, axis=axis)

        if self.initial_tension is not None:
            return self._refuse(spring(wire))
        if self.pitch is None:
            return self._refuse(self._with_free_length(spring, self.turns - ends_and_transitions))
        built = spring(self._function("pitch"))
        if self.free_length is not None and abs(built.free_length - self.free_length) > 1e-6 * self.free_length:
            raise InputError(
                f"{self.free_length:g} mm contradicts the pitch, which makes {built.free_length:.6g} mm; "
                "leave one of the two out",
                "spring.free_length",
            )
        return self._refuse(built)

    def _refuse(self, spring: Spring) -> Spring:
        """Reject impossible springs; faults of the diameter are reported at the entry that gives it."""
        tails = self.hooks or self.arms
        try:
            refuse(spring)
            return spring if tails is None else tails.on(spring, "spring.hooks" if self.hooks else "spring.arms")
        except InputError as error:
            place = error.place.replace("mean_diameter", self.diameter_entry)
            raise InputError(error.problem, place, error.file) from None

    def _wire(self) -> tuple[Any, PiecewisePolynomial]:
        """The section of a wire that is not round, and the height or diameter of any wire over the turns, mm."""
        if self.wire is None:
            return None, self._function("wire_diameter")
        section, height = self.wire.boundary()
        if section.hole and any(end.tip_thickness < 1.0 for end in bottom_and_top(self.end_coils)):
            raise InputError("a tube cannot be ground; give closed or open ends", "spring.end_coils")
        given = self.wire_diameter is not None
        wire = self._function("wire_diameter") if given else functions.constant(height, self.turns)
        return section, wire

    def _mean_diameter(self, wire: PiecewisePolynomial, width: float) -> PiecewisePolynomial:
        """D = De − d = Di + d as a function of the turn, mm, with the wire's width over its height."""
        given = self._function(self.diameter_entry)
        factor = DIAMETERS[self.diameter_entry] * width
        if factor == 0:
            return given
        mean = functions.added(given, wire, factor)
        if np.min(mean(np.unique(mean.x))) <= 0:
            raise InputError("the coil is no wider than its wire", f"spring.{self.diameter_entry}")
        return mean

    def _function(self, entry: str) -> PiecewisePolynomial:
        try:
            return profile_function(getattr(self, entry), self.turns)
        except ValueError as error:
            raise InputError(str(error), f"spring.{entry}") from error

    def _pitch_with_ends(
        self,
        pitch: PiecewisePolynomial,
        wire: PiecewisePolynomial,
        radius: PiecewisePolynomial,
        section: Any,
    ) -> PiecewisePolynomial:
        slope = radius.derivative()

        def touching(start: float, end: float) -> float:
            t = np.linspace(start, end, 65)
            return touching_pitch(wire(t), slope(t), section).max()

        return pitch_with_ends(pitch, *bottom_and_top(self.end_coils), touching)

    def _with_free_length(self, spring: Callable[[PiecewisePolynomial], Spring], body_turns: float) -> Spring:
        """The spring whose body pitch yields the free length, which grows with the pitch."""

        free_length = self.free_length
        assert free_length is not None

        def too_long(pitch: float) -> float:
            return spring(functions.constant(pitch, self.turns)).free_length - free_length

        least = too_long(0.0) + free_length
        if least >= free_length:
            raise InputError(
                f"{free_length:g} mm leave no pitch: end coils and wire alone need {least:.4g} mm",
                "spring.free_length",
            )
        from scipy.optimize import brentq

        # at the maximum pitch the body alone rises by the free length
        pitch = brentq(too_long, 0.0, free_length / body_turns, xtol=1e-12, rtol=1e-14)
        return spring(functions.constant(pitch, self.turns))


def _origin(value: Any) -> str:
    measured = "file" in value if isinstance(value, dict) else hasattr(value, "file")
    return "(measured)" if measured else "(drawn)"


SpringEntry = Annotated[
    Annotated[SpringSpec, Tag("(drawn)")]
    | Annotated[Any, Entry("coilset.meshes.measured.measured:MeasuredSpec"), Tag("(measured)")],
    Discriminator(_origin),
]
"""The `spring:` section of the case file; a spring with the entry `file` is a measured one."""
