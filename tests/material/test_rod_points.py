"""The law at many points at once against the law point by point: elastic, flowing and neutrally loaded ones."""

import numpy as np
import pytest

from coilset.model.material import library
from coilset.model.material.point import solid, solid_rows
from coilset.model.material.point.points import initial_state
from coilset.model.material.point.rod import return_map
from coilset.model.material.point.rod_rows import GROUP, return_map_points

MATERIALS = ("ck15", "linear_isotropic", "linear_kinematic", "mixed", "ideal_plastic", "voce")
POINTS = 2 * GROUP + 7  # groups that are full, and one that is not


@pytest.mark.parametrize("name", MATERIALS)
@pytest.mark.parametrize("size", [1e-4, 3e-4, 4e-3])
def test_many_points_are_as_each_alone(name, size):
    """Stress and b* to 1e-9, the tangent to the square of the last local correction."""
    law, rng = library.load(name), np.random.default_rng(5)
    p, old = law.parameters(), initial_state(library.load(name), POINTS, 3)
    flowed = 0
    way = rng.normal(size=(3, POINTS))
    for length in (1e-2, size, size, -size, size):  # to where most flow, then on, and back
        de = length * (way + 0.2 * rng.normal(size=(3, POINTS)))
        de[:, :5] = 0.0  # loaded neutrally, once they have flowed
        new, tangent, count = np.empty_like(old), np.empty((9, POINTS)), np.empty(POINTS, np.int64)
        assert return_map_points(p, old, de, new, tangent, True, count)
        row, C = np.empty(old.shape[1]), np.empty((3, 3))
        for k in range(POINTS):
            alone = return_map(p, old[k], *de[:, k], row, C)
            assert (alone > 0) == (count[k] > 0)
            np.testing.assert_allclose(new[k], row, rtol=1e-9, atol=1e-9 * law.yield_stress)
            np.testing.assert_allclose(tangent[:, k].reshape(3, 3), C, rtol=0, atol=1e-5 * law.E)
            flowed += alone > 0
        old = new
    assert flowed > POINTS


@pytest.mark.parametrize("name", MATERIALS)
def test_many_points_of_a_solid_are_as_each_alone(name):
    """As above, with all six stresses."""
    law, rng = library.load(name), np.random.default_rng(5)
    p, old, flowed = law.parameters(), initial_state(law, POINTS, 6), 0
    way = rng.normal(size=(POINTS, 6))
    for length in (1e-2, 3e-4, 4e-3, -3e-4, 1e-4):
        de = length * (way + 0.2 * rng.normal(size=(POINTS, 6)))
        de[:5] = 0.0
        new, tangent, count = np.empty_like(old), np.empty((POINTS, 6, 6)), np.empty(POINTS, np.int64)
        assert solid_rows.return_map_points(p, old, de, new, tangent, count)
        row, C = np.empty(old.shape[1]), np.empty((6, 6))
        for k in range(POINTS):
            alone = solid.return_map(p, old[k], de[k], row, C)
            assert (alone > 0) == (count[k] > 0)
            np.testing.assert_allclose(new[k], row, rtol=1e-9, atol=1e-9 * law.yield_stress)
            np.testing.assert_allclose(tangent[k], C, rtol=0, atol=1e-5 * law.E)
            flowed += alone > 0
        old = new
    assert flowed > POINTS
