"""The `loading` section of a case: a list of targets, each reached in a number of steps."""

from typing import Annotated, Any, Literal, Self

from annotated_types import Unit
from pydantic import Discriminator, Field, Tag, model_validator

from coilset.model.entries.entry import WORD_OR_NUMBER, Strict, Whole


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


class Phase(Strict):
    """Go to a target in steps."""

    to: Annotated[
        Annotated[Literal["block"], Tag("(block)")] | Annotated[Target, Tag("(target)")],
        Discriminator(_kind),
        Field(description="block, {travel: mm}, {height: mm} or {force: N}"),
    ]
    steps: Annotated[
        Annotated[Whole, Field(gt=0, le=100_000), Tag("(number)")] | Annotated[Literal["auto"], Tag("(word)")],
        WORD_OR_NUMBER,
        Field(description="auto: as long as the accuracy and the iteration allow; or a number of equal load steps"),
    ] = "auto"

    @property
    def label(self) -> str:
        """The target in words, for progress and logs."""
        if self.to == "block":
            return "block"
        name, value = next((name, value) for name, value in self.to.model_dump().items() if value is not None)
        return f"{name} {value:g} {'N' if name == 'force' else 'mm'}"
