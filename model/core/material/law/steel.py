"""Constants of spring steel for springs whose material does not give them."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Elastic:
    """The material constants that the data of a spring require.

    Attributes:
        shear_modulus: G, MPa.
        young_modulus: E, MPa.
        density: kg/mm³.
    """

    shear_modulus: float
    young_modulus: float
    density: float


STEEL = Elastic(shear_modulus=81500.0, young_modulus=206000.0, density=7.85e-6)
"""Patented drawn spring wire according to EN 10270-1, values of EN 13906-1."""
