"""The `endurance` section of a case: fatigue strength of the wire's surface, with its source."""

from typing import Annotated, Self

from annotated_types import Unit
from pydantic import Field, model_validator

from coilset.model.core.base.entry import Strict
from coilset.model.physics.fatigue.strength import Strength, dang_van_a, findley_k


class EnduranceSpec(Strict):
    """Amplitudes that the wire endures under fully reversed stress, and how mean stress counts.

    A criterion is evaluated if its constants are given, or follow from the limits of torsion and bending.
    """

    torsion: Annotated[
        float, Unit("MPa"), Field(gt=0, description="amplitude endured in fully reversed torsion (R = −1), τ_W, MPa")
    ]
    bending: Annotated[
        float | None,
        Unit("MPa"),
        Field(gt=0, description="amplitude endured in fully reversed bending, σ_W, MPa; with it Smith-Watson-Topper"),
    ] = None
    mean_stress_sensitivity: Annotated[
        float | None, Unit("1"), Field(ge=0, lt=1, description="M of the Haigh diagram, for shear stress")
    ] = None
    findley_k: Annotated[
        float | None, Unit("1"), Field(ge=0, description="k of Findley; default: from torsion and bending")
    ] = None
    dang_van_a: Annotated[
        float | None, Unit("1"), Field(ge=0, description="a of Dang Van; default: from torsion and bending")
    ] = None
    fatemi_socie_k: Annotated[
        float | None, Unit("1"), Field(ge=0, description="k of Fatemi and Socie; needs yield_stress")
    ] = None
    yield_stress: Annotated[
        float | None, Unit("MPa"), Field(gt=0, description="yield stress of the wire in tension, for fatemi_socie_k")
    ] = None
    cycles: Annotated[float, Unit("1"), Field(gt=0, description="number of cycles that the amplitudes are for")] = 1e7
    slope: Annotated[
        float | None,
        Unit("1"),
        Field(gt=1, description="k of the Wöhler line N ∝ S^(−k) below this number; left out: no lives"),
    ] = None
    scatter: Annotated[
        float | None, Unit("1"), Field(ge=1, description="life that 90 % do not reach over that 10 % do not reach")
    ] = None
    source: Annotated[str, Field(min_length=3, description="where these numbers are from, in words")]

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if (self.fatemi_socie_k is None) != (self.yield_stress is None):
            raise ValueError("fatemi_socie_k and yield_stress belong together; give both or none")
        if self.scatter is not None and self.slope is None:
            raise ValueError("scatter is that of lives; give the slope too")
        if self.bending is not None and self.findley_k is None:
            findley_k(self.torsion, self.bending)
        if self.mean_stress_sensitivity is None and self.bending is None and self.findley_k is None:
            raise ValueError("no criterion has its constants; give mean_stress_sensitivity, bending or findley_k")
        return self

    def strength(self, poisson: float) -> Strength:
        """The constants of all criteria; `poisson` of the wire."""
        torsion, bending = self.torsion, self.bending
        k, a = self.findley_k, self.dang_van_a
        if bending is not None:
            k = findley_k(torsion, bending) if k is None else k
            a = dang_van_a(torsion, bending) if a is None else a
        return Strength(
            torsion=torsion,
            bending=bending,
            sensitivity=self.mean_stress_sensitivity,
            findley=k,
            dang_van=a,
            fatemi_socie=self.fatemi_socie_k,
            yield_stress=self.yield_stress,
            poisson=poisson,
            cycles=self.cycles,
            slope=self.slope,
            scatter=self.scatter,
            source=self.source,
        )
