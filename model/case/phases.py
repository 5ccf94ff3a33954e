"""The `loading` section of a case: a list of targets, each reached in a number of steps."""

from typing import Annotated, Any, Literal, Self

from annotated_types import Unit
from pydantic import AfterValidator, Discriminator, Field, Tag, model_validator

from coilset.model.entries.entry import Strict, Whole


class Target(Strict):
    """One of travel, height or force; compression is positive."""

    travel: Annotated[float | None, Unit("mm"), Field(description="shortening of the spring since the start, mm")] = (
        None
    )
    height: Annotated[float | None, Unit("mm"), Field(gt=0, description="distance of the seats, mm")] = None
    force: Annotated[float | None, Unit("N"), Field(description="axial force, compression positive, N")] = None

    @model_validator(mode="after")
    def _one(self) -> Self:
        if sum(value is not None for value in (self.travel, self.height, self.force)) != 1:
            raise ValueError("give exactly one of travel (mm), height (mm) or force (N), as in {force: 0}")
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


class Phase(Strict):
    """Go to a target in steps."""

    to: Annotated[
        Annotated[Literal["block"], Tag("(block)")] | Annotated[Target, Tag("(target)")],
        Discriminator(_kind),
        Field(description="block, {travel: mm}, {height: mm} or {force: N}"),
    ]
    steps: Annotated[
        Annotated[Whole, Field(gt=0, le=100_000), Tag("(number)")]
        | Annotated[Literal["auto"], Tag("(word)")]
        | Annotated[Marks, Tag("(list)")],
        Discriminator(_form),
        Field(description="auto: as long as the accuracy and the iteration allow; or a number of equal load steps; or "
                          "the parts of the phase at which they end"),
    ] = "auto"  # fmt: skip

    def count(self, automatic: int) -> int:
        """Number of its steps; that of an automatic phase as it is planned, `automatic`."""
        if isinstance(self.steps, str):
            return automatic
        return len(self.steps) if isinstance(self.steps, list) else self.steps

    @property
    def label(self) -> str:
        """The target in words, for progress and logs."""
        if self.to == "block":
            return "block"
        name, value = next((name, value) for name, value in self.to.model_dump().items() if value is not None)
        return f"{name} {value:g} {'N' if name == 'force' else 'mm'}"
