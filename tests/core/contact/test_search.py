"""Closest places on a wire of elements much shorter than it is thick, where only some stations are sorted."""

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from coilset.model.core.contact.base import TrialPositions
from coilset.model.core.contact.coils import Coils
from coilset.model.core.contact.curve import CentreLine

RADIUS, WIRE, PITCH = 20.0, 2.5, 4.9


@pytest.mark.parametrize("elements", [50, 500, 2000], ids=["every station", "every other", "one in seven"])
def test_every_point_finds_its_neighbours(elements):
    """One place above each point that has a coil above it, one below, at the distance of two coils of a helix.

    The reference is that distance, minimised over the turn by scipy. The smooth curve through the stations misses a
    circle by 6e-4 of its radius at 16 elements a turn and by (16/n)³ of that at n.
    """
    turns = np.linspace(0.0, 2.5, elements + 1)
    angle = 2 * np.pi * turns
    x = np.stack([RADIUS * np.cos(angle), RADIUS * np.sin(angle), PITCH * turns], axis=1)
    lengths = np.full(elements, 2 * np.pi * RADIUS * 2.5 / elements)
    points = CentreLine(turns, np.full(elements + 1, WIRE), lengths).points()
    far = x * [1.0, 1.0, 3.0]  # free of contact, so that no overlap counts as touching
    coils = Coils(points, far, 1e3, 0.005)
    pair, where, _ = coils.near(TrialPositions(x, np.zeros(12)), margin=0.5)

    def distance(turn):
        φ = 2 * np.pi * turn
        return np.sqrt(2 * RADIUS**2 * (1 - np.cos(φ)) + (PITCH * turn) ** 2)

    gap = minimize_scalar(distance, bounds=(0.9, 1.1), method="bounded", options={"xatol": 1e-12}).fun - 2 * WIRE
    above = turns[pair[:, 1]] > points.turns[pair[:, 0]]
    for side, low, high in ((above, 0.1, 1.4), (~above, 1.1, 2.4)):
        asked = np.flatnonzero((points.turns > low) & (points.turns < high))
        of_side = pair[side, 0]
        assert np.array_equal(np.sort(of_side[np.isin(of_side, asked)]), asked)
        inside = side & np.isin(pair[:, 0], asked)
        accuracy = 2 * 6e-4 * RADIUS * (16 / (elements / 2.5)) ** 3 + 1e-9
        np.testing.assert_allclose(where[inside, 1], gap, rtol=0, atol=accuracy)
