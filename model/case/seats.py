"""The `seats` section of a case: shape of both seats, how they hold the end coils, and how they are held themselves."""

import math
from typing import Annotated, Literal, Self

from annotated_types import Unit
from pydantic import Field, Tag, model_validator

from coilset.model.base.entry import WORD_OR_NUMBER, Strict

Freedom = Annotated[
    Annotated[Literal["held", "free"], Tag("(word)")] | Annotated[float, Field(gt=0), Tag("(number)")], WORD_OR_NUMBER
]
"""How a seat is held in one freedom: `held`, `free`, or on a spring of this stiffness."""
FREEDOMS = {"sideways": (0, 1), "tilt": (3, 4), "turn": (5,)}  # degrees of freedom of a seat
GROOVE = 0.75  # turns of the groove that are usual: what grinding makes flat


class SeatSpec(Strict):
    """One seat, and how it is held; along the spring's axis it moves as the load program says."""

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
    sideways: Annotated[
        Freedom, Unit("N/mm"), Field(description="sideways motion: held, free, or a stiffness in N/mm")
    ] = "held"
    tilt: Annotated[
        Freedom, Unit("N mm/rad"), Field(description="tilting: held, free (ball joint), or a stiffness in N mm/rad")
    ] = "held"
    turn: Annotated[
        Freedom,
        Unit("N mm/rad"),
        Field(description="rotation about the spring's axis: held, free, or a stiffness in N mm/rad"),
    ] = "held"

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

    def held(self) -> list[int]:
        """Degrees of freedom that are held, without the level; the others are free or on springs."""
        return [dof for name, dofs in FREEDOMS.items() for dof in dofs if getattr(self, name) == "held"]

    def springs(self) -> dict[int, float]:
        """Stiffness by degree of freedom, a dict, N/mm and N mm/rad."""
        given = {name: getattr(self, name) for name in FREEDOMS}
        return {dof: k for name, k in given.items() if not isinstance(k, str) for dof in FREEDOMS[name]}

    @property
    def moves(self) -> bool:
        """Whether it moves otherwise than along the axis."""
        return any(getattr(self, name) != "held" for name in FREEDOMS)


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
