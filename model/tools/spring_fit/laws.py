"""Laws of few constants that springs can determine.

Springs are pressed one way, so that what they show is the sum of isotropic and kinematic hardening; which part is which
shows only where the wire flows backwards on release. Both forms therefore have the same constants: the yield stress σ₀,
the rise R of the flow stress in all, its rate m, and the share β of the rise that is back stress. In tension

    voce     σ = σ₀ + R (1 − exp(−m εᵖ)), whatever the share: the back stress is that of ζ with a₅ = β R/3, a₆ = 0,
             a₇ = m/σ₀, X = β R (1 − exp(−a₇ b*)), and k² the rest, σ_y = σ − X with db*/dεᵖ = σ_y, as a table
    thesis   over the plastic work b*:  k² = ⅔ [σ₀² + (σ₁² − σ₀²)(1 − exp(−m b*))], σ₁ = σ₀ + (1 − β) R, and ζ with
             a₅ = β R/3, a₆ = 0, a₇ = m; the curve in tension depends a little on the share, which a press then seems to
             determine even without flow backwards
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from coilset.model.core.base.errors import InputError
from coilset.model.core.material.law.file import MaterialFile
from coilset.model.core.material.law.law import Law

FORMS = ("voce", "thesis")
CONSTANTS = ("G", "yield_stress", "rise", "rate", "share")
DECAY = np.concatenate([np.linspace(0.0, 4.0, 41), np.linspace(4.4, 10.0, 15)])  # m εᵖ of the table; e⁻¹⁰ is left


@dataclass(frozen=True)
class Form:
    """A law of few constants.

    Attributes:
        name: voce or thesis.
        nu: Poisson's ratio.
        temperature: K.
        warmer: higher temperatures, K, and G there over that at `temperature`; all else stays.
        creep: its entries in a material file, if the wire creeps.
    """

    name: str
    nu: float
    temperature: float
    warmer: tuple[tuple[float, float], ...] = ()
    creep: Mapping[str, Any] | None = field(default=None, hash=False)

    def __post_init__(self) -> None:
        if self.name not in FORMS:
            raise InputError(f"'{self.name}' is none of {', '.join(FORMS)}", "--law")

    @property
    def units(self) -> dict[str, str]:
        """Units of the constants."""
        rate = "" if self.name == "voce" else "mm²/N"
        return {"G": "MPa", "yield_stress": "MPa", "rise": "MPa", "rate": rate, "share": ""}

    def rate_at(self, strain_rate: float, stress: float) -> float:
        """The constant `rate` of a rate over the plastic strain, at about this flow stress, MPa."""
        return strain_rate if self.name == "voce" else strain_rate / stress

    def material(self, values: Mapping[str, float], about: Mapping[str, Any]) -> dict[str, Any]:
        """Content of a material file.

        Args:
            values: of the constants.
            about: its name, description, source, and validity.
        """
        G, start, rise, rate, share = (float(values[name]) for name in CONSTANTS)
        fades = rate if self.name == "thesis" else rate / start
        if self.name == "thesis":
            end = start + (1.0 - share) * rise
            isotropic: dict[str, Any] = {"k0_squared": start**2 / 1.5, "a1": (end**2 - start**2) / 1.5, "a3": rate}
        else:
            strain, stress = _rest(start, rise, rate, share)
            isotropic = {"law": "table", "strains": "plastic", "strain": strain.tolist(), "stress": stress.tolist()}
        at = {
            "temperature": self.temperature,
            "elasticity": {"G": G, "nu": self.nu},
            "isotropic": isotropic,
            "kinematic": {"a5": share * rise / 3.0, "a6": 0.0, "a7": fades} if share * rise > 0.0 else "none",
            "non_normality": "none",
        }
        rows = [at]
        for warmer, softer in self.warmer:
            rows.append(at | {"temperature": warmer, "elasticity": {"G": softer * G, "nu": self.nu}})
        creep = {} if self.creep is None else {"creep": dict(self.creep)}
        return {**about, "units": "N, mm, K", "temperatures": rows, **creep}

    def law(self, values: Mapping[str, float]) -> Law:
        """The Law of these constants, at other temperatures only if it creeps there."""
        form = self if self.creep else replace(self, warmer=())
        return Law(MaterialFile.model_validate(form.material(values, TRIAL)))


TRIAL = {
    "name": "trial",
    "description": "of a fit",
    "source": "a fit",
    "validity": {"plastic_work": 1.0, "remark": "of a fit"},
}


def _rest(start: float, rise: float, rate: float, share: float) -> tuple[np.ndarray, np.ndarray]:
    """σ_y over εᵖ: what the back stress leaves of Voce's curve; db*/dεᵖ = σ_y by Runge and Kutta's fourth order."""
    back, fades = share * rise, rate / start

    def stress(strain: float, work: float) -> float:
        return start - rise * math.expm1(-rate * strain) + back * math.expm1(-fades * work)

    strain, work = DECAY / rate, [0.0]
    for at, to in zip(strain[:-1].tolist(), strain[1:].tolist(), strict=True):
        h, b = to - at, work[-1]
        k1 = stress(at, b)
        k2 = stress(at + 0.5 * h, b + 0.5 * h * k1)
        k3 = stress(at + 0.5 * h, b + 0.5 * h * k2)
        k4 = stress(to, b + h * k3)
        work.append(b + h * (k1 + 2.0 * (k2 + k3) + k4) / 6.0)
    rest = np.array([stress(*pair) for pair in zip(strain.tolist(), work, strict=True)])
    return strain, np.maximum.accumulate(rest)  # constant but for rounding where all of the rise is back stress
