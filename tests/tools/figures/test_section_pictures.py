"""What the picture of a section shows between its points."""

import numpy as np
import pytest

from coilset.model.core.section.rules import abramowitz9, polar
from coilset.model.tools.figures.rings import ROUND, rings


def test_waves_round_a_ring_are_carried_between_its_points():
    """Up to five waves of twelve points; each ring has its own height."""
    rule = polar(4, 12)
    places, carried = rings(rule.points)

    def wave(points):
        radius, angle = np.hypot(*points.T), np.arctan2(points[:, 1], points[:, 0])
        return radius * (2.0 + np.cos(angle) - 3.0 * np.sin(5.0 * angle))

    assert places.shape == (4 * ROUND, 2)
    np.testing.assert_allclose(carried @ wave(rule.points), wave(places), atol=1e-12)


@pytest.mark.parametrize("rule", [abramowitz9(), polar(1, 3)], ids=lambda rule: rule.name)
def test_a_constant_stays_one(rule):
    places, carried = rings(rule.points)
    np.testing.assert_allclose(carried.sum(axis=1), 1.0, atol=1e-14)
    assert np.hypot(*places.T).max() <= 1.0 + 1e-9
