"""The characteristic between its steps, and what pictures show of a run."""

import numpy as np
import pytest

from coilset.model.figures.panels.characteristic import compressed, smooth
from coilset.model.figures.panels.section_map import element_at
from coilset.model.figures.scene import chosen


def test_the_curve_passes_its_steps_and_never_beyond_their_neighbours():
    travel = np.array([0.0, 2.0, 4.0, 6.0, 7.0, 7.5])
    force = np.array([0.0, 20.0, 40.0, 60.0, 90.0, 300.0])  # coils close
    for x, y in ((travel, force), (travel[::-1], force[::-1])):
        fine, values = smooth(x, y)
        assert np.interp(x, np.sort(fine), values[np.argsort(fine)]) == pytest.approx(y)
        assert np.all(np.diff(values[np.argsort(fine)]) >= 0.0)
        assert fine[[0, -1]].tolist() == x[[0, -1]].tolist()


def test_a_kink_between_two_steps_is_drawn_where_their_lines_meet():
    """Open with 3 N/mm up to 8 mm, then 50 N/mm; in both directions, and without a line behind it a straight one."""
    travel = np.array([0.0, 2.0, 5.0, 9.0, 10.0])
    force = np.maximum(3.0 * travel, 24.0 + 50.0 * (travel - 8.0))
    for x, y in ((travel, force), (travel[::-1], force[::-1])):
        fine, values = smooth(x, y, [3 if x[0] == 0.0 else 2])
        assert values == pytest.approx(np.maximum(3.0 * fine, 24.0 + 50.0 * (fine - 8.0)))
        assert 8.0 in fine.round(9)
    assert smooth(travel[:4], force[:4], [3])[0].max() == 9.0


@pytest.mark.parametrize("travel", [[0.0, 1.0, 2.0], [0.0, 2.0, 1.0, 3.0]])
def test_few_steps_and_a_travel_that_turns_back_keep_their_lines(travel):
    assert smooth(travel, travel)[0].tolist() == travel


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
