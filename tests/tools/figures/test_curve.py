"""The characteristic between its steps, and what pictures show of a run."""

import numpy as np
import pytest

from coilset.model.core.base.between_steps import Between, part
from coilset.model.tools.figures.panels.characteristic import compressed
from coilset.model.tools.figures.panels.section_map import element_at
from coilset.model.tools.figures.scene import chosen


def test_the_curve_passes_its_steps_and_never_beyond_their_neighbours():
    travel = np.array([0.0, 2.0, 4.0, 6.0, 7.0, 7.5])
    force = np.array([0.0, 20.0, 40.0, 60.0, 90.0, 300.0])  # coils close
    for x, y in ((travel, force), (travel[::-1], force[::-1])):
        fine, values = Between.through(x, y).drawn()
        assert np.interp(x, np.sort(fine), values[np.argsort(fine)]) == pytest.approx(y)
        assert np.all(np.diff(values[np.argsort(fine)]) >= 0.0)
        assert fine[[0, -1]].tolist() == x[[0, -1]].tolist()


TRAVEL = np.array([0.0, 2.0, 5.0, 9.0, 10.0])
CONTACTS = np.array([2, 2, 2, 6, 8])


def kinked(travel):
    """Open with 3 N/mm up to 8 mm, then 50 N/mm."""
    return np.maximum(3.0 * travel, 24.0 + 50.0 * (travel - 8.0))


def test_a_kink_between_two_steps_is_where_their_lines_meet():
    """In both directions, and pulled as wound coils are; drawn and read alike. The chord is within the error."""
    for sign in (1.0, -1.0):
        for way in (slice(None), slice(None, None, -1)):
            x, y, contacts = sign * TRAVEL[way], kinked(TRAVEL)[way], CONTACTS[way]
            if sign < 0.0:  # from closed coils at -10 mm to open ones: the force still rises the steeper the more close
                x, y = sign * (10.0 - TRAVEL[way]), -kinked(10.0)[None].repeat(5) + kinked(TRAVEL)[way]
            curve = Between.through(x, y, contacts)
            fine, values = curve.drawn()
            at = fine if sign > 0.0 else fine + 10.0
            below = 0.0 if sign > 0.0 else kinked(10.0)
            assert values + below == pytest.approx(kinked(at))
            assert 8.0 in at.round(9)
            read = np.array([curve.at(one) for one in fine.tolist()])
            assert read[:, 0] == pytest.approx(values)
            chord = np.interp(fine, np.sort(x), y[np.argsort(x)])
            assert np.all(chord <= values + read[:, 2] + 1e-9)
            force, rate, away = curve.at(7.0 if sign > 0.0 else -3.0)
            assert (force + below, rate) == pytest.approx((21.0, 3.0))
            assert away == pytest.approx(15.0 + 2.0 * 59.0 / 4.0 - 21.0)


def test_the_release_behind_shows_the_rate_of_coils_that_close_in_the_last_step():
    """Without it the line is straight, and what lies between it and the open coils' line is its error."""
    travel, contacts = np.array([0.0, 2.0, 5.0, 9.0, 8.5]), np.array([2, 2, 2, 6, 5])
    force = kinked(travel)
    assert part(travel, force, contacts, 0, 3).at(7.0)[:2] == pytest.approx((21.0, 3.0))
    alone = part(travel[:4], force[:4], contacts[:4], 0, 3)
    force, _, away = alone.at(7.0)
    assert (force, force - away) == pytest.approx((15.0 + 2.0 * 59.0 / 4.0, 21.0))
    assert alone.at(9.0)[::2] == pytest.approx((74.0, 0.0))


def test_the_closed_rate_shows_where_wound_coils_open_in_the_first_step():
    """25 N by 27 N/mm, then 3 N/mm; the first step opens them."""
    travel = -np.array([0.0, 4.0, 8.0, 12.0])
    force = np.where(travel < 0.0, -25.0 + 3.0 * (travel + 25.0 / 27.0), 0.0)
    curve = part(travel, force, np.zeros(4), 0, 3, 27.0)
    assert curve.at(-25.0 / 27.0)[0] == pytest.approx(-25.0)
    assert curve.at(-0.5)[:2] == pytest.approx((-13.5, 27.0))


@pytest.mark.parametrize("travel", [[0.0, 1.0, 2.0], [0.0, 2.0, 1.0, 3.0]])
def test_few_steps_and_a_travel_that_turns_back_keep_their_lines(travel):
    assert Between.through(travel, travel).drawn()[0].tolist() == travel


def test_a_pulled_spring_is_not_called_compressed():
    assert [compressed(force) for force in (192.0, -192.0)] == ["Compressed", "Pulled"]


@pytest.mark.parametrize(("turn", "element"), [(None, 4), (0.0, 0), (1.3, 2), (4.0, 7), (9.0, 7)])
def test_the_section_is_drawn_where_the_stress_is(turn, element):
    assert element_at(np.linspace(0.0, 4.0, 9), turn) == element


def test_the_greatest_load_is_among_the_pictured_springs():
    """Of many phases the start and the last three were drawn, and block was not."""
    force = np.array([0.0, 900.0, 0.0, 100.0, 200.0, 0.0])
    assert chosen(force) == [0, 1, 4, 5]
    assert chosen(force[:3]) == [0, 1, 2]
    assert chosen(-np.arange(6.0)) == [0, 3, 4, 5]
