"""The law at many points at once against each local problem by itself: elastic, flowing and neutrally loaded points."""

import numpy as np
import pytest

from coilset.model.core.material import library
from coilset.model.core.material.law.hardening_curves import Swift
from coilset.model.core.material.law.law import Law
from coilset.model.core.material.point import points
from coilset.model.core.material.point.local_rows import GROUP
from coilset.model.core.material.point.loops import follow

MATERIALS = ("ck15", "linear_isotropic", "linear_kinematic", "mixed", "ideal_plastic", "voce")
POINTS = 2 * GROUP + 7  # groups that are full, and one that is not


def table(law, softer=1.0, **entries):
    """The same law as a table of two temperatures; G of the second times softer, and other entries."""
    low = law.data.temperatures[0]
    elasticity = low.elasticity.model_copy(update={"G": softer * low.elasticity.G})
    high = low.model_copy(update={"temperature": low.temperature + 100.0, "elasticity": elasticity} | entries)
    return Law(law.data.model_copy(update={"temperatures": (low, high)}))


def one_by_one(law):
    """The same law at its first temperature; as a curve hardens at the second, points are solved one by one."""
    return table(law, isotropic=Swift(law="swift", C=600.0, strain_0=1e-3, n=0.01))


def scaled(law, factor):
    """k² or, with a back stress, ζ times a factor, and κ."""
    at = law.data.temperatures[0]
    kinematic, isotropic, deviation = at.kinematic, at.isotropic, at.non_normality
    if kinematic != "none":
        kinematic = kinematic.model_copy(update={"a5": factor * kinematic.a5})
    else:
        isotropic = times(isotropic, factor, "k0_squared", "a1")
        if isotropic.saturation:
            second = times(isotropic.saturation, factor, "k1_squared", "k_inf_squared")
            isotropic = isotropic.model_copy(update={"saturation": second})
    if deviation != "none":
        deviation = times(deviation, factor, "a")
    return {"kinematic": kinematic, "isotropic": isotropic, "non_normality": deviation}


def times(entries, factor, *names):
    return entries.model_copy(update={name: factor * getattr(entries, name) for name in names})


def advanced(law, old, de, temperature=None):
    """New states, tangents and counts; de: increments, shape (points, 3 or 6)."""
    new, tangent, count = follow(law.parameters(temperature), old, de)
    assert (count >= 0).all()
    return new, tangent, count


@pytest.mark.parametrize("name", MATERIALS)
@pytest.mark.parametrize("components", [3, 6])
@pytest.mark.parametrize("size", [1e-4, 3e-4, 4e-3])
def test_many_points_are_as_each_alone(name, components, size):
    """Stress and b* to 1e-9, the tangent to the square of the last local correction."""
    law, rng = library.load(name), np.random.default_rng(5)
    alone, old, flowed = one_by_one(law), points.initial_state(law, POINTS, components), 0
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


@pytest.mark.parametrize("name", MATERIALS)
@pytest.mark.parametrize("components", [3, 6])
def test_points_between_two_temperatures(name, components):
    """Functions that are proportional at two temperatures are those of one law between them."""
    law, rng = library.load(name), np.random.default_rng(5)
    at = law.data.temperatures[0]
    ours = table(law, **scaled(law, 0.8))
    one = Law(law.data.model_copy(update={"temperatures": (at.model_copy(update=scaled(law, 0.9)),)}))
    old, flowed = points.initial_state(law, POINTS, components), 0
    for length in (1e-2, -4e-3):
        de = length * rng.normal(size=(POINTS, components))
        new, tangent, count = advanced(ours, old, de, at.temperature + 50.0)
        row, C, found = advanced(one, old, de)
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
