"""The unknowns of a design: ranges, factors on the case's own values, lists to choose from; the entries they drive."""

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Self

from annotated_types import Unit
from pydantic import BeforeValidator, Discriminator, Field, Tag, model_validator

from coilset.model.core.base.entry import Strict
from coilset.model.core.base.errors import InputError
from coilset.model.core.case.names import EntryName, entry_name
from coilset.model.core.case.settings import put, value_at

Name = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_.]*$")]
ONE, NONE = 1.0, 0.0  # factor and offset of an entry that takes the unknown itself


class Tied(Strict):
    """An entry that follows an unknown: factor times the unknown, plus offset."""

    entry: Annotated[Name, Field(description="entry of the case")]
    factor: Annotated[float, Unit("1"), Field(description="factor on the unknown")] = ONE
    offset: Annotated[float, Unit("of the entry"), Field(description="added to it")] = NONE

    @model_validator(mode="after")
    def _follows(self) -> Self:
        if self.factor == 0.0:
            raise ValueError("factor 0 leaves the entry as it is; leave the entry out, or give another factor")
        return self


AnyEntry = Annotated[
    Annotated[Name, Tag("(name)")] | Annotated[Tied, Tag("(tied)")],
    Discriminator(lambda value: "(tied)" if isinstance(value, dict | Tied) else "(name)"),
]
Entries = Annotated[
    list[AnyEntry] | None,
    Field(min_length=1, description="entries of the case that the unknown drives; default: the one of its name"),
]
Label = Annotated[str | None, Field(description="name in tables and on the page; default: that of the entry")]


class Driving(Strict):
    """What all unknowns that take the value of an entry have in common."""

    entries: Entries = None
    label: Label = None

    def tied(self, name: str) -> list[Tied]:
        """The entries that it drives."""
        entries = self.entries or [name]
        return [Tied(entry=one) if isinstance(one, str) else one for one in entries]

    def driven(self, name: str) -> list[str]:
        """The paths of these entries."""
        return [one.entry for one in self.tied(name)]

    def put(self, name: str, value: float, data: dict[str, Any]) -> None:
        """Write a value of the unknown into the raw data of a case; raises InputError if there is no such entry."""
        for one in self.tied(name):
            put(data, one.entry, one.factor * value + one.offset, f"find.{name}")

    def own(self, name: str, data: Any) -> float:
        """The value that the case has; NaN if it is missing or not a number."""
        one = self.tied(name)[0]
        return (_number(data, one.entry) - one.offset) / one.factor

    def named(self, name: str, data: Mapping[str, Any]) -> EntryName:
        """The unknown in words."""
        one = self.tied(name)[0]
        found = entry_name(one.entry, data)
        words = found.words if self.entries is None else name.replace("_", " ")
        return EntryName(self.label or words, found.unit)


class Bounds(Driving):
    """A range; `[9, 15]` in short."""

    low: Annotated[float, Unit("of the entry"), Field(alias="from", description="minimum value")]
    high: Annotated[float, Unit("of the entry"), Field(alias="to", description="maximum value")]

    @model_validator(mode="after")
    def _order(self) -> Self:
        if self.low >= self.high:
            raise ValueError(f"from {self.low:g} to {self.high:g} is not a range; 'from' must be the smaller one")
        return self


class Choices(Driving):
    """A list of values, of which one is chosen; of several that meet all conditions the first in the list."""

    choices: Annotated[
        list[float],
        Unit("of the entry"),
        Field(min_length=2, max_length=1000, strict=False, description="values, the preferred ones first"),
    ]

    @model_validator(mode="after")
    def _different(self) -> Self:
        if len(set(self.choices)) < len(self.choices):
            raise ValueError("choices holds a value twice; give each once")
        return self

    @property
    def low(self) -> float:
        """Minimum value."""
        return min(self.choices)

    @property
    def high(self) -> float:
        """Maximum value."""
        return max(self.choices)


class Scale(Strict):
    """A factor on the case's own values: of a number, of all values of a table, of all diameters of a shape."""

    scale: Annotated[
        tuple[float, float], Unit("1"), Field(strict=False, description="minimum and maximum factor, as in [0.8, 1.2]")
    ]
    entries: Annotated[
        list[Name] | None,
        Field(min_length=1, description="entries of the case that are scaled; default: the one of its name"),
    ] = None
    label: Label = None

    @model_validator(mode="after")
    def _order(self) -> Self:
        low, high = self.scale
        if not 0.0 < low < high:
            raise ValueError(
                f"scale from {low:g} to {high:g} is not a range of positive factors; give the smaller one first"
            )
        return self

    @property
    def low(self) -> float:
        """Minimum factor."""
        return self.scale[0]

    @property
    def high(self) -> float:
        """Maximum factor."""
        return self.scale[1]

    def driven(self, name: str) -> list[str]:
        """The paths of the scaled entries."""
        return self.entries or [name]

    def put(self, name: str, value: float, data: dict[str, Any]) -> None:
        """Scale the entries in the raw data of a case; raises InputError where there is nothing to scale."""
        for entry in self.driven(name):
            numbers = list(_numbers(value_at(data, entry), entry))
            if not numbers:
                raise InputError(f"the case has no {entry} to scale; give it there, or give a range", f"find.{name}")
            for path, number in numbers:
                put(data, path, value * number, f"find.{name}")

    def own(self, name: str, data: Any) -> float:
        """The factor 1, which leaves the case as it is."""
        del name, data
        return 1.0

    def named(self, name: str, data: Mapping[str, Any]) -> EntryName:
        """The unknown in words; a factor has no unit."""
        words = entry_name(self.driven(name)[0], data).words if self.entries is None else name.replace("_", " ")
        return EntryName(self.label or f"factor on {words}", "")


def _kind(value: Any) -> str:
    """The kind of an unknown, from the entry that only this kind has."""
    for name, tag in (("scale", "(scale)"), ("choices", "(choices)")):
        if (isinstance(value, dict) and name in value) or hasattr(value, name):
            return tag
    return "(range)"


def _pair(value: Any) -> Any:
    """`[9, 15]` as a group."""
    if isinstance(value, list | tuple) and len(value) == 2:
        return {"from": value[0], "to": value[1]}
    if isinstance(value, dict | Strict):
        return value
    raise ValueError("must be the minimum and the maximum value, as in [9, 15], or a group with choices or scale")


Unknown = Annotated[
    Annotated[Bounds, Tag("(range)")] | Annotated[Choices, Tag("(choices)")] | Annotated[Scale, Tag("(scale)")],
    Discriminator(_kind),
    BeforeValidator(_pair),
]


def refuse_twice(find: Mapping[str, "Bounds | Choices | Scale"]) -> None:
    """Refuse entries that two unknowns drive, whole or in part; raises ValueError."""
    seen: dict[str, str] = {}
    for name, unknown in find.items():
        for entry in unknown.driven(name):
            for other, owner in seen.items():
                if entry == other or entry.startswith(f"{other}.") or other.startswith(f"{entry}."):
                    raise ValueError(f"find.{name}: {entry} is driven by {owner} already; leave it out of one of them")
            seen[entry] = name


def _number(data: Any, entry: str) -> float:
    value = value_at(data, entry)
    return float(value) if isinstance(value, int | float) and not isinstance(value, bool) else float("nan")


def _numbers(value: Any, entry: str, whole: bool = True) -> Iterator[tuple[str, float]]:
    """Paths and values of the numbers of an entry; within a group only those with a unit, not turns."""
    if isinstance(value, dict):
        for name, inner in value.items():
            yield from _numbers(inner, f"{entry}.{name}", whole=False)
    elif isinstance(value, list):
        for number, inner in enumerate(value):
            yield from _numbers(inner, f"{entry}.{number}", whole)
    elif isinstance(value, int | float) and not isinstance(value, bool) and (whole or entry_name(entry).unit):
        yield entry, float(value)
