"""The entry `spring.wire`: a cross-section that is not a circle, and how it is turned to the coil."""

from collections.abc import Callable
from functools import lru_cache
from typing import TYPE_CHECKING, Annotated, Self

import numpy as np
from annotated_types import Unit
from pydantic import Field, ValidationInfo, field_validator, model_validator

from coilset.meshes.sections.boundary import Boundary
from coilset.meshes.springs.shapes import Length
from coilset.model.core.base.errors import InputError
from coilset.model.core.base.strict_entries import Strict

if TYPE_CHECKING:
    from coilset.meshes.sections.shapes import Outline

Radius = Annotated[float, Unit("mm"), Field(ge=0, le=1e5)]
OFF_CENTRE = 0.02  # of the height: how far from the centre line the middle of a given outline may be


class OvalSpec(Strict):
    """An ellipse."""

    width: Annotated[Length, Field(description="across the coil's axis, mm")]
    height: Annotated[Length, Field(description="along the spring, mm")]


class RectangleSpec(OvalSpec):
    """A rectangle with rounded corners."""

    corner: Annotated[Radius, Field(description="radius of the corners, mm; 0 leaves them sharp")] = 0.0


class EggSpec(Strict):
    """Two circles and their common tangents, the egg-shaped wire of Fuchs."""

    inside: Annotated[Length, Field(description="radius of the circle at the inside of the coil, mm")]
    outside: Annotated[Length, Field(description="radius of the circle at the outside of the coil, mm")]
    distance: Annotated[Length, Field(description="distance of the circles' centres, mm")]


class TrapezoidSpec(Strict):
    """A trapezium with two sides parallel to the coil's axis and rounded corners, such as keystone wire."""

    width: Annotated[Length, Field(description="across the coil's axis, mm")]
    inside: Annotated[Length, Field(description="height at the inside of the coil, mm")]
    outside: Annotated[Length, Field(description="height at the outside of the coil, mm")]
    corner: Annotated[Radius, Field(description="radius of the corners, mm; 0 leaves them sharp")] = 0.0


class TubeSpec(Strict):
    """A round tube."""

    outer: Annotated[Length, Field(description="outer diameter, mm")]
    inner: Annotated[Length, Field(description="inner diameter, mm")]


class WireSpec(Strict):
    """The cross-section of a wire that is not round; give one of the shapes.

    Its height along the spring takes the place of the wire diameter.
    """

    oval: Annotated[OvalSpec | None, Field(description="an ellipse")] = None
    rectangle: Annotated[RectangleSpec | None, Field(description="a rectangle")] = None
    egg: Annotated[EggSpec | None, Field(description="two circles and their common tangents")] = None
    trapezoid: Annotated[TrapezoidSpec | None, Field(description="a trapezium, such as keystone wire")] = None
    tube: Annotated[TubeSpec | None, Field(description="a round tube")] = None
    outline: Annotated[
        str | None,
        Field(description="CSV file of points ξ (away from the coil's axis) and η (upwards) from the centre line, mm"),
    ] = None
    smooth: Annotated[
        bool, Field(description="whether a spline joins the points of the outline instead of straight lines")
    ] = False
    angle: Annotated[
        float,
        Unit("°"),
        Field(ge=-90, le=90, description="by which its inner side is turned upwards about the wire's axis"),
    ] = 0.0

    @property
    def shape(self) -> str:
        """Name of the entry that gives the shape."""
        return next(name for name in SHAPES if getattr(self, name) is not None)

    @field_validator("outline")
    @classmethod
    def _from_folder(cls, outline: str | None, info: ValidationInfo) -> str | None:
        """The path counts from the folder of the case file, where the context has one."""
        from pathlib import Path

        folder = (info.context or {}).get("folder")
        return outline if folder is None or outline is None else str(Path(folder) / outline)

    @model_validator(mode="after")
    def _has_one_shape(self) -> Self:
        given = [name for name in SHAPES if getattr(self, name) is not None]
        if len(given) != 1:
            found = f"{', '.join(given)} are given" if given else "no shape is given"
            raise ValueError(f"{found}; give one of {', '.join(SHAPES)}")
        if self.smooth and self.outline is None:
            raise ValueError("smooth belongs to an outline; leave it out")
        return self

    def drawn(self) -> "Outline":
        """The outline, mm, before it is turned by `angle`.

        Raises:
            InputError: lengths that make none, or a file that cannot be read.
        """
        from coilset.meshes.sections import shapes  # gmsh: not where wire is round

        if self.outline is not None:
            return shapes.Curve.read(self.outline, self.smooth)
        makers: dict[str, Callable[..., Outline]] = {
            "oval": shapes.Oval,
            "rectangle": shapes.rectangle,
            "egg": shapes.Egg,
            "trapezoid": shapes.Trapezoid,
            "tube": shapes.Tube,
        }
        make = makers[self.shape]
        try:
            return make(**dict(getattr(self, self.shape)))
        except InputError as error:
            entry = error.place.removeprefix("section.")
            raise InputError(error.problem, f"spring.wire.{self.shape}.{entry}") from None

    def boundary(self) -> tuple[Boundary, float]:
        """The boundary in half its height, y towards the coil's axis and z upwards, and that height, mm.

        Raises:
            InputError: if there is none, or it is not about the centre line.
        """
        return _boundary(self)


SHAPES = ("oval", "rectangle", "egg", "trapezoid", "tube", "outline")


@lru_cache(maxsize=64)
def _boundary(wire: WireSpec) -> tuple[Boundary, float]:
    place = f"spring.wire.{wire.shape}"
    try:
        found = Boundary.of(wire.drawn(), np.radians(wire.angle))
    except InputError as error:
        raise InputError(error.problem, error.place.replace("section", place, 1), error.file) from None
    height = float(found.high[1] - found.low[1])
    middle = 0.5 * (found.low + found.high)
    if wire.outline is not None and np.abs(middle).max() > OFF_CENTRE * height:
        ξ, η = -middle[0], middle[1]
        raise InputError(
            f"the middle of the outline is at ξ = {ξ:.4g}, η = {η:.4g} mm; give its points from the centre line, "
            "the middle of its width and height",
            place,
        )
    return found.moved(-middle).scaled(2.0 / height, 2.0 / height), height
