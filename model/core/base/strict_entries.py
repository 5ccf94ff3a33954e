"""Base of every group of entries of an input file: unknown names are rejected, numbers must be numbers."""

from collections.abc import Iterator
from difflib import get_close_matches
from functools import cache
from operator import index
from typing import Annotated, Any, ClassVar

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    PrivateAttr,
    ValidationError,
    model_validator,
)
from pydantic.fields import FieldInfo
from pydantic_core import PydanticCustomError


def _whole(value: Any) -> Any:
    """Convert a whole number given as 12.0 or as a numpy number to 12; anything else is left to be rejected."""
    if isinstance(value, bool | str):
        return value
    try:
        return int(value) if isinstance(value, float) and value.is_integer() else index(value)
    except TypeError:
        return value


Whole = Annotated[int, BeforeValidator(_whole)]
"""A whole number; 12.0 counts as one, since ranges of a sweep produce it."""

WORD_OR_NUMBER = Discriminator(lambda value: "(word)" if isinstance(value, str) else "(number)")
"""Distinguishes a number, tagged `(number)`, from one of several words, tagged `(word)`."""


class Strict(BaseModel):
    """A group of entries.

    Unknown entries are rejected, values are immutable, numbers are finite, and nothing is converted: neither a word
    nor a truth value is accepted as a number.

    Attributes:
        RENAMED: earlier names of entries and their current names; either is accepted, but not both together.
        ELSEWHERE: entries of other kinds of files, and who reads these.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, strict=True, defer_build=True)
    RENAMED: ClassVar[dict[str, str]] = {}
    ELSEWHERE: ClassVar[dict[str, str]] = {}
    _earlier: tuple[str, ...] = PrivateAttr(())

    @model_validator(mode="wrap")
    @classmethod
    def _entries(cls, data: Any, validate: Any) -> Any:
        if not isinstance(data, dict):
            return _reported(cls, data, validate)
        earlier = tuple(name for name in cls.RENAMED if name in data)
        for name in earlier:
            if cls.RENAMED[name] in data:
                raise ValueError(f"{name} is the earlier name of {cls.RENAMED[name]}; give one of the two")
        data = {cls.RENAMED.get(name, name): value for name, value in data.items()}
        _check_names(cls, data)
        group = validate(data)
        if earlier:
            group._earlier = earlier
        return group

    def notices(self) -> Iterator[str]:
        """Notices about the entries: one line, with its place, for each that was given by its earlier name."""
        for name in self._earlier:
            yield f"{name}: this entry is now called {self.RENAMED[name]}"
        for name, value in vars(self).items():
            if isinstance(value, Strict):
                yield from (f"{name}.{notice}" for notice in value.notices())


def _before_comma(name: object, data: dict) -> str:
    """The entry that was cut by a decimal comma: of `{nu: 0,26}` YAML makes the entries nu: 0 and 26; else empty."""
    names = list(data)
    where = names.index(name)
    is_rest = str(name).isdigit() and data[name] is None
    return str(names[where - 1]) if is_rest and where else ""


@cache
def _known(group: type[BaseModel]) -> dict[str, FieldInfo]:
    """The entries of a group by the names that a file has for them."""
    return {field.alias or name: field for name, field in group.model_fields.items()}


def _reported(group: type[BaseModel], data: Any, validate: Any) -> Any:
    """A group from a value that is no mapping, which some groups accept; otherwise an error names their entries."""
    try:
        return validate(data)
    except ValidationError as error:
        if error.errors(include_url=False)[0]["type"] != "model_type":
            raise
    problem = "must be a group of entries, as in {name: value}, of {names}"
    raise PydanticCustomError("no_group", problem, {"names": ", ".join(_known(group))})


def _check_names(group: type[Strict], data: dict) -> None:
    """Report the first unknown entry before the first missing one: a misspelt entry leaves another one missing."""
    known = _known(group)
    for name in data:
        if name not in known:
            left = [other for other in known if other not in data]
            near = get_close_matches(str(name), known, 1, 0.8) or [one for one in left if one.startswith(f"{name}_")]
            near = near or get_close_matches(str(name), left, 3)
            hint = f"is {' or '.join(near)} meant?" if near else f"the entries here are {', '.join(known)}"
            if name in group.ELSEWHERE:
                hint = f"a file with it is for {group.ELSEWHERE[str(name)]}"
            if before := _before_comma(name, data):
                hint = f"a comma begins the next entry: give {before} with a decimal point, as in 0.5"
            raise PydanticCustomError("unknown_entry", "unknown entry; {hint}", {"entry": str(name), "hint": hint})
    for name, field in known.items():
        if field.is_required() and name not in data:
            hint = f"; give {field.description}" if field.description else ""
            problem = "this entry is required{hint}"
            raise PydanticCustomError("missing_entry", problem, {"entry": name, "hint": hint})
