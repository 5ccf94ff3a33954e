"""A material from a test certificate: strength, 0.2 % proof stress, elastic limit and shear modulus of a wire."""

from dataclasses import dataclass
from typing import Any

from coilset.model.core.base.errors import InputError
from coilset.model.tools.wires.hardening import Curve, curve
from coilset.model.tools.wires.wire import ROOM_TEMPERATURE

ASSUMED = (
    "saturating isotropic hardening (Voce, in the plastic work) through elastic limit, 0.2 % proof stress and tensile "
    "strength; the same in torsion after von Mises; no Bauschinger effect, which makes residual stresses of strongly "
    "preset springs too high; no stresses from drawing and coiling"
)


@dataclass(frozen=True)
class Certificate:
    """Values on a wire's certificate, MPa.

    Attributes:
        strength: tensile strength Rm.
        proof_stress: 0.2 % proof stress Rp0.2.
        shear_modulus: G.
        nu: Poisson's ratio.
        given_limit: elastic limit; None if the certificate has none.
    """

    strength: float
    proof_stress: float
    shear_modulus: float
    nu: float
    given_limit: float | None = None

    @property
    def elastic_limit(self) -> float:
        """Elastic limit, MPa: as given, or as far below the proof stress as that is below Rm (an estimate)."""
        return 2.0 * self.proof_stress - self.strength if self.given_limit is None else self.given_limit

    @property
    def assumptions(self) -> str:
        """Basis of the material made from it, in a sentence."""
        if self.given_limit is not None:
            return ASSUMED
        limit = f"elastic limit of {self.elastic_limit:.4g} MPa estimated: the proof stress halfway between it and Rm"
        return f"{limit}; {ASSUMED}"

    def curve(self) -> Curve:
        """Hardening curve through the three stresses.

        Raises:
            InputError: if they do not ascend.
        """
        limit, proof, strength = self.elastic_limit, self.proof_stress, self.strength
        if not 0.0 < limit < proof < strength:
            stresses = f"elastic limit {limit:g}, 0.2 % proof stress {proof:g}, strength {strength:g} MPa"
            raise InputError(f"{stresses}: must ascend; give --elastic-limit if the proof stress is low", "certificate")
        return curve(limit, proof, strength, 2.0 * self.shear_modulus * (1.0 + self.nu), self.nu)

    def material(self, name: str, source: str) -> dict[str, Any]:
        """Entries of a material file.

        Args:
            name: of the material.
            source: where the numbers come from.

        Raises:
            InputError: as `curve`.
        """
        about = {"name": name, "description": f"Wire {name} from its certificate; hardening is an estimate"}
        data = saturating(self.curve(), self.shear_modulus, self.nu)
        data["validity"]["remark"] = self.assumptions
        return {**about, "source": source, "tensile_strength": self.strength, **data}


def saturating(found: Curve, shear_modulus: float, nu: float) -> dict[str, Any]:
    """Entries of a material file for a hardening curve at room temperature, valid up to the uniform strain."""
    start, saturation = found.start**2 / 1.5, found.saturation**2 / 1.5
    branch = {"b1": 0.0, "k1_squared": start, "k_inf_squared": saturation, "a4": found.rate}
    return {
        "units": "N, mm, K",
        "validity": {"plastic_work": found.work(found.stress_at_greatest_force), "remark": ""},
        "temperatures": [
            {
                "temperature": ROOM_TEMPERATURE,
                "elasticity": {"G": shear_modulus, "nu": nu},
                "isotropic": {"k0_squared": start, "saturation": branch},
                "kinematic": "none",
                "non_normality": "none",
            }
        ],
    }
