"""The law of a wire by its name: elasticity from the standard, hardening estimated from its minimum strength."""

from coilset.meshes.springs.geometry import Spring
from coilset.model.core.base.errors import InputError
from coilset.model.core.case import Case
from coilset.model.core.material.law.file import MaterialFile
from coilset.model.core.material.law.law import CELSIUS, Law
from coilset.model.core.material.law.steel import Elastic
from coilset.model.tools.wires.certificate import saturating
from coilset.model.tools.wires.hardening import Curve, curve
from coilset.model.tools.wires.library import wire
from coilset.model.tools.wires.wire import ROOM_TEMPERATURE, Wire

SLOPE_RANGE = (233.15, 473.15)  # K, in which the slope of G is used: an estimate, no source gives its range
SAME = 0.02  # maximum relative change of the diameter along one wire
ASSUMPTIONS = (
    "estimate, until a test of the wire is given: saturating isotropic hardening (Voce, in the plastic work) through "
    "the elastic limit {elastic:.4g} and the 0.2 % proof stress {proof:.4g} to the least strength {strength:.4g} "
    "MPa; a uniform plastic strain of {uniform:.2g} % follows from it. The same in torsion after von Mises; no "
    "Bauschinger effect, which makes residual stresses of strongly preset springs too high; no stresses from drawing "
    "and coiling, no change by tempering; delivered wire is stronger than the least strength, by up to 17 % in "
    "EN 10270-1"
)


def hardening_curve(wire: Wire, diameter: float) -> Curve:
    """The estimated hardening curve of a wire at a diameter, mm."""
    strength, elastic, entry = wire.strength(diameter), wire.elastic(diameter), wire.entry
    nu = poisson_ratio(elastic)
    shares = entry.elastic_limit.at(diameter), entry.proof_stress.at(diameter)
    return curve(shares[0] * strength, shares[1] * strength, strength, elastic.young_modulus, nu)


def poisson_ratio(elastic: Elastic) -> float:
    """ν = E/(2G) − 1 from the two moduli that a standard gives; for some wires it is not a physical property."""
    return elastic.young_modulus / (2 * elastic.shear_modulus) - 1


def wire_law(name: str, diameter: float, spin: bool = False, temperature: float | None = None) -> Law:
    """The law of a wire at a diameter, marked as an estimate.

    Args:
        name: name of a wire, as in `coilset.model.tools.wires.names()`.
        diameter: of the wire, mm.
        spin: see `Law`.
        temperature: K; default is 20 °C. The moduli are those of `warm_elastic`; the strength stays that of 20 °C.

    Returns:
        Law at this temperature, valid up to the plastic work at uniform strain.

    Raises:
        InputError: an unknown wire, a diameter without a known strength, or a temperature beyond that of its slope.
    """
    known = wire(name)
    elastic, found = warm_elastic(known, diameter, temperature), hardening_curve(known, diameter)
    strength = known.strength(diameter)
    data = saturating(found, elastic.shear_modulus, poisson_ratio(elastic))
    data["temperatures"][0]["temperature"] = ROOM_TEMPERATURE if temperature is None else temperature
    data["validity"]["remark"] = ASSUMPTIONS.format(
        elastic=known.entry.elastic_limit.at(diameter) * strength,
        proof=known.entry.proof_stress.at(diameter) * strength,
        strength=strength,
        uniform=100 * found.uniform_strain,
    )
    data |= {
        "name": f"{known.name}, {diameter:g} mm",
        "description": f"Spring wire {known.name} of {diameter:g} mm; hardening is an estimate",
        "source": "strength " + known.citation(known.entry.strength),
    }
    return Law(MaterialFile.model_validate(data), spin)


def warm_elastic(wire: Wire, diameter: float, temperature: float | None) -> Elastic:
    """Moduli and density of a wire at a diameter, mm, and a temperature, K; None: 20 °C.

    G decreases by the slope of the standard, E by the same part (an estimate).

    Raises:
        InputError: if the wire has no slope, or the temperature lies outside of where it is used.
    """
    cold = wire.elastic(diameter)
    part = 1.0 if temperature is None else _softened(wire, temperature)
    return Elastic(part * cold.shear_modulus, part * cold.young_modulus, cold.density)


def _softened(wire: Wire, temperature: float) -> float:
    """G at a temperature over G at 20 °C.

    Raises:
        InputError: if the wire has no slope, or the temperature lies outside of where it is used.
    """
    if temperature == ROOM_TEMPERATURE:
        return 1.0
    slope = wire.entry.shear_modulus_decrease
    if slope is None or slope.value is None:
        raise InputError(f"how G of '{wire.name}' decreases is unknown; give a material file", "temperature")
    low, high = SLOPE_RANGE
    if not low <= temperature <= high:
        problem = f"{temperature:g} K: the slope of G is used from {low:g} to {high:g} K only"
        if low <= temperature + CELSIUS <= high:
            problem += f"; {temperature:g} °C is {temperature + CELSIUS:g} K"
        raise InputError(f"{problem}; give a material file for this temperature", "temperature")
    return 1.0 - slope.value * (temperature - ROOM_TEMPERATURE)


def softening(case: Case, law: Law, temperature: float) -> list[tuple[float, float]]:
    """Temperatures above one, K, at which G of a case's material is known, and G there over that at it.

    Of a material file those of its table, of a named wire the highest of its slope.

    Args:
        case, law: the law is that of `case_law`.
        temperature: K.
    """
    if isinstance(case.material, str):
        table = [float(one) for one in law.temperatures if one > temperature]
        G = law.moduli([law.known(temperature), *table])[1]
        return list(zip(table, (G[1:] / G[0]).tolist(), strict=True))
    known, hot = wire(case.material.wire), SLOPE_RANGE[1]
    if known.entry.shear_modulus_decrease is None or not SLOPE_RANGE[0] <= temperature < hot:
        return []
    return [(hot, _softened(known, hot) / _softened(known, temperature))]


def wire_diameter(spring: Spring) -> float:
    """The single wire diameter of a spring, mm; that of a measured spring may vary by the tolerance of wires, 2 %.

    Raises:
        InputError: if it changes along the wire.
    """
    d = spring.wire_diameter(spring.breaks)
    low, high = float(d.min()), float(d.max())
    if high - low > SAME * high:
        raise InputError(
            f"a wire of a standard has one diameter; this spring's goes from {low:.4g} to {high:.4g} mm",
            "material.wire",
        )
    return 0.5 * (low + high)
