"""Constants of spring steel for the data of a spring whose material does not say them."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Elastic:
    """What the data of a spring need of a material.

    Attributes:
        shear_modulus: G, MPa.
        young_modulus: E, MPa.
        density: kg/mm³.
    """

    shear_modulus: float
    young_modulus: float
    density: float


STEEL = Elastic(shear_modulus=81500.0, young_modulus=206000.0, density=7.85e-6)
"""Patented drawn spring wire after EN 10270-1, values of EN 13906-1."""
