"""The material file: its schema, and how it is read.

A material file gives, for one or more temperatures, the elastic constants and the constants of k², ζ and κ (6.2.2).
"""

import math
from difflib import get_close_matches
from pathlib import Path
from typing import Annotated, Literal, get_args

import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from coilset.model.errors import InputError

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Finite = Annotated[float, Field(allow_inf_nan=False)]

Text = Annotated[str, Field(min_length=1)]


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Elasticity(_Section):
    """Elastic constants (3.1.2)."""

    G: Positive  # N/mm²
    nu: Annotated[float, Field(gt=-1, lt=0.5)]
    alpha: NotNegative = 0.0  # 1/K


class Saturation(_Section):
    """Second branch of k², b* ≥ b1."""

    b1: NotNegative  # N/mm²
    k1_squared: Positive  # N²/mm⁴
    k_inf_squared: Positive  # N²/mm⁴
    a4: NotNegative  # mm²/N


class IsotropicHardening(_Section):
    """k²(b*): k0² + a1 (1 + a2 b* − exp(−a3 b*)) and, if there is one, the second branch."""

    k0_squared: Positive  # N²/mm⁴
    a1: NotNegative = 0.0  # N²/mm⁴
    a2: Finite = 0.0  # mm²/N
    a3: NotNegative = 0.0  # mm²/N
    saturation: Saturation | None = None

    def first_branch(self, b):
        """k² of the first branch at plastic work `b`."""
        return self.k0_squared + self.a1 * (1 + self.a2 * b - math.exp(-self.a3 * b))


class KinematicHardening(_Section):
    """ζ(b*) = a5 (a6 + a7 exp(−a7 b*)) sqrt(6 k²)."""

    a5: NotNegative  # N/mm²
    a6: NotNegative  # mm²/N
    a7: NotNegative  # mm²/N


class NonNormality(_Section):
    """2Gκ(b*) = a b*³."""

    a: NotNegative  # mm⁶/N³


class Constants(_Section):
    """All constants at one temperature; a function that the material has not is said to be `none`."""

    temperature: Positive  # K
    elasticity: Elasticity
    isotropic: IsotropicHardening | Literal["none"]
    kinematic: KinematicHardening | Literal["none"]
    non_normality: NonNormality | Literal["none"]


class Heating(_Section):
    """Adiabatic heating: of the plastic work b* the fraction `dissipated` warms the material."""

    dissipated: Annotated[float, Field(gt=0, le=1)]
    density: Positive  # t/mm³
    specific_heat: Positive  # N mm/(t K) = mm²/(s² K)


class Validity(_Section):
    """Where the constants may be trusted."""

    plastic_work: Positive  # largest b*, N/mm²; the checks of the functions go up to it
    remark: Text


class MaterialFile(_Section):
    """A whole material file."""

    name: Text
    description: Text
    source: Text
    units: Literal["N, mm, K"]
    validity: Validity
    temperatures: Annotated[tuple[Constants, ...], Field(min_length=1)]
    heating: Heating | None = None


UNITS = {
    "G": "N/mm²", "nu": "", "alpha": "1/K", "k0_squared": "N²/mm⁴", "a1": "N²/mm⁴", "a2": "mm²/N", "a3": "mm²/N",
    "b1": "N/mm²", "k1_squared": "N²/mm⁴", "k_inf_squared": "N²/mm⁴", "a4": "mm²/N", "a5": "N/mm²", "a6": "mm²/N",
    "a7": "mm²/N", "a": "mm⁶/N³",
}  # fmt: skip


HINTS = {
    "name": "a name for the material",
    "description": "a sentence that says what it is",
    "source": "where the constants come from",
    "units": "'N, mm, K', in which all numbers of the file are understood",
    "validity": "plastic_work, the largest b* in N/mm², and a remark",
    "plastic_work": "the largest b* up to which the constants are valid, N/mm²",
    "remark": "where else the constants may be trusted",
    "temperatures": "a list with the constants at one temperature at least",
    "temperature": "the temperature of the constants, K",
    "elasticity": "G and nu",
    "isotropic": "its constants, or 'none' if the material has no such function",
    "kinematic": "its constants, or 'none' if the material has no such function",
    "non_normality": "its constants, or 'none' if the material has no such function",
}


def read(path):
    """Read a material file.

    Args:
        path: YAML file.

    Returns:
        A `MaterialFile`.

    Raises:
        InputError: if the file cannot be read or says something wrong.
    """
    path = Path(path)
    try:
        content = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"cannot be read ({getattr(error, 'strerror', None) or error})", file=str(path)) from error
    except yaml.YAMLError as error:
        problem = " ".join(str(error).split())
        raise InputError(f"is not YAML: {problem}", file=str(path)) from error
    if not isinstance(content, dict):
        raise InputError("is no material file; it wants name, source, units, validity, ...", file=str(path))
    try:
        return MaterialFile.model_validate(content)
    except ValidationError as error:
        raise first_problem(error, path) from error


def first_problem(error, path, kind="material"):
    """The `InputError` of pydantic's first complaint, in place terms of a `kind` file."""
    first = error.errors()[0]
    inside = {"IsotropicHardening", "KinematicHardening", "NonNormality"}
    places = [str(part) for part in first["loc"] if part not in inside and not str(part).startswith("literal[")]
    name, value, message = places[-1] if places else "", first["input"], first["msg"]
    if first["type"] == "missing":
        problem = "is missing"
        if name in HINTS or name in UNITS:
            problem += f"; give {HINTS.get(name) or 'a number in ' + (UNITS[name] or '1')}"
    elif first["type"] == "extra_forbidden":
        near = get_close_matches(name, ENTRIES, 1, 0.7) if kind == "material" else []
        problem = f"is no entry of a {kind} file; " + (
            f"is {near[0]} meant?" if near else "docs/material.md lists them"
        )
    elif name in HINTS:
        problem = f"{value!r} is not what belongs here; give {HINTS[name]}"
    else:
        unit = UNITS.get(name) if isinstance(value, (int, float)) else None
        problem = f"{value!r}{' ' + unit if unit else ''}: {message[0].lower()}{message[1:]}"
    return InputError(problem, ".".join(places), str(path))


def _entry_names(model):
    for name, field in model.model_fields.items():
        yield name
        for inner in (field.annotation, *get_args(field.annotation)):
            if isinstance(inner, type) and issubclass(inner, BaseModel):
                yield from _entry_names(inner)


ENTRIES = sorted(set(_entry_names(MaterialFile)))
