"""The material file: its schema, and its reader.

A material file gives, for one or more temperatures, the elastic constants and the constants of k², ζ and κ (6.2.2).
"""

import math
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any, Literal

from annotated_types import Unit
from pydantic import Discriminator, Field, Tag

from coilset.model.core.base.entry import Strict, check_entries
from coilset.model.core.base.package import Entry
from coilset.model.core.base.yaml import LONGEST_FILE, read_data
from coilset.model.core.material.law.hardening_curves import RambergOsgood, Swift, Table, Voce

Text = Annotated[str, Field(min_length=1)]
NONE = "its constants, or 'none' if the material lacks this function"


class Elasticity(Strict):
    """Elastic constants (3.1.2)."""

    G: Annotated[float, Unit("N/mm²"), Field(gt=0, description="the shear modulus, N/mm²")]
    nu: Annotated[float, Unit("1"), Field(gt=-1, lt=0.5, description="Poisson's ratio")]
    alpha: Annotated[float, Unit("1/K"), Field(ge=0, description="the coefficient of thermal expansion, 1/K")] = 0.0


class Saturation(Strict):
    """Second branch of k², for b* ≥ b1: k∞² is approached exponentially."""

    b1: Annotated[float, Unit("N/mm²"), Field(ge=0, description="the plastic work at which it begins, N/mm²")]
    k1_squared: Annotated[float, Unit("N²/mm⁴"), Field(gt=0, description="k² at b1, N²/mm⁴")]
    k_inf_squared: Annotated[float, Unit("N²/mm⁴"), Field(gt=0, description="k² at large plastic work, N²/mm⁴")]
    a4: Annotated[float, Unit("mm²/N"), Field(ge=0, description="the rate at which it approaches k∞², mm²/N")]


class IsotropicHardening(Strict):
    """k²(b*): k0² + a1 (1 + a2 b* − exp(−a3 b*)) and, if there is one, the second branch."""

    k0_squared: Annotated[float, Unit("N²/mm⁴"), Field(gt=0, description="k² at first yield, N²/mm⁴")]
    a1: Annotated[float, Unit("N²/mm⁴"), Field(ge=0, description="the rise of the exponential part, N²/mm⁴")] = 0.0
    a2: Annotated[float, Unit("mm²/N"), Field(description="the slope of the linear part, divided by a1, mm²/N")] = 0.0
    a3: Annotated[float, Unit("mm²/N"), Field(ge=0, description="the rate of decay of the exponential part, mm²/N")] = (
        0.0
    )
    saturation: Saturation | None = None

    def first_branch(self, b: float) -> float:
        """k² of the first branch at plastic work `b`, N²/mm⁴."""
        return self.k0_squared + self.a1 * (1 + self.a2 * b - math.exp(-self.a3 * b))


class KinematicHardening(Strict):
    """ζ(b*) = a5 (a6 + a7 exp(−a7 b*)) sqrt(6 k²)."""

    a5: Annotated[float, Unit("N/mm²"), Field(ge=0, description="the factor of ζ, N/mm²")]
    a6: Annotated[float, Unit("mm²/N"), Field(ge=0, description="the level to which ζ decays, mm²/N")]
    a7: Annotated[float, Unit("mm²/N"), Field(ge=0, description="the height and the rate of the decaying part, mm²/N")]


class BackStress(Strict):
    """One back stress: in tension it starts as C εᵖ and tends to C/γ."""

    C: Annotated[float, Unit("N/mm²"), Field(gt=0, description="its initial slope over the plastic strain, N/mm²")]
    gamma: Annotated[
        float, Unit("1"), Field(ge=0, description="how fast it saturates over the plastic strain; 0: it never does")
    ]


class Chaboche(Strict):
    """Several back stresses, each with Ḃ = ⅔ C D_pl − γ B ṗ (Chaboche)."""

    law: Literal["chaboche"]
    terms: Annotated[
        tuple[BackStress, ...],
        Field(strict=False, min_length=1, max_length=8, description="a list of back stresses, each with C and gamma"),
    ]


class NonNormality(Strict):
    """2Gκ(b*) = a b*³."""

    a: Annotated[float, Unit("mm⁶/N³"), Field(ge=0, description="the factor of b*³, mm⁶/N³")]


def _kind(value: Any) -> str:
    """Constants of a function, or the word `none`."""
    return "(none)" if isinstance(value, str) else "(constants)"


def _hardening(value: Any) -> str:
    """The law of a curve, constants of k², or the word `none`."""
    law = value.get("law") if isinstance(value, dict) else getattr(value, "law", None)
    return _kind(value) if law is None else f"({law})"


Word = Annotated[Literal["none"], Tag("(none)")]


class Constants(Strict):
    """All constants at one temperature; `none` stands for a function that the material does not have."""

    temperature: Annotated[float, Unit("K"), Field(gt=0, description="the temperature of the constants, K")]
    elasticity: Annotated[Elasticity, Field(description="G and nu")]
    isotropic: Annotated[
        Annotated[IsotropicHardening, Tag("(constants)")]
        | Annotated[Swift, Tag("(swift)")]
        | Annotated[Voce, Tag("(voce)")]
        | Annotated[RambergOsgood, Tag("(ramberg-osgood)")]
        | Annotated[Table, Tag("(table)")]
        | Word,
        Discriminator(
            _hardening,
            custom_error_type="law",
            custom_error_message="law must be swift, voce, ramberg-osgood or table; without it k² has constants",
        ),
        Field(description=f"{NONE}; or a curve of stress over plastic strain"),
    ]
    kinematic: Annotated[
        Annotated[KinematicHardening, Tag("(constants)")] | Annotated[Chaboche, Tag("(chaboche)")] | Word,
        Discriminator(
            _hardening,
            custom_error_type="law",
            custom_error_message="law must be chaboche; without it ζ has constants",
        ),
        Field(description=f"{NONE}; or several back stresses"),
    ]
    non_normality: Annotated[
        Annotated[NonNormality, Tag("(constants)")] | Word, Discriminator(_kind), Field(description=NONE)
    ]

    @property
    def terms(self) -> tuple[BackStress, ...]:
        """The back stresses that saturate (Chaboche); empty where there is the one of ζ, or none."""
        return self.kinematic.terms if isinstance(self.kinematic, Chaboche) else ()


class Heating(Strict):
    """Adiabatic heating: the fraction `dissipated` of the plastic work b* heats the material."""

    dissipated: Annotated[
        float, Unit("1"), Field(gt=0, le=1, description="the fraction of plastic work that becomes heat")
    ]
    density: Annotated[float, Unit("t/mm³"), Field(gt=0, description="the density, t/mm³")]
    specific_heat: Annotated[
        float, Unit("mm²/(s² K)"), Field(gt=0, description="the specific heat, N mm/(t K) = mm²/(s² K)")
    ]


class Validity(Strict):
    """Range in which the constants are valid; the functions are checked up to its maximum plastic work."""

    plastic_work: Annotated[
        float, Unit("N/mm²"), Field(gt=0, description="the largest b* for which the constants are valid, N/mm²")
    ]
    remark: Annotated[Text, Field(description="what else limits the validity of the constants")]
    temperature: Annotated[
        float | None,
        Unit("K"),
        Field(gt=0, description="the one at which yield and hardening were tested, if at others only moduli are known"),
    ] = None
    undetermined: Annotated[
        tuple[str, ...],
        Field(strict=False, description="a list of the constants that the tests do not determine; a run warns of them"),
    ] = ()


class MaterialFile(Strict):
    """A material file."""

    name: Annotated[Text, Field(description="a name for the material")]
    description: Annotated[Text, Field(description="a sentence that says what it is")]
    source: Annotated[Text, Field(description="where the constants come from")]
    units: Annotated[Literal["N, mm, K"], Field(description="'N, mm, K', the units of all numbers in the file")]
    validity: Annotated[Validity, Field(description="plastic_work, the largest b* in N/mm², and a remark")]
    temperatures: Annotated[
        tuple[Constants, ...],
        Field(strict=False, min_length=1, description="a list with the constants at one or more temperatures"),
    ]
    tensile_strength: Annotated[
        float | None,
        Unit("MPa"),
        Field(gt=0, description="tensile strength Rm of the wire, for the sheet and its checks, MPa"),
    ] = None
    heating: Heating | None = None
    creep: Annotated[
        Any,
        Entry("coilset.model.physics.time.creep.entries:Creep"),
        Field(description="constants of creep; left out: the material does not creep"),
    ] = None
    rate: Annotated[
        Any,
        Entry("coilset.model.physics.time.creep.entries:RateDependence"),
        Field(description="yield that rises with the strain rate; left out: it does not"),
    ] = None

    @property
    def deviates_from_normality(self) -> bool:
        """Whether κ is not zero."""
        return any(at.non_normality != "none" for at in self.temperatures)


KINDS = (Elasticity, IsotropicHardening, Saturation, KinematicHardening, BackStress, NonNormality)
CURVES = (Swift, Voce, RambergOsgood, Table)
# Of all constants, by their names.
UNITS = {
    name: "" if one.unit == "1" else str(one.unit)
    for kind in KINDS + CURVES
    for name, field in kind.model_fields.items()
    for one in field.metadata
    if isinstance(one, Unit)
}


def read(path: str | Path) -> MaterialFile:
    """Read a material file.

    Raises:
        InputError: if the file cannot be read or says something wrong.
    """
    try:
        with open(path, "rb") as file:
            content = file.read(LONGEST_FILE + 1)
    except OSError:
        content = b""  # reported below
    return _read(str(path), content)


@lru_cache(maxsize=16)  # cases of a sweep share materials
def _read(path: str, content: bytes) -> MaterialFile:
    """The checked content of a file."""
    kind = "is not a material file; it needs name, source, units, validity, ..."
    return check_entries(read_data(path, kind), MaterialFile, path)
