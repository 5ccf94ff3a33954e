"""The `limits` section of a case: between which values results must be."""

import re
from typing import Annotated, Any, ClassVar, Literal

from annotated_types import Unit
from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Tag

from coilset.model.core.base.entry import Strict

GRADE = re.compile(r"EN 15800 grade ([123])")


def _grade(text: str) -> str:
    """EN 15800 with one of its grades."""
    if not GRADE.fullmatch(text):
        raise ValueError("must be two numbers, as in [240, 260], or EN 15800 grade 1, 2 or 3")
    return text


def _two(values: list[float]) -> list[float]:
    """The lower one first."""
    if values[0] >= values[1]:
        raise ValueError(f"{values[0]:g} to {values[1]:g} is no range; the first must be the smaller one")
    return values


class About(Strict):
    """A tolerance about a nominal value, which is that of the finished spring."""

    ELSEWHERE: ClassVar = dict.fromkeys(("at_least", "at_most"), "coilset design; here give [low, high]")
    nominal: Annotated[float, Unit("of the result"), Field(description="middle of the tolerance")]
    tolerance: Annotated[
        Annotated[str, AfterValidator(_grade), Tag("(grade)")]
        | Annotated[float, Unit("of the result"), Field(gt=0), Tag("(number)")],
        Discriminator(lambda value: "(grade)" if isinstance(value, str) else "(number)"),
        Field(description="± of the nominal, or EN 15800 grade 2"),
    ]


def _kind(value: Any) -> Literal["(grade)", "(about)", "(range)"]:
    if isinstance(value, str):
        return "(grade)"
    return "(about)" if isinstance(value, dict | About) else "(range)"


AnyLimit = Annotated[
    Annotated[str, AfterValidator(_grade), Tag("(grade)")]
    | Annotated[About, Tag("(about)")]
    | Annotated[
        list[float],
        Unit("of the result"),
        BeforeValidator(lambda value: list(value) if isinstance(value, tuple) else value),
        Field(min_length=2, max_length=2),
        AfterValidator(_two),
        Tag("(range)"),
    ],
    Discriminator(_kind),
]
"""A range, a tolerance about a nominal value, or a grade of EN 15800 about the formula's value."""

Limits = dict[Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_.]*$")], AnyLimit]
"""Names of results, each with its limits."""
