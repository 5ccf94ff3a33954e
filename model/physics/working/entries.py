"""The `working` section of a case: the lengths or forces between which the finished spring works."""

from typing import Annotated, Self

from annotated_types import Unit
from pydantic import Field, model_validator

from coilset.model.core.base.entry import Strict
from coilset.model.core.case.phases import Target

MOST = 20  # states


class WorkingSpec(Strict):
    """States of the finished spring at which its force, rate and stresses are reported, after the load program."""

    lengths: Annotated[
        list[Annotated[float, Unit("mm"), Field(gt=0)]],
        Field(max_length=MOST, description="distances between the seats, mm, as in [47, 37]"),
    ] = Field(default_factory=list)
    forces: Annotated[
        list[Annotated[float, Unit("N")]],
        Field(max_length=MOST, description="axial forces, compression positive, N, at which the length is wanted"),
    ] = Field(default_factory=list)

    @model_validator(mode="after")
    def _some_and_apart(self) -> Self:
        if not self.lengths and not self.forces:
            raise ValueError("is empty; give lengths, as in {lengths: [47, 37]}, or forces")
        for name, values in (("lengths", self.lengths), ("forces", self.forces)):
            words = [f"{value:g}" for value in values]
            if len(set(words)) < len(words):
                raise ValueError(f"{name}: two of them are {max(words, key=words.count)}; give each once")
        return self

    @property
    def targets(self) -> list[tuple[str, Target]]:
        """The place of each state in the file, and where it is; lengths first."""
        lengths = [(f"working.lengths.{k}", Target(height=value)) for k, value in enumerate(self.lengths)]
        return lengths + [(f"working.forces.{k}", Target(force=value)) for k, value in enumerate(self.forces)]
