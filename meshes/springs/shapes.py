"""How a quantity varies over the turns: a number, a table, or one of the shapes that spring makers draw."""

from typing import Annotated, Any, Literal, Self

import numpy as np
from annotated_types import Unit
from pydantic import AfterValidator, Discriminator, Field, Tag, model_validator

from coilset.meshes.springs import functions
from coilset.meshes.springs.piecewise import PiecewisePolynomial
from coilset.model.core.base.strict_entries import Strict

SHORTEST, LONGEST = 1e-3, 1e5  # mm
CLOSEST = 1e-3  # turns


def _of_a_spring(length: float) -> float:
    """0.001 to 100,000."""
    if not SHORTEST <= length <= LONGEST:
        raise ValueError(f"{length:g} is not a possible length; must be {SHORTEST:g} to {LONGEST:g}")
    return length


Length = Annotated[float, Unit("mm"), Field(gt=0, allow_inf_nan=False, strict=True), AfterValidator(_of_a_spring)]
Turn = Annotated[float, Unit("turns"), Field(ge=0, allow_inf_nan=False, strict=True)]


class Table(Strict):
    """Values at selected turns, the first at turn 0 and the last at the last turn."""

    turns: Annotated[
        tuple[Turn, ...], Field(strict=False, min_length=2, description="turns from the bottom end, increasing")
    ]
    values: Annotated[
        tuple[Length, ...],
        Field(strict=False, min_length=2, description="values at these turns, mm; rods per turn for elements_per_turn"),
    ]
    interpolation: Annotated[
        Literal["linear", "monotone", "spline"],
        Field(description="linear; monotone (cubic without overshoot, smooth slope); spline (cubic, smooth curvature)"),
    ]

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if len(self.turns) != len(self.values):
            raise ValueError(f"has {len(self.turns)} turns but {len(self.values)} values; give one value for each turn")
        if np.any(np.diff(self.turns) < CLOSEST):
            raise ValueError(f"turns must increase from one to the next, by {CLOSEST:g} or more")
        if self.turns[0] != 0:
            raise ValueError(f"must begin at turn 0, not at {self.turns[0]:g}")
        return self

    def function(self, turns: float) -> PiecewisePolynomial:
        """The table as a function of the turn; raises ValueError if it does not end at the last turn."""
        if abs(self.turns[-1] - turns) > 1e-9 * turns:
            raise ValueError(f"ends at turn {self.turns[-1]:g}, but the spring has {turns:g} turns")
        return functions.tabulated(np.array([*self.turns[:-1], turns]), np.array(self.values), self.interpolation)


class Offsets(Table):
    """Displacements of the coil's centre at selected turns, the first at turn 0 and the last at the last turn."""

    values: Annotated[
        tuple[Annotated[float, Unit("mm"), Field(ge=-LONGEST, le=LONGEST, strict=True)], ...],
        Field(strict=False, min_length=2, description="displacement from the straight axis at these turns, mm"),
    ]
    interpolation: Annotated[
        Literal["monotone", "spline"],
        Field(description="monotone (cubic without overshoot, smooth slope); spline (cubic, smooth curvature)"),
    ] = "spline"


class CurvedAxis(Strict):
    """The axis of a spring that is wound with a bow, as those of wheel suspensions: C- or S-shaped."""

    x: Annotated[Offsets | None, Field(description="offset along x")] = None
    y: Annotated[Offsets | None, Field(description="offset along y")] = None

    def functions(self, turns: float) -> tuple[PiecewisePolynomial, PiecewisePolynomial]:
        """Both offsets over the turn, mm; raises ValueError if one does not end at the last turn."""
        x, y = (functions.constant(0.0, turns) if one is None else one.function(turns) for one in (self.x, self.y))
        return x, y


class Cylinder(Strict):
    """The same diameter at every turn."""

    shape: Literal["cylinder"]
    diameter: Annotated[Length, Field(description="mean coil diameter, mm")]

    def function(self, turns: float) -> PiecewisePolynomial:
        """The diameter as a function of the turn, mm."""
        return functions.constant(self.diameter, turns)


class Cone(Strict):
    """A diameter that changes by the same amount every turn."""

    shape: Literal["cone"]
    bottom: Annotated[Length, Field(description="mean coil diameter at the bottom end, mm")]
    top: Annotated[Length, Field(description="mean coil diameter at the top end, mm")]

    def function(self, turns: float) -> PiecewisePolynomial:
        """The diameter as a function of the turn, mm."""
        return functions.polynomial([self.bottom, (self.top - self.bottom) / turns], 0.0, turns)


class Funnel(Strict):
    """A cone at the bottom end that continues as a cylinder (the funnel's neck) to the top end."""

    shape: Literal["funnel"]
    bottom: Annotated[Length, Field(description="mean coil diameter at the bottom end, mm")]
    neck: Annotated[Length, Field(description="mean coil diameter of the cylinder, mm")]
    cone_turns: Annotated[
        float, Unit("turns"), Field(ge=0.1, allow_inf_nan=False, strict=True, description="turns of the cone")
    ]

    def function(self, turns: float) -> PiecewisePolynomial:
        """The diameter as a function of the turn, mm; raises ValueError if the cone has too many turns."""
        if self.cone_turns >= turns:
            raise ValueError(
                f"cone_turns is {self.cone_turns:g}, but the spring has only {turns:g} turns; "
                "leave some for the neck, or use the shape cone"
            )
        return functions.tabulated(
            np.array([0, self.cone_turns, turns]), np.array([self.bottom, self.neck, self.neck]), "linear"
        )


class _Waisted(Strict):
    ends: Annotated[Length, Field(description="mean coil diameter at both ends, mm")]
    middle: Annotated[Length, Field(description="mean coil diameter at half of the turns, mm")]


class DoubleCone(_Waisted):
    """Two equal cones, base on base or tip on tip; the diameter has its maximum or minimum in the middle."""

    shape: Literal["double cone"]

    def function(self, turns: float) -> PiecewisePolynomial:
        """The diameter as a function of the turn, mm."""
        return functions.tabulated(
            np.array([0, turns / 2, turns]), np.array([self.ends, self.middle, self.ends]), "linear"
        )


class _Parabola(_Waisted):
    def function(self, turns: float) -> PiecewisePolynomial:
        """The diameter as a function of the turn, mm: a parabola with its vertex in the middle."""
        rise = self.middle - self.ends
        return functions.polynomial([self.ends, 4 * rise / turns, -4 * rise / turns**2], 0.0, turns)


class Barrel(_Parabola):
    """A parabola, widest in the middle."""

    shape: Literal["barrel"]

    @model_validator(mode="after")
    def _is_wide(self) -> Self:
        if self.middle <= self.ends:
            raise ValueError(
                f"a barrel is wider in its middle ({self.middle:g} mm) than at its ends "
                f"({self.ends:g} mm); the other way round it is an hourglass"
            )
        return self


class Hourglass(_Parabola):
    """A parabola, narrowest in the middle."""

    shape: Literal["hourglass"]

    @model_validator(mode="after")
    def _is_narrow(self) -> Self:
        if self.middle >= self.ends:
            raise ValueError(
                f"an hourglass is narrower in its middle ({self.middle:g} mm) than at its ends "
                f"({self.ends:g} mm); the other way round it is a barrel"
            )
        return self


SHAPES = {
    "cylinder": Cylinder,
    "cone": Cone,
    "double cone": DoubleCone,
    "hourglass": Hourglass,
    "barrel": Barrel,
    "funnel": Funnel,
}


def form_of_entry(value: Any) -> str:
    """Tag of the form of an entry; brackets mark tags, which are not part of its place in the case file."""
    if isinstance(value, dict):
        return f"({value['shape']})" if "shape" in value else "(table)"
    if isinstance(value, Strict):
        return f"({getattr(value, 'shape', 'table')})"
    return "(number)"


Profile = Annotated[
    Annotated[Length, Tag("(number)")] | Annotated[Table, Tag("(table)")],
    Discriminator(form_of_entry, custom_error_type="form", custom_error_message="must be a number or a table"),
]
"""A length over the turns: a number in mm, or a table."""

DiameterProfile = Annotated[
    Annotated[Length, Tag("(number)")]
    | Annotated[Table, Tag("(table)")]
    | Annotated[Cylinder, Tag("(cylinder)")]
    | Annotated[Cone, Tag("(cone)")]
    | Annotated[DoubleCone, Tag("(double cone)")]
    | Annotated[Hourglass, Tag("(hourglass)")]
    | Annotated[Barrel, Tag("(barrel)")]
    | Annotated[Funnel, Tag("(funnel)")],
    Discriminator(
        form_of_entry,
        custom_error_type="form",
        custom_error_message=f"must be a number, a table, or one of the shapes {', '.join(SHAPES)}",
    ),
]
"""The mean coil diameter over the turns: a number in mm, a table, or a shape."""


def profile_function(profile: Any, turns: float) -> PiecewisePolynomial:
    """A number, table or shape as a function of the turn."""
    return functions.constant(profile, turns) if isinstance(profile, float | int) else profile.function(turns)
