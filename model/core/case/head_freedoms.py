"""How the heads of a spring are held and driven: entries of `seats`, `heads` and of the targets of a phase."""

import math
from collections.abc import Iterator
from typing import Annotated, Any, Literal, Self

from annotated_types import Unit
from pydantic import Discriminator, Field, Tag, model_validator

from coilset.model.core.base.entry import WORD_OR_NUMBER, Strict
from coilset.model.core.equilibrium.settings import Drive

Freedom = Annotated[
    Annotated[Literal["held", "free"], Tag("(word)")] | Annotated[float, Field(gt=0), Tag("(number)")], WORD_OR_NUMBER
]
"""How a head is held in one freedom: `held`, `free`, or on a spring of this stiffness."""
FREEDOMS = {"sideways": (0, 1), "tilt": (3, 4), "turn": (5,)}  # of a head, besides the axial one
CONJUGATE = {"side_force": "sideways", "tilt_moment": "tilt", "torque": "turn"}


class HeadSpec(Strict):
    """How a head is held; along the spring's axis it moves by the load program."""

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


class HeadsSpec(Strict):
    """Both heads of a spring whose tips are clamped."""

    bottom: Annotated[HeadSpec, Field(description="the bottom head")] = HeadSpec()
    top: Annotated[HeadSpec, Field(description="the top head")] = HeadSpec()

    @model_validator(mode="after")
    def _no_rigid_motion(self) -> Self:
        for end in ("bottom", "top"):
            if getattr(self, end).springs():
                raise ValueError(f"the {end} head of a clamped wire is held or free; springs need ends: seats")
        for name in ("sideways", "turn"):
            if getattr(self.bottom, name) == getattr(self.top, name) == "free":
                raise ValueError(f"{name}: both heads are free, so the spring floats; hold one")
        return self


Point = Annotated[list[Annotated[float, Unit("mm")]], Field(strict=False, min_length=3, max_length=3)]


class DamperSpec(Strict):
    """The axis of a damper inside or beside the spring."""

    point: Annotated[Point, Field(description="a point of it, mm: that about which its moment is reported")]
    direction: Annotated[Point, Field(default_factory=lambda: [0.0, 0.0, 1.0], description="along it, of any length")]
    guides: Annotated[
        list[Annotated[float, Unit("mm")]] | None,
        Field(
            strict=False,
            min_length=2,
            max_length=2,
            description="where rod guide and piston hold the rod, along the axis from the point, mm; with friction",
        ),
    ] = None
    friction: Annotated[
        float | None, Unit("1"), Field(gt=0, lt=2, description="friction coefficient of the rod at both guides")
    ] = None

    @model_validator(mode="after")
    def _leads_somewhere(self) -> Self:
        if not any(self.direction):
            raise ValueError("direction is zero; give one such as [0, 0, 1]")
        if (self.guides is None) != (self.friction is None):
            raise ValueError("guides and friction belong together, as in {guides: [0, -120], friction: 0.05}")
        if self.guides is not None and self.guides[0] == self.guides[1]:
            raise ValueError("guides at one place hold no moment; give two, as in [0, -120]")
        return self


class ForceLineSpec(Strict):
    """Where the line of action of the spring's force is reported, in seats.csv."""

    lower: Annotated[
        float | None, Unit("mm"), Field(description="height of a plane above the bottom seat that the line crosses, mm")
    ] = None
    upper: Annotated[float | None, Unit("mm"), Field(description="height of a second plane, mm")] = None
    damper: Annotated[DamperSpec | None, Field(description="a damper that the force bends and turns")] = None


class OverTravel(Strict):
    """Values over the travel, linear between them."""

    travel: Annotated[
        list[Annotated[float, Unit("mm")]],
        Field(strict=False, min_length=2, max_length=10_000, description="travels, mm, ascending"),
    ]
    values: Annotated[
        list[Annotated[float, Unit("as the entry")]],
        Field(strict=False, min_length=2, max_length=10_000, description="the values there"),
    ]

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if len(self.travel) != len(self.values):
            raise ValueError(f"has {len(self.travel)} travels but {len(self.values)} values; give one for each")
        if any(b <= a for a, b in zip(self.travel, self.travel[1:], strict=False)):
            raise ValueError("travel must ascend, as in [0, 40, 80]")
        return self


def _form(value: Any) -> str:
    return "(table)" if isinstance(value, dict | OverTravel) else "(number)"


Millimetres = Annotated[
    Annotated[float, Unit("mm"), Tag("(number)")] | Annotated[OverTravel, Tag("(table)")], Discriminator(_form)
]
Degrees = Annotated[
    Annotated[float, Unit("degrees"), Tag("(number)")] | Annotated[OverTravel, Tag("(table)")], Discriminator(_form)
]
Newtons = Annotated[
    Annotated[float, Unit("N"), Tag("(number)")] | Annotated[OverTravel, Tag("(table)")], Discriminator(_form)
]
NewtonMillimetres = Annotated[
    Annotated[float, Unit("N mm"), Tag("(number)")] | Annotated[OverTravel, Tag("(table)")], Discriminator(_form)
]
"""A number, or a table of it over the travel."""


class HeadTarget(Strict):
    """Displacement of a head, or load on it, besides the axis: x and y across the spring's axis, or about it."""

    sideways: Annotated[
        list[Millimetres] | None,
        Field(strict=False, min_length=2, max_length=2, description="displacement along x and y, mm"),
    ] = None
    tilt: Annotated[
        list[Degrees] | None,
        Field(strict=False, min_length=2, max_length=2, description="rotation about x and y, degrees"),
    ] = None
    turn: Annotated[Degrees | None, Field(description="rotation about the spring's axis, degrees")] = None
    side_force: Annotated[
        list[Newtons] | None,
        Field(strict=False, min_length=2, max_length=2, description="force along x and y on the head, N"),
    ] = None
    tilt_moment: Annotated[
        list[NewtonMillimetres] | None,
        Field(strict=False, min_length=2, max_length=2, description="moment about x and y on the head, N mm"),
    ] = None
    torque: Annotated[NewtonMillimetres | None, Field(description="moment about the axis on the head, N mm")] = None

    @model_validator(mode="after")
    def _one_of_each(self) -> Self:
        for force, value in CONJUGATE.items():
            if getattr(self, force) is not None and getattr(self, value) is not None:
                raise ValueError(f"{value} and {force} are both given; prescribe one of them")
        if not self._given:
            raise ValueError("is empty; give sideways, tilt, turn, side_force, tilt_moment or torque")
        return self

    @property
    def _given(self) -> dict[str, list[float | OverTravel]]:
        """Values by entry, each as a list."""
        given = {name: getattr(self, name) for name in (*FREEDOMS, *CONJUGATE)}
        return {name: [*_listed(value)] for name, value in given.items() if value is not None}

    @property
    def tables(self) -> bool:
        """Whether any value is a table over the travel."""
        return any(isinstance(value, OverTravel) for values in self._given.values() for value in values)

    @property
    def values(self) -> list[str]:
        """Names of the freedoms whose value is prescribed."""
        return [name for name in self._given if name in FREEDOMS]

    @property
    def loaded(self) -> list[str]:
        """Names of the freedoms whose conjugate force is prescribed."""
        return [CONJUGATE[name] for name in self._given if name in CONJUGATE]

    @property
    def rotates(self) -> bool:
        """Whether a rotation of the head is driven."""
        return any(CONJUGATE.get(name, name) != "sideways" for name in self._given)

    @property
    def label(self) -> str:
        """In words, for progress and logs."""
        units = {"sideways": "mm", "tilt": "°", "turn": "°", "side_force": "N", "tilt_moment": "N mm", "torque": "N mm"}
        words = []
        for name, values in self._given.items():
            numbers = ", ".join(
                f"{value.values[0]:g} to {value.values[-1]:g}" if isinstance(value, OverTravel) else f"{value:g}"
                for value in values
            )
            words.append(f"{name.replace('_', ' ')} {numbers} {units[name]}")
        return ", ".join(words)

    def drives(self, first: int) -> Iterator[Drive]:
        """Targets of its freedoms; `first`: number of the head's first freedom."""
        for name, values in self._given.items():
            kind: Literal["value", "force"] = "force" if name in CONJUGATE else "value"
            size = math.pi / 180.0 if name in ("tilt", "turn") else 1.0
            for dof, value in zip(FREEDOMS[CONJUGATE.get(name, name)], values, strict=True):
                if isinstance(value, OverTravel):
                    table = tuple(value.travel), tuple(size * one for one in value.values)
                    yield Drive(first + dof, kind, None, table)
                else:
                    yield Drive(first + dof, kind, size * value)


def _listed(value: Any) -> list[Any]:
    return value if isinstance(value, list) else [value]
