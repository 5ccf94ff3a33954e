"""Schema of the wire files: numbers as functions of the wire diameter, each with its sources and certainty."""

import math
from bisect import bisect_left
from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from coilset.model.core.base.strict_entries import Strict

Sure = Literal["checked against a second source", "one source", "estimate"]
Text = Annotated[str, Field(min_length=1)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Numbers = Annotated[tuple[Positive, ...], Field(strict=False, min_length=1)]
Pair = Annotated[tuple[Positive, Positive], Field(strict=False)]


class Sourced(Strict):
    """What every number states about itself: keys of the file's sources, and how certain it is."""

    sources: Annotated[tuple[Text, ...], Field(strict=False)]
    sure: Sure
    remark: Text = ""

    @model_validator(mode="after")
    def _has_sources(self) -> Self:
        needed = {"checked against a second source": 2, "one source": 1, "estimate": 0}[self.sure]
        if len(self.sources) < needed:
            raise ValueError(f"'{self.sure}' needs {needed} source(s), {len(self.sources)} given")
        return self


class Number(Sourced):
    """A number for all diameters (`value`), or one for each range of diameters, mm."""

    value: Positive | None = None
    up_to: Numbers | None = None
    values: Numbers | None = None

    @model_validator(mode="after")
    def _one_of_both(self) -> Self:
        table = self.up_to is not None and self.values is not None
        if (self.value is None) != table or (self.up_to is None) != (self.values is None):
            raise ValueError("give value, or up_to and values")
        _fit_together(self.up_to, self.values)
        return self

    @property
    def numbers(self) -> tuple[float, ...]:
        """Those of all ranges."""
        return self.values or (self.value or 0.0,)  # never 0: one of the two is given

    def at(self, diameter: float) -> float:
        """The number at a diameter, mm; the last range extends without limit."""
        if self.up_to is None or self.values is None:
            return self.numbers[0]
        return self.values[min(bisect_left(self.up_to, diameter), len(self.values) - 1)]


class Allowable(Number):
    """A share of Rm that a shear stress may reach at block, and which stress that is.

    EN 13906-1 limits the uncorrected stress 8 D F/(π d³), American handbooks that with the correction k.
    """

    of: Literal["uncorrected stress", "corrected stress"]


class Tolerance(Sourced):
    """Tolerance of the wire's diameter, mm, by ranges of diameters."""

    up_to: Numbers
    plus_minus: Numbers

    @model_validator(mode="after")
    def _fits(self) -> Self:
        _fit_together(self.up_to, self.plus_minus)
        return self

    def at(self, diameter: float) -> float | None:
        """Tolerance at a diameter, mm; None above the last range."""
        i = bisect_left(self.up_to, diameter)
        return self.plus_minus[i] if i < len(self.plus_minus) else None


class _Piece(Strict):
    diameters: Pair

    @model_validator(mode="after")
    def _has_a_range(self) -> Self:
        _ascend(self.diameters)
        return self

    def covers(self, diameter: float) -> bool:
        """Whether the diameter is in the range of this piece, including both ends."""
        return self.diameters[0] <= diameter <= self.diameters[1]


class Logarithm(_Piece):
    """Rm = a − b lg(d / 1 mm)."""

    form: Literal["logarithm"]
    at_1_mm: Positive  # a, N/mm²
    per_decade: Positive  # b, N/mm²

    def at(self, diameter: float) -> float:
        """Strength, N/mm²."""
        return self.at_1_mm - self.per_decade * math.log10(diameter)


class Power(_Piece):
    """Rm = A / (d / 1 mm)^m."""

    form: Literal["power"]
    at_1_mm: Positive  # A, N/mm²
    exponent: Positive  # m

    def at(self, diameter: float) -> float:
        """Strength, N/mm²."""
        return self.at_1_mm / diameter**self.exponent


class Table(_Piece):
    """Values at given diameters, linear over lg d in between."""

    form: Literal["table"]
    at_: Annotated[Numbers, Field(alias="at")]
    values: Numbers

    @model_validator(mode="after")
    def _fits(self) -> Self:
        _fit_together(self.at_, self.values)
        return self

    def at(self, diameter: float) -> float:
        """Strength, N/mm²."""
        return float(np.interp(math.log10(diameter), np.log10(self.at_), self.values))


class Steps(_Piece):
    """One value for each range of diameters, including its upper end."""

    form: Literal["steps"]
    up_to: Numbers
    values: Numbers

    @model_validator(mode="after")
    def _fits(self) -> Self:
        _fit_together(self.up_to, self.values)
        if self.up_to[-1] != self.diameters[1]:
            raise ValueError("the last of up_to must be the last of diameters")
        return self

    def at(self, diameter: float) -> float:
        """Strength, N/mm²."""
        return self.values[bisect_left(self.up_to, diameter)]


class Strength(Sourced):
    """Minimum tensile strength Rm over the diameter, in pieces."""

    pieces: Annotated[
        tuple[Annotated[Logarithm | Power | Table | Steps, Field(discriminator="form")], ...],
        Field(strict=False, min_length=1),
    ]
    greatest: Positive | None = None  # N/mm²

    def at(self, diameter: float) -> float | None:
        """Rm at a diameter in mm, N/mm²; None if no piece covers it."""
        for piece in self.pieces:
            if piece.covers(diameter):
                return min(piece.at(diameter), self.greatest or math.inf)
        return None


Surface = Literal["as coiled", "shot peened"]
Springs = Literal["preset", "not preset", "not stated"]
TESTED: dict[Springs, str] = {
    "preset": "preset springs",
    "not preset": "springs not preset",
    "not stated": "presetting not stated",
}


class Endurance(Sourced):
    """Line of the Goodman diagram of corrected stresses: values a, b of a − b lg(d / 1 mm), N/mm².

    A straight line from the upper stress `at_zero` at lower stress 0 to `limit` at `knee`, `limit` from there on.
    """

    surface: Surface
    springs: Springs = "not stated"  # tested; what presetting gains is in a line of preset ones
    cycles: Positive
    at_zero: Pair
    knee: Pair
    limit: Pair


class WireEntry(Strict):
    """One wire; moduli and strengths in N/mm², density in kg/mm³, decrease of G in 1/K, the others shares of Rm."""

    grade: Text
    young_modulus: Number
    shear_modulus: Number
    density: Number
    shear_modulus_decrease: Number | None = None
    highest_temperature: Number | None = None  # K, of use
    strength: Strength
    block_stress: Allowable
    elastic_limit: Number
    proof_stress: Number
    diameter_tolerance: Tolerance | None = None
    endurance: Annotated[tuple[Endurance, ...], Field(strict=False)] = ()

    @model_validator(mode="after")
    def _is_possible(self) -> Self:
        """Shares of Rm in their order, moduli in the same unit: what an entry in % or in GPa is not."""
        for name in ("block_stress", "elastic_limit", "proof_stress"):
            greatest = max(getattr(self, name).numbers)
            if greatest >= 1.0:
                raise ValueError(f"{name} is a part of Rm, 0.85 for 85 %, not {greatest:g}")
        for diameter in (*(self.elastic_limit.up_to or ()), *(self.proof_stress.up_to or (math.inf,))):
            if self.elastic_limit.at(diameter) >= self.proof_stress.at(diameter):
                raise ValueError("elastic_limit must be below proof_stress")
        for diameter in (*(self.young_modulus.up_to or ()), *(self.shear_modulus.up_to or (math.inf,))):
            young, shear = self.young_modulus.at(diameter), self.shear_modulus.at(diameter)
            if not (2.0 < young / shear < 3.0 and young > 1000.0):
                raise ValueError(f"E must be 2 to 3 times G, both in N/mm², not {young:g} and {shear:g}")
        if max(self.density.numbers) > 1e-4:
            raise ValueError(f"density is in kg/mm³, 7.85e-6 for steel, not {max(self.density.numbers):g}")
        return self

    def sourced(self) -> list[tuple[str, Sourced]]:
        """All sourced entries by name."""
        found = [(name, value) for name, value in self if isinstance(value, Sourced)]
        return found + [(f"endurance, {line.surface}", line) for line in self.endurance]


class WireFile(Strict):
    """A whole file: the sources, the wires with their common entries, and what could not be found."""

    standard: Text
    title: Text
    sources: dict[str, Text]
    wires: Annotated[tuple[WireEntry, ...], Field(strict=False, min_length=1)]
    missing: Annotated[tuple[Text, ...], Field(strict=False)] = ()

    @model_validator(mode="after")
    def _known_sources(self) -> Self:
        for wire in self.wires:
            for name, entry in wire.sourced():
                for key in entry.sources:
                    if key not in self.sources:
                        raise ValueError(f"{wire.grade}, {name}: the source '{key}' is not among the file's sources")
        return self


def with_common(data: dict[str, Any]) -> dict[str, Any]:
    """Raw data of a file, with the `common` entries inserted into each wire that does not give its own."""
    common = data.get("common") or {}
    wires = [common | wire if isinstance(wire, dict) else wire for wire in data.get("wires") or []]
    return {name: value for name, value in data.items() if name != "common"} | {"wires": wires}


def _fit_together(diameters: Sequence[float] | None, values: Sequence[object] | None) -> None:
    if diameters is None or values is None:
        return
    if len(diameters) != len(values):
        raise ValueError(f"{len(diameters)} diameters but {len(values)} values")
    _ascend(diameters)


def _ascend(diameters: Sequence[float]) -> None:
    if any(a >= b for a, b in pairwise(diameters)):
        raise ValueError(f"the diameters must ascend, not {', '.join(f'{one:g}' for one in diameters)}")
