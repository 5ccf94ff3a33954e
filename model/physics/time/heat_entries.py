"""The `heat` section of a case: where the heat of plastic work goes."""

from typing import Annotated

from annotated_types import Unit
from pydantic import Field

from coilset.model.core.base.entry import Strict


class HeatSpec(Strict):
    """Conduction along the wire, to the air and into the seats. The material must have the entry `heating`."""

    conductivity: Annotated[float, Unit("W/(m K)"), Field(gt=0, description="thermal conductivity, W/(m K)")]
    convection: Annotated[
        float, Unit("W/(m² K)"), Field(ge=0, description="heat transfer coefficient from the wire to the air, W/(m² K)")
    ] = 0.0
    tips: Annotated[
        float, Unit("W/K"), Field(ge=0, description="thermal conductance from each tip of the wire into its seat, W/K")
    ] = 0.0
    surroundings: Annotated[
        float | None,
        Unit("K"),
        Field(gt=0, description="temperature of air and seats at the start, K; default: that of the spring"),
    ] = None
