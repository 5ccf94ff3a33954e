"""Hardening curves: stress over plastic strain, from a law or a table, converted to k² over plastic work.

In tension without back stress σ = √(3/2) k (3.1.4), and the plastic work is b* = ∫ σ dεᵖ (3.1.8). A curve σ(εᵖ) gives

    k²(b*) = ⅔ σ²,   dk²/db* = 4/3 dσ/dεᵖ,

at enough points to make the cubic interpolation with these slopes exact to 1e-5. Beyond its end the curve is constant.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Literal, Self

import numpy as np
from annotated_types import Unit
from pydantic import Field, ValidationInfo, field_validator, model_validator

from coilset.model.core.base.columns import read_columns
from coilset.model.core.base.entry import Strict
from coilset.model.core.base.errors import InputError

NODES = 65  # of a law's curve
FINE = 32  # intervals of the integral between two nodes
FIRST = 1e-4  # of the final strain, where the nodes of a law start to form a geometric progression
ELASTIC = 1e-5  # plastic strain up to which a point of a table counts as elastic
BETWEEN = 4  # nodes in each interval of a table

Strain = Annotated[float, Unit("1"), Field(gt=0)]
Pressure = Annotated[float, Unit("N/mm²"), Field(gt=0)]
StressAndSlope = tuple[np.ndarray, np.ndarray]
Sampled = tuple[np.ndarray, np.ndarray, np.ndarray]
"""b*, N/mm², k², N²/mm⁴, and dk²/db*, N/mm², at the nodes."""


class Curve(Strict):
    """Common entries of all curves."""

    up_to: Annotated[Strain, Field(description="plastic strain at which the curve ends; it is constant beyond")] = 0.3

    def stress(self, strain: np.ndarray) -> StressAndSlope:
        """True stress at plastic strains and dσ/dεᵖ, both N/mm²."""
        raise NotImplementedError

    def sampled(self, young_modulus: float, shear_modulus: float) -> Sampled:
        """The curve at its nodes."""
        graded = np.geomspace(FIRST, 1.0, NODES - 1)
        return sample(np.concatenate([[0.0], graded]) * self.up_to, self.stress)


class Swift(Curve):
    """Swift's law, σ = C (ε₀ + εᵖ)ⁿ."""

    law: Annotated[Literal["swift"], Field(description="the word that selects this law")]
    C: Annotated[Pressure, Field(description="the stress at ε₀ + εᵖ = 1, N/mm²")]
    strain_0: Annotated[Strain, Field(description="ε₀")]
    n: Annotated[float, Unit("1"), Field(gt=0, lt=1, description="the exponent")]

    def stress(self, strain: np.ndarray) -> StressAndSlope:
        """See `Curve`."""
        total = self.strain_0 + strain
        return self.C * total**self.n, self.n * self.C * total ** (self.n - 1.0)


class Voce(Curve):
    """Voce's law, σ = σ₀ + Q (1 − exp(−m εᵖ))."""

    law: Annotated[Literal["voce"], Field(description="the word that selects this law")]
    yield_stress: Annotated[Pressure, Field(description="σ₀, N/mm²")]
    rise: Annotated[Pressure, Field(description="Q, N/mm²")]
    rate: Annotated[float, Unit("1"), Field(gt=0, description="m")]

    def stress(self, strain: np.ndarray) -> StressAndSlope:
        """See `Curve`."""
        exponent = -self.rate * strain
        return self.yield_stress + self.rise * -np.expm1(exponent), self.rise * self.rate * np.exp(exponent)


class RambergOsgood(Curve):
    """Ramberg and Osgood's law, εᵖ = 0.002 (σ/Rp)ⁿ, from an elastic limit on.

    The law itself has plastic strain at any stress. Here plastic strain starts at the elastic limit; the law's value
    there, usually some hundredths of 0.2 %, is subtracted.
    """

    law: Annotated[Literal["ramberg-osgood"], Field(description="the word that selects this law")]
    proof_stress: Annotated[Pressure, Field(description="Rp0.2, N/mm²")]
    n: Annotated[float, Unit("1"), Field(gt=1, description="the exponent")]
    elastic_limit: Annotated[Pressure, Field(description="stress at which plastic strain begins, N/mm²")]

    @model_validator(mode="after")
    def _order(self) -> Self:
        if self.elastic_limit >= self.proof_stress:
            raise ValueError(
                f"the elastic limit of {self.elastic_limit:g} must be below the proof stress of "
                f"{self.proof_stress:g} N/mm²"
            )
        return self

    @property
    def _before(self) -> float:
        return 0.002 * (self.elastic_limit / self.proof_stress) ** self.n

    def stress(self, strain: np.ndarray) -> StressAndSlope:
        """See `Curve`."""
        total = strain + self._before
        stress = self.proof_stress * (total / 0.002) ** (1.0 / self.n)
        return stress, stress / (self.n * total)

    def sampled(self, young_modulus: float, shear_modulus: float) -> Sampled:
        """The curve at its nodes, in a geometric progression that starts at the subtracted strain."""
        total = np.geomspace(self._before, self.up_to + self._before, 2 * NODES)
        return sample(total - total[0], self.stress)


class Table(Strict):
    """Points from a test in tension or torsion, joined by monotone cubic interpolation (Fritsch and Carlson).

    Torsion is that of a thin tube, or of a bar with the shear stress evaluated at the surface.
    """

    law: Annotated[Literal["table"], Field(description="the word that selects this form")]
    file: Annotated[
        str | None,
        Field(description="CSV with the columns strain and stress, relative to this file's folder; or give both here"),
    ] = None
    strain: Annotated[
        list[Annotated[float, Unit("1")]] | None, Field(min_length=2, description="strains, γ in torsion; or give file")
    ] = None
    stress: Annotated[
        list[Annotated[float, Unit("N/mm²")]] | None, Field(min_length=2, description="stresses, N/mm²; or give file")
    ] = None
    test: Annotated[Literal["tension", "torsion"], Field(description="what the test was")] = "tension"
    strains: Annotated[
        Literal["total", "plastic"],
        Field(description="total or plastic strains; the elastic part of total strains is subtracted"),
    ] = "total"
    measure: Annotated[
        Literal["true", "engineering"],
        Field(description="of a tension test; engineering: relative to the initial length and area"),
    ] = "true"

    @field_validator("file")
    @classmethod
    def _from_folder(cls, file: str | None, info: ValidationInfo) -> str | None:
        """Counts from the folder of the material file, where the context has one."""
        folder = (info.context or {}).get("folder")
        return file if file is None or folder is None else str(Path(folder) / file)

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        given = self.strain is not None and self.stress is not None
        if (self.file is not None) == given or (self.strain is None) != (self.stress is None):
            raise ValueError("give either file, or strain and stress")
        if given and len(self.strain or ()) != len(self.stress or ()):
            raise ValueError(
                f"{len(self.strain or ())} strains and {len(self.stress or ())} stresses; give equally many"
            )
        if self.test == "torsion" and self.measure == "engineering":
            raise ValueError("measure applies to tension tests only; leave it out")
        return self

    def points(self) -> tuple[np.ndarray, np.ndarray]:
        """Strain and stress as given.

        Raises:
            InputError: a file that cannot be read or is wrong.
        """
        if self.file is None:
            return np.array(self.strain), np.array(self.stress)
        return read_table(self.file)

    def sampled(self, young_modulus: float, shear_modulus: float) -> Sampled:
        """The curve at its nodes: its points from the last elastic one on, and some between them.

        Raises:
            InputError: a file that is wrong, strains that do not ascend, or stress that falls.
        """
        from scipy.interpolate import PchipInterpolator  # as in `sample`

        strain, stress = self.points()
        if self.measure == "engineering":
            total = strain if self.strains == "total" else strain + stress / young_modulus
            strain, stress = np.log1p(total), stress * (1.0 + total)
        if self.strains == "total" or self.measure == "engineering":
            strain = strain - stress / (young_modulus if self.test == "tension" else shear_modulus)
        if self.test == "torsion":  # σ = √3 τ, εᵖ = γᵖ/√3
            strain, stress = strain / np.sqrt(3.0), stress * np.sqrt(3.0)
        start = max(int(np.sum(strain <= ELASTIC)) - 1, 0)
        strain, stress = np.maximum(strain[start:], 0.0), stress[start:]
        strain = np.where(strain <= ELASTIC, 0.0, strain)
        if problem := self._problem(strain, stress):
            raise InputError(problem, "", self.file or "")
        curve = PchipInterpolator(strain, stress)
        part = np.arange(BETWEEN) / BETWEEN
        nodes = np.append((strain[:-1, None] + np.diff(strain)[:, None] * part).ravel(), strain[-1])
        slope = curve.derivative()
        return sample(nodes, lambda strain: (curve(strain), slope(strain)))

    def _problem(self, strain: np.ndarray, stress: np.ndarray) -> str:
        """What is wrong with the points from the last elastic one on."""
        if len(strain) < 2 or (strain[0] > 0.0 and self.strains == "plastic"):
            return "a table needs a point at plastic strain 0, where yielding begins, and one beyond"
        if strain[0] > 0.0:
            first = f"the first point has a plastic strain of {strain[0]:.3g} already"
            return f"{first}: give one that is still elastic, or check the elastic constants and the units"
        not_ascending, falls = np.diff(strain) <= 0.0, np.diff(stress) < 0.0
        for what, values, wrong in (
            ("plastic strain does not ascend", strain, not_ascending),
            ("stress falls", stress, falls),
        ):
            if wrong.any():
                k = int(np.argmax(wrong))
                steps = f"from {values[k]:.6g} to {values[k + 1]:.6g}"
                return f"the {what} {steps} (point {k + 2} of those that are plastic)"
        if stress[0] <= 0.0:
            return f"the stress where yielding begins is {stress[0]:g} N/mm²; it must be above 0"
        return ""


AnyCurve = Swift | Voce | RambergOsgood | Table


def read_table(path: str | Path) -> tuple[np.ndarray, np.ndarray]:
    """Columns strain and stress of a CSV file; lines that begin with # are comments.

    Raises:
        InputError: if it cannot be read, or a column or a number is missing or wrong.
    """
    table = read_columns(path).named({"strain": "", "stress": ""})
    for name in ("strain", "stress"):
        if name not in table.names:
            raise table.lacks(name, "strain and stress (N/mm²)")
    return table.numbers("strain"), table.numbers("stress")


def sample(strain: np.ndarray, curve: Callable[[np.ndarray], StressAndSlope]) -> Sampled:
    """b*, k² and dk²/db* at plastic strains, the first of which is 0."""
    from scipy.integrate import cumulative_simpson  # takes a quarter of a second, so only where needed

    part = np.linspace(0.0, 1.0, FINE + 1)
    within = strain[:-1, None] + np.diff(strain)[:, None] * part
    work = cumulative_simpson(curve(within)[0], x=within, axis=1)[:, -1]
    stress, slope = curve(strain)
    return np.concatenate([[0.0], np.cumsum(work)]), stress**2 / 1.5, 4.0 / 3.0 * slope
