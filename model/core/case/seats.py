"""The `seats` section of a case: shape of both seats, how they hold the end coils, and how they are held themselves."""

import math
from typing import Annotated, Literal, Self

from annotated_types import Unit
from pydantic import Field, model_validator

from coilset.model.core.base.entry import Strict
from coilset.model.core.case.head_freedoms import HeadSpec

GROOVE = 0.75  # turns of the groove that are usual: what grinding makes flat


class SeatSpec(HeadSpec):
    """One seat, and how it is held; along the spring's axis it moves by the load program."""

    shape: Annotated[Literal["flat", "conical", "stepped"], Field(description="shape of its surface")] = "flat"
    angle: Annotated[
        float | None,
        Unit("degrees"),
        Field(gt=-60, lt=60, description="slope of a conical seat, degrees; positive if it rises outwards"),
    ] = None
    turns: Annotated[
        float | None,
        Unit("turns"),
        Field(gt=0, description="turns from the tip over which a stepped seat follows the wire"),
    ] = None

    @model_validator(mode="after")
    def _belongs(self) -> Self:
        for name, shape in (("angle", "conical"), ("turns", "stepped")):
            given = getattr(self, name) is not None
            if given and self.shape != shape:
                raise ValueError(f"{name} is for {shape} seats, not for {self.shape} ones")
            if not given and self.shape == shape:
                raise ValueError(f"a {shape} seat needs its {name}, as in {{shape: {shape}, {name}: 0.75}}")
        return self

    @property
    def slope(self) -> float:
        """tan β of a cone, else 0."""
        return math.tan(math.radians(self.angle or 0.0))


class SeatsSpec(Strict):
    """Both seats."""

    hold: Annotated[
        Literal["tips", "groove"],
        Field(
            description="tips: held sideways and against rotation, as in pockets; groove: end coils in a smooth groove"
        ),
    ] = "tips"
    groove: Annotated[
        float | None, Unit("turns"), Field(gt=0, description=f"length of the groove, {GROOVE:g} turns if not given")
    ] = None
    bottom: Annotated[SeatSpec, Field(description="the bottom seat")] = SeatSpec()
    top: Annotated[SeatSpec, Field(description="the top seat")] = SeatSpec()

    @model_validator(mode="after")
    def _no_rigid_motion(self) -> Self:
        if self.groove is not None and self.hold != "groove":
            raise ValueError("groove is the length of a groove; give hold: groove with it")
        for end in ("bottom", "top"):
            if self.hold == "tips" and getattr(self, end).moves:
                raise ValueError(
                    f"the {end} seat moves, but tips are held in space; give hold: groove, which moves with its seat"
                )
        for name in ("sideways", "turn"):
            if getattr(self.bottom, name) == getattr(self.top, name) == "free":
                raise ValueError(f"{name}: both seats are free, so the spring floats; hold one, or give a stiffness")
        return self

    @property
    def groove_turns(self) -> float:
        """Length of the groove in turns."""
        return self.groove or GROOVE
