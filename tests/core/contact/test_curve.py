"""The smooth curve through the stations."""

import numpy as np
import pytest

from coilset.model.core.contact.curve import CentreLine


def points_on(turns):
    return CentreLine(turns, np.ones(len(turns)), np.diff(turns)).points()


def test_a_parabola_is_met_exactly_also_between_uneven_stations_and_at_the_ends():
    turns = np.array([0.0, 0.1, 0.35, 0.4, 0.8, 1.0])
    points = points_on(turns)

    def parabola(t):
        return np.stack([t, 3 * t**2 - t, 0 * t], axis=-1)

    np.testing.assert_allclose(points.at(parabola(turns)), parabola(points.turns), atol=1e-14)
    assert len(points) == 11
    assert points.length.sum() == pytest.approx(1.0, rel=1e-14)


@pytest.mark.parametrize("stations", [2, 3, 4])
def test_short_wires_are_met_too(stations):
    turns = np.linspace(0, 1, stations)
    x = np.stack([turns, 2 * turns, 1 - turns], axis=1)
    points = points_on(turns)
    np.testing.assert_allclose(points.at(x)[:, 0], points.turns, atol=1e-14)


def test_a_circle_is_met_with_fourth_order():
    """5.5e-4 of the radius is missing between stations at 16 a turn, a sixteenth of that at 32."""
    errors = []
    for per_turn in (16, 32, 64):
        turns = np.arange(3 * per_turn + 1) / per_turn
        x = np.stack([np.cos(2 * np.pi * turns), np.sin(2 * np.pi * turns), 0 * turns], axis=1)
        p = points_on(turns).at(x)[per_turn:-per_turn]
        errors.append(np.abs(np.hypot(p[:, 0], p[:, 1]) - 1).max())
    assert errors[0] < 6e-4
    np.testing.assert_allclose(np.log2(np.divide(errors[:-1], errors[1:])), 4.0, atol=0.1)
