"""The material library's law at the points of the solid, against the closed form written for these tests."""

import numpy as np
from solid_laws import IdealPlastic

from coilset.model.material import library
from coilset.model.solid.points import MaterialPoints


def test_ideal_plastic_is_radial_return():
    law = library.load("ideal_plastic")
    mine = IdealPlastic(law.G, law.nu, shear_yield=law.yield_stress / np.sqrt(3))
    theirs = MaterialPoints(law)
    rng = np.random.default_rng(8)
    a, b = mine.initial_state(50), theirs.initial_state(50)
    assert np.array_equal(a, b)
    for _ in range(4):
        strain = 2e-3 * rng.normal(size=(50, 6))
        results = []
        for points, old in ((mine, a), (theirs, b)):
            new, C = np.empty_like(old), np.empty((50, 6, 6))
            assert points.update(old, strain, new, C)
            results.append((new, C))
        (a, Ca), (b, Cb) = results
        # the library splits off the elastic part of an increment, which ideal plasticity does not notice
        assert np.allclose(a[:, :6], b[:, :6], rtol=1e-9, atol=1e-7 * law.yield_stress)
        assert np.allclose(Ca, Cb, rtol=1e-8, atol=1e-8 * law.G)
    assert np.all(b[:, 12] > 0)
