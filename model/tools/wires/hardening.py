"""A hardening curve from three numbers of a wire's tensile test: elastic limit, 0.2 % proof stress and strength.

The curve is the saturating one of the material library (`voce`): with the plastic work b*,

    σ²(b*) = σ∞² − (σ∞² − σ0²) exp(−a4 b*),   σ² = 1.5 k² (3.1.4).

In tension db* = σ dεp, hence dσ/dεp = ½ a4 (σ∞² − σ²), and in closed form

    σ(εp) = σ∞ tanh(artanh(σ0/σ∞) + ½ a4 σ∞ εp).

σ is the true stress and εp the logarithmic plastic strain. The engineering stress, force over initial section, is
s = σ exp(−εp − 2ν σ/E): plastic strain preserves the volume, elastic strain contracts the section by ν.
"""

from dataclasses import dataclass
from math import atanh, exp, log, tanh

PROOF_STRAIN = 0.002


@dataclass(frozen=True)
class Curve:
    """The constants of the curve, N and mm.

    Attributes:
        start: σ0, true stress at which plastic flow starts, N/mm².
        saturation: σ∞, N/mm².
        rate: a4, mm²/N.
        contraction: 2ν/E, mm²/N.
    """

    start: float
    saturation: float
    rate: float
    contraction: float

    def true_stress(self, plastic_strain: float) -> float:
        """σ at a logarithmic plastic strain, N/mm²."""
        half = 0.5 * self.rate * self.saturation
        return self.saturation * tanh(atanh(self.start / self.saturation) + half * plastic_strain)

    def test_stress(self, plastic_strain: float) -> float:
        """Engineering stress, force over the initial section, N/mm²."""
        σ = self.true_stress(plastic_strain)
        return σ * exp(-plastic_strain - self.contraction * σ)

    def plastic_strain(self, stress: float) -> float:
        """Logarithmic plastic strain at a true stress between σ0 and σ∞."""
        return (
            2 * (atanh(stress / self.saturation) - atanh(self.start / self.saturation)) / (self.rate * self.saturation)
        )

    def work(self, stress: float) -> float:
        """Plastic work b* at a true stress between σ0 and σ∞, N/mm²."""
        σ2, k2 = self.saturation**2, self.start**2
        return log((σ2 - k2) / (σ2 - stress**2)) / self.rate

    @property
    def stress_at_greatest_force(self) -> float:
        """True stress at which ds = 0 (Considère): ½ a4 (σ∞² − σ²)(1 − 2ν σ/E) = σ, N/mm²."""

        def excess(σ: float) -> float:
            return 0.5 * self.rate * (self.saturation**2 - σ**2) * (1 - self.contraction * σ) - σ

        from scipy.optimize import brentq

        return self.start if excess(self.start) <= 0 else brentq(excess, self.start, self.saturation, xtol=1e-9)

    @property
    def uniform_strain(self) -> float:
        """Logarithmic plastic strain at the maximum force."""
        return self.plastic_strain(self.stress_at_greatest_force)

    @property
    def strength(self) -> float:
        """Maximum engineering stress, N/mm²."""
        return self.test_stress(self.uniform_strain)


def curve(elastic_limit: float, proof_stress: float, strength: float, young_modulus: float, nu: float) -> Curve:
    """The curve through an elastic limit, a 0.2 % proof stress and a strength Rm of the tensile test, which ascend, all
    in N/mm²."""
    contraction = 2 * nu / young_modulus
    start = _true(elastic_limit, 0.0, contraction)
    proof = _true(proof_stress, PROOF_STRAIN, contraction)

    def through_both(saturation: float) -> Curve:
        reach = atanh(proof / saturation) - atanh(start / saturation)
        return Curve(start, saturation, 2 * reach / (saturation * PROOF_STRAIN), contraction)

    # with σ∞ just above the proof stress, so is the strength, and it grows with σ∞
    from scipy.optimize import brentq

    saturation = brentq(lambda σ: through_both(σ).strength - strength, proof * (1 + 1e-9), 5 * strength, xtol=1e-9)
    return through_both(saturation)


def _true(stress: float, plastic_strain: float, contraction: float) -> float:
    """True stress of an engineering stress s: σ = s exp(εp + 2ν σ/E), iterated; 2ν σ/E is a few thousandths."""
    σ = stress
    for _ in range(20):
        σ = stress * exp(plastic_strain + contraction * σ)
    return σ
