"""The entries of a material file on time: creep, and yield that depends on the strain rate."""

from typing import TYPE_CHECKING, Annotated, Literal

from annotated_types import Unit
from pydantic import Field

from coilset.model.core.base.entry import Strict
from coilset.model.physics.time.creep.forms import FORMS

if TYPE_CHECKING:
    Form = str
else:
    Form = Literal[tuple(FORMS)]
Ends = Annotated[tuple[float, float], Field(strict=False, description="the least and the greatest")]


class CreepTests(Strict):
    """What the constants of creep are known for: the range of the tests that they are from."""

    temperature: Annotated[Ends, Unit("K"), Field(description="least and greatest temperature, K")]
    stress: Annotated[Ends, Unit("N/mm²"), Field(description="least and greatest equivalent stress, N/mm²")]
    hours: Annotated[Ends, Unit("h"), Field(description="least and greatest time, h")]


class Creep(Strict):
    """Creep: c = strain · f(σ/stress)^exponent · (t/1 h)^time_exponent, equivalent values; f by the form."""

    form: Annotated[
        Form,
        Field(description="; ".join(f"{name}: {form.TEXT}" for name, form in FORMS.items())),
    ]
    strain: Annotated[
        float,
        Unit("1"),
        Field(gt=0, le=1, description="equivalent creep strain after 1 h when the stress factor is 1"),
    ]
    stress: Annotated[float, Unit("N/mm²"), Field(gt=0, description="the reference equivalent stress, N/mm²")]
    exponent: Annotated[float, Unit("1"), Field(ge=1, le=50, description="the exponent of stress, N")]
    time_exponent: Annotated[
        float, Unit("1"), Field(ge=0.05, le=1, description="the exponent of time, p; 1: steady creep")
    ] = 1.0
    hardening: Annotated[
        Literal["strain", "time"],
        Field(description="what the rate depends on when the stress changes: creep strain, or time since the start"),
    ] = "strain"
    activation_energy: Annotated[
        float, Unit("J/mol"), Field(ge=0, description="activation energy, which scales time with temperature, J/mol")
    ] = 0.0
    temperature: Annotated[float, Unit("K"), Field(gt=0, description="the temperature of these constants, K")] = 293.15
    tests: Annotated[
        CreepTests | None,
        Field(description="range of the tests that the constants are from; a run that goes beyond it warns"),
    ] = None


class RateDependence(Strict):
    """Yield that rises with the plastic strain rate (Perzyna): ṗ = reference_rate · (σ/σ_yield − 1)^exponent."""

    reference_rate: Annotated[
        float, Unit("1/s"), Field(gt=0, description="plastic strain rate at twice the static yield stress, 1/s")
    ]
    exponent: Annotated[
        float, Unit("1"), Field(ge=1, le=50, description="the exponent of the stress beyond yield over it, m")
    ]
