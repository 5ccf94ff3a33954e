"""The law at many points at once against each local problem by itself: elastic, flowing and neutrally loaded points."""

import numpy as np
import pytest

from coilset.model.material import library
from coilset.model.material.law.law import Law
from coilset.model.material.point import points, rod, solid
from coilset.model.material.point.local_rows import GROUP

MATERIALS = ("ck15", "linear_isotropic", "linear_kinematic", "mixed", "ideal_plastic", "voce")
POINTS = 2 * GROUP + 7  # groups that are full, and one that is not


def table(law, softer=1.0):
    """The same law as a table of two temperatures, whose points are solved one by one; G of the second times softer."""
    low = law.data.temperatures[0]
    elasticity = low.elasticity.model_copy(update={"G": softer * low.elasticity.G})
    high = low.model_copy(update={"temperature": low.temperature + 100.0, "elasticity": elasticity})
    return Law(law.data.model_copy(update={"temperatures": (low, high)}))


def advanced(law, old, de):
    """New states, tangents and counts; de: increments, shape (points, 3 or 6)."""
    new, count = np.empty_like(old), np.empty(len(old), np.int64)
    if de.shape[1] == 3:
        rows = np.empty((9, len(old)))
        assert rod.return_map_points(law.parameters(), old, de.T.copy(), new, rows, True, count)
        return new, rows.T.reshape(-1, 3, 3), count
    tangent = np.empty((len(old), 6, 6))
    assert solid.return_map_points(law.parameters(), old, de, new, tangent, count)
    return new, tangent, count


@pytest.mark.parametrize("name", MATERIALS)
@pytest.mark.parametrize("components", [3, 6])
@pytest.mark.parametrize("size", [1e-4, 3e-4, 4e-3])
def test_many_points_are_as_each_alone(name, components, size):
    """Stress and b* to 1e-9, the tangent to the square of the last local correction."""
    law, rng = library.load(name), np.random.default_rng(5)
    alone, old, flowed = table(law), points.initial_state(law, POINTS, components), 0
    way = rng.normal(size=(POINTS, components))
    for length in (1e-2, size, size, -size, size):  # to where most flow, then on, and back
        de = length * (way + 0.2 * rng.normal(size=way.shape))
        de[:5] = 0.0  # loaded neutrally, once they have flowed
        new, tangent, count = advanced(law, old, de)
        row, C, found = advanced(alone, old, de)
        assert ((found > 0) == (count > 0)).all()
        np.testing.assert_allclose(new, row, rtol=1e-9, atol=1e-9 * law.yield_stress)
        np.testing.assert_allclose(tangent, C, rtol=0, atol=1e-5 * law.E)
        flowed, old = flowed + (count > 0).sum(), new
    assert flowed > POINTS


@pytest.mark.parametrize("components", [3, 6])
def test_points_with_a_temperature_each(components):
    """Rows with a temperature are as rows without one at that temperature, and keep what stands behind."""
    law, rng = table(library.load("ck15"), softer=0.7), np.random.default_rng(5)
    temperatures = rng.uniform(*law.temperature_range, size=9)
    de = 4e-3 * rng.normal(size=(9, components))
    cold = points.initial_state(law, 9, components)
    new, tangent, count = advanced(law, np.column_stack([cold, temperatures, np.full(9, 1e-4)]), de)
    assert (count > 0).any()
    np.testing.assert_array_equal(new[:, -2:], np.column_stack([temperatures, np.full(9, 1e-4)]))
    for k, temperature in enumerate(temperatures):
        one = points.update(law, cold[k, None], de[k, None], float(temperature))
        assert new[k, :-2].tolist() == one[0][0].tolist()
        assert tangent[k].tolist() == one[1][0].tolist()
