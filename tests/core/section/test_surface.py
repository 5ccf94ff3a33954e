"""Where the inside of a coil is, and the maximum value on the surface."""

import numpy as np
import pytest

from coilset.model.core.results.surface import Inside, beyond_middle, equivalent, nominal_shear, peak, shear
from coilset.model.core.section.rules import rim

PLANE = ("s11", "t12", "t13", "B11", "B12", "B13", "b")
WARPING = ("s11", "s22", "s33", "t12", "t13", "t23", "B11", "B22", "B33", "B12", "B13", "B23", "b")
TURNS = np.array([[0.1, 0.3], [0.6, 0.8]])


def test_stresses_of_both_kinds_of_state():
    """σ11 = 3, τ12 = 4, τ13 = 12: √(16 + 144) and √(9 + 3 · 160); a pressure changes nothing."""
    plane, full = np.zeros((2, 7)), np.zeros((2, 13))
    plane[:, :3] = 3.0, 4.0, 12.0
    full[:, [0, 3, 4]] = 3.0, 4.0, 12.0
    full[:, :3] += 7.0
    for state, names in ((plane, PLANE), (full, WARPING)):
        np.testing.assert_allclose(shear(state, names), np.sqrt(160.0))
        np.testing.assert_allclose(equivalent(state, names), np.sqrt(489.0))


@pytest.mark.parametrize(
    ("knows", "hand", "index", "sign"), [(True, 1, 0, -1), (True, -1, 0, 1), (False, 1, 0, -1), (False, -1, 12, -1)]
)
def test_inside(knows, hand, index, sign):
    state = np.zeros((2, 2, 24, 7))
    state[..., index, 2] = 5.0
    np.testing.assert_array_equal(Inside.of(knows, hand).shear(state, PLANE), sign * 5.0)


def test_peak_lies_between_the_points():
    """A wave cos(φ − 100°) with its points at every 15°: the parabola finds 100° to 0.2° and its height to 1e-4."""
    angle = np.degrees(np.arctan2(*rim().T[::-1]))
    values = np.zeros((2, 2, 24))
    values[1, 0] = np.cos(np.radians(angle - 100.0))
    found = peak(values, TURNS, Inside(0.0, 1.0))
    assert found.value == pytest.approx(1.0, abs=1e-4)
    assert found.turn == 0.6
    assert found.angle == pytest.approx(100.0, abs=0.2)
    assert peak(values, TURNS, Inside(np.pi, 1.0)).angle == pytest.approx(-80.0, abs=0.2)


@pytest.mark.parametrize("rounding", [-1e-12, 0.0, 1e-12])
def test_of_two_peaks_that_differ_by_rounding_the_first_is_returned(rounding):
    values = np.zeros((2, 2, 24))
    values[1, 0] = np.arange(24.0)
    values[0, 1] = values[1, 0] * (1.0 + rounding)
    assert peak(values, TURNS, Inside(0.0, 1.0)).turn == 0.3
    values[0, 1] *= 0.999
    assert peak(values, TURNS, Inside(0.0, 1.0)).turn == 0.6


def test_middle_turns():
    np.testing.assert_allclose(beyond_middle(np.array([0.9, 1.1, 2.9, 3.1]), 0.0, 4.0), [0.1, -0.1, -0.1, 0.1])
    np.testing.assert_allclose(beyond_middle(np.array([1.9, 2.1, 3.9, 4.1]), 1.0, 5.0), [0.1, -0.1, -0.1, 0.1])
    np.testing.assert_allclose(beyond_middle(np.array([0.2, 0.3, 0.7, 0.8]), 0.0, 1.0), [0.05, -0.05, -0.05, 0.05])


def test_nominal_shear_is_torsion_of_the_disk():
    """F D/2 over the section modulus π d³/16."""
    assert nominal_shear(100.0, 40.0, 5.0) == pytest.approx(100.0 * 20.0 / (np.pi * 125.0 / 16.0))
