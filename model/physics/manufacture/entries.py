"""Manufacture of a drawn spring (coiling, stress relief, peening): entries of the `spring:` section."""

from itertools import pairwise
from typing import Annotated, Self

from annotated_types import Unit
from pydantic import Field, model_validator

from coilset.model.core.base.strict_entries import Strict


class Relief(Strict):
    """Stress relief of the coiled wire, free of load; the material must creep."""

    temperature: Annotated[float, Unit("K"), Field(gt=0, description="temperature of the relief, K")]
    minutes: Annotated[float, Unit("min"), Field(gt=0, le=1e6, description="how long it lasts, min")]


Values = Annotated[list[float], Field(strict=False, min_length=2, max_length=1000)]


class Peening(Strict):
    """Shot peening as a profile over the depth below the wire's surface, linear between its points; the last one 0."""

    depth: Annotated[Values, Unit("mm"), Field(description="depths below the surface, mm, ascending from 0")]
    strain: Annotated[
        Values | None,
        Unit("1"),
        Field(description="eigenstrain along the wire there, by which the layer would be longer without the core"),
    ] = None
    stress: Annotated[
        Values | None,
        Unit("N/mm²"),
        Field(
            description="or the stress along the wire that the layer would have on a rigid core, N/mm²; compression "
            "is negative"
        ),
    ] = None

    @model_validator(mode="after")
    def _is_a_profile(self) -> Self:
        given = [values for values in (self.strain, self.stress) if values is not None]
        if len(given) != 1:
            raise ValueError("give exactly one of strain or stress, as in {depth: [0, 0.2], stress: [-500, 0]}")
        if self.depth[0] != 0.0 or any(b <= a for a, b in pairwise(self.depth)):
            raise ValueError("depth must ascend from 0, as in [0, 0.1, 0.25]")
        if len(given[0]) != len(self.depth):
            raise ValueError(f"there are {len(self.depth)} depths, but {len(given[0])} values; give one for each")
        if given[0][-1] != 0.0:
            raise ValueError("the last value must be 0: the layer ends there")
        return self
