"""exp(x), φ = exp(−z), ψ = (1 − φ)/z and dψ/dz against the decimal module, which gives them to 50 digits."""

from decimal import Decimal, localcontext

import numpy as np
import pytest

from coilset.model.core.material.law.exponential import decay, exp

ROUNDING = 2.0**-53
RANGES = {
    "without reduction": lambda rng: rng.uniform(-0.3465, 0.3465, 300),
    "where reduction sets in": lambda rng: 0.34657359028 + rng.uniform(-1e-9, 1e-9, 100),
    "small": lambda rng: rng.choice([-1, 1], 300) * 10 ** rng.uniform(-300, -1, 300),
    "common": lambda rng: rng.uniform(-6, 6, 300),
    "all": lambda rng: rng.uniform(-690, 690, 300),
}


def exact(x):
    """exp(x), and φ, ψ, dψ/dz at z = x."""
    with localcontext(prec=700 if abs(x) < 1e-6 else 50):  # what cancels is of the order x²
        z = Decimal(float(x))
        phi = (-z).exp()
        psi = (1 - phi) / z
        return z.exp(), phi, psi, (phi - psi) / z


@pytest.mark.parametrize("name", RANGES)
def test_errors_are_of_the_order_of_rounding(name):
    """Measured at most, in units of 2⁻⁵³: 1.3, 1.5, 3.0 and, where φ − ψ cancels next to ½ ln 2, 24."""
    for x in RANGES[name](np.random.default_rng(3)):
        found = (exp(x), *decay(x))
        for value, expected, units in zip(found, exact(x), (2, 2, 4, 40), strict=True):
            assert abs(float((Decimal(value) - expected) / expected)) < units * ROUNDING


def test_ends():
    assert exp(0.0) == 1.0
    assert decay(0.0) == (1.0, 1.0, -0.5)
    assert 0.0 < exp(-1e6) < 1e-300
    assert decay(1e6)[0] < 1e-300
    assert decay(1e6)[1:] == pytest.approx((1e-6, -1e-12), rel=1e-15)
    assert np.isnan(decay(np.nan)[1])
