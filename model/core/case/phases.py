"""The `loading` section of a case: a list of targets and times, each reached in a number of steps."""

from collections.abc import Sequence
from typing import Annotated, Any, Literal, Self

from annotated_types import Unit
from pydantic import AfterValidator, Discriminator, Field, Tag, model_validator

from coilset.model.core.base.entry import Strict, Whole
from coilset.model.core.case.head_freedoms import HeadTarget
from coilset.model.core.equilibrium.settings import Drive


class Target(Strict):
    """One of travel, height or force, compression positive, and targets of the heads' other freedoms."""

    travel: Annotated[float | None, Unit("mm"), Field(description="shortening of the spring since the start, mm")] = (
        None
    )
    height: Annotated[float | None, Unit("mm"), Field(gt=0, description="distance between the seats, mm")] = None
    force: Annotated[float | None, Unit("N"), Field(description="axial force, compression positive, N")] = None
    bottom: Annotated[HeadTarget | None, Field(description="other freedoms of the bottom head")] = None
    top: Annotated[HeadTarget | None, Field(description="other freedoms of the top head")] = None

    @property
    def heads(self) -> dict[str, HeadTarget]:
        """Targets of the heads' other freedoms, by end."""
        given = {"bottom": self.bottom, "top": self.top}
        return {end: target for end, target in given.items() if target is not None}

    @property
    def axial(self) -> dict[str, float]:
        """Travel, height or force, by its name; empty if none is given."""
        given = {"travel": self.travel, "height": self.height, "force": self.force}
        return {name: value for name, value in given.items() if value is not None}

    @model_validator(mode="after")
    def _one(self) -> Self:
        count = len(self.axial)
        if count > 1 or (not count and not self.heads):
            raise ValueError("give exactly one of travel (mm), height (mm) or force (N), as in {force: 0}")
        tables = any(target.tables for target in self.heads.values())
        if tables and (not count or self.force is not None):
            raise ValueError("a table over the travel needs a travel or height to go to, as in {travel: 80, top: ...}")
        return self


def _kind(value: Any) -> str:
    """A target with entries, or the word `block`."""
    return "(target)" if isinstance(value, dict | Target) else "(block)"


def _ascending(marks: list[float]) -> list[float]:
    """Above 0, ascending, the last 1."""
    if any(after <= before for before, after in zip([0.0, *marks], marks, strict=False)) or marks[-1] != 1.0:
        raise ValueError("must ascend from above 0 to 1, as in [0.1, 0.4, 1]")
    return marks


def _form(value: Any) -> str:
    """A word, a list or a number."""
    return "(word)" if isinstance(value, str) else "(list)" if isinstance(value, list | tuple) else "(number)"


Marks = Annotated[
    list[Annotated[float, Unit("1")]], Field(min_length=1, max_length=100_000, strict=False), AfterValidator(_ascending)
]
"""Parts of a phase at which its steps end."""


class Stepped(Strict):
    """A phase in steps."""

    steps: Annotated[
        Annotated[Whole, Field(gt=0, le=100_000), Tag("(number)")]
        | Annotated[Literal["auto"], Tag("(word)")]
        | Annotated[Marks, Tag("(list)")],
        Discriminator(_form),
        Field(
            description="auto: as long as accuracy and convergence allow; or a number of equal steps; or the "
            "fractions of the phase at which the steps end"
        ),
    ] = "auto"

    def count(self, automatic: int) -> int:
        """Number of its steps; that of an automatic phase as it is planned, `automatic`."""
        if isinstance(self.steps, str):
            return automatic
        return len(self.steps) if isinstance(self.steps, list) else self.steps


class Phase(Stepped):
    """Go to a target in steps."""

    to: Annotated[
        Annotated[Literal["block"], Tag("(block)")] | Annotated[Target, Tag("(target)")],
        Discriminator(_kind),
        Field(
            description="block, {travel: mm}, {height: mm} or {force: N}; with it or alone `bottom` and `top`, targets "
            "of the heads' other freedoms"
        ),
    ]

    seconds: Annotated[
        float | None,
        Unit("s"),
        Field(
            gt=0,
            le=1e9,
            description="duration of a phase, where heat flows (entry `heat`) or yield depends on "
            "the rate; without it a step is infinitely slow",
        ),
    ] = None

    @property
    def label(self) -> str:
        """The target in words, for progress and logs."""
        if self.to == "block":
            return "block"
        words = [f"{name} {value:g} {'N' if name == 'force' else 'mm'}" for name, value in self.to.axial.items()]
        words += [f"{end} {target.label}" for end, target in self.to.heads.items()]
        return ", ".join(words)

    @property
    def heads(self) -> dict[str, HeadTarget]:
        """Targets of the heads' freedoms other than the axial one, by end."""
        return {} if isinstance(self.to, str) else self.to.heads

    @property
    def drives_axially(self) -> bool:
        """Whether it has a travel, height or force to go to."""
        return isinstance(self.to, str) or bool(self.to.axial)

    @property
    def gives_force(self) -> bool:
        """Whether it goes to an axial force."""
        return not isinstance(self.to, str) and self.to.force is not None

    def goal(self, free_length: float, block_height: float) -> tuple[Literal["height", "force"], float]:
        """The driven quantity, height between the seats, mm, or axial force, N, and its value at the end.

        Of a phase that drives other freedoms only, the free length; see `drives_axially`.
        """
        if self.to == "block":
            return "height", block_height
        if self.to.force is not None:
            return "force", self.to.force
        return "height", self.to.height if self.to.height is not None else free_length - (self.to.travel or 0.0)


class Duration(Strict):
    """How long, and what stays as it was meanwhile."""

    hours: Annotated[float | None, Unit("h"), Field(gt=0, le=1e7, description="duration in hours")] = None
    minutes: Annotated[float | None, Unit("min"), Field(gt=0, le=1e9, description="duration in minutes")] = None
    keep: Annotated[Literal["height", "force"], Field(description="what is kept constant: the height or the force")] = (
        "height"
    )

    @model_validator(mode="after")
    def _one_length(self) -> Self:
        if (self.hours is None) == (self.minutes is None):
            raise ValueError("give exactly one of hours or minutes, as in {hours: 48}")
        return self

    @property
    def length(self) -> float:
        """Hours."""
        return self.hours if self.hours is not None else (self.minutes or 0.0) / 60.0

    @property
    def words(self) -> str:
        """The length as it was given."""
        return f"{self.hours:g} h" if self.hours is not None else f"{self.minutes:g} min"


class Hold(Duration):
    """Let time pass at the present temperature. Equal steps are equal in the logarithm of time."""


class Heat(Duration):
    """Heat or cool the whole spring, or with the entry `heat` of the case air and seats; linearly in time."""

    to: Annotated[
        float,
        Unit("K"),
        Field(gt=0, description="temperature at the end, K; with the entry heat of the case that of air and seats"),
    ]


class TimePhase(Stepped):
    """Let time pass; the material must creep."""

    hold: Annotated[Hold | None, Field(description="a time at the present temperature, as in {hours: 48}")] = None
    heat: Annotated[Heat | None, Field(description="a change of temperature, as in {to: 393, minutes: 20}")] = None

    @model_validator(mode="after")
    def _one(self) -> Self:
        if (self.hold is None) == (self.heat is None):
            raise ValueError("give exactly one of hold or heat, as in {hold: {hours: 48}}")
        return self

    @property
    def duration(self) -> Duration:
        """Duration, and the quantity kept constant."""
        duration = self.hold or self.heat
        assert duration is not None
        return duration

    @property
    def temperature(self) -> float | None:
        """At its end, K; None if it stays."""
        return self.heat.to if self.heat else None

    @property
    def label(self) -> str:
        """In words, for progress and logs."""
        doing = f"heat to {self.heat.to:g} K in" if self.heat else "hold"
        return f"{doing} {self.duration.words} at constant {self.duration.keep}"


def _passes_time(value: Any) -> str:
    """An entry of time, or a target."""
    timed = isinstance(value, TimePhase) or (isinstance(value, dict) and bool({"hold", "heat"} & value.keys()))
    return "(time)" if timed else "(target)"


AnyPhase = Annotated[
    Annotated[Phase, Tag("(target)")] | Annotated[TimePhase, Tag("(time)")], Discriminator(_passes_time)
]
"""A phase of a load program."""


def heads_of(phase: AnyPhase) -> dict[str, HeadTarget]:
    """Targets of the heads besides the axis in a phase, by end."""
    return phase.heads if isinstance(phase, Phase) else {}


def drives_at(loading: Sequence[AnyPhase], number: int) -> tuple[Drive, ...]:
    """Targets of the heads' freedoms in a phase, by its number.

    A freedom that it does not name stays as an earlier phase left it: where it is, or under its force.
    """
    found: dict[int, Drive] = {}
    for phase in loading[: number + 1]:
        found = {freedom: Drive(freedom, drive.kind, None) for freedom, drive in found.items()}
        for end, target in heads_of(phase).items():
            found |= {drive.freedom: drive for drive in target.drives(6 * ("bottom", "top").index(end))}
    return tuple(found.values())
