"""The material library's law at the points of the solid, against the closed form written for these tests."""

import numpy as np
from solid_laws import IdealPlastic

from coilset.model.core.material import library
from coilset.model.physics.solid.points import MaterialPoints


def test_ideal_plastic_is_where_radial_return_goes():
    """Against radial return in 5000 parts of each increment, which is as close as 1e-4 of the flow stress.

    Found at whole increments of two to six yield strains that turn abruptly are 4 % of the flow stress (radial return:
    13 %), at a quarter of them 0.3 % and at a sixteenth 0.024 %: second order.
    """
    law = library.load("ideal_plastic")
    mine = IdealPlastic(law.G, law.nu, shear_yield=law.yield_stress / np.sqrt(3))
    theirs = MaterialPoints(law)
    rng = np.random.default_rng(8)
    strains = 2e-3 * rng.normal(size=(4, 50, 6))
    exact = follow(mine, strains, 5000)
    errors = [np.abs(follow(theirs, strains, n) - exact)[:, :6].max() / law.yield_stress for n in (1, 4, 16)]
    assert errors[0] < 0.05
    assert errors[0] / errors[1] > 10
    assert errors[1] / errors[2] > 10
    assert np.all(follow(theirs, strains, 1)[:, 12] > 0)


def follow(points, strains, parts):
    """Point states after all increments, each in equal parts."""
    state = points.initial_state(strains.shape[1])
    for strain in strains:
        for _ in range(parts):
            new, C = np.empty_like(state), np.empty((len(state), 6, 6))
            assert points.update(state, strain / parts, new, C)
            state = new
    return state
