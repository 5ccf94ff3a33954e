"""The force where the coils close, before the vertical of a compression to block."""

from types import SimpleNamespace

import pytest

from coilset.model.core.results.quantities import quantities
from coilset.model.core.results.records.closing import (
    before_vertical,
    closing,
    closing_entries,
    stands_on_wall,
    steepness,
)
from coilset.model.core.results.records.record import Step


def stepped(*ways):
    """Steps of phases: each way has a height, mm, and a force, N, for each step; the free length is 50 mm."""
    found, number = [], 0
    for phase, way in enumerate(ways):
        for k, (height, force) in enumerate(way, 1):
            number += 1
            found.append(Step(number, phase, k / len(way), height, 50.0 - height, force, 1, 1, 0, 0, 0, 0.0))
    return found


WALL = [(40.0, 100.0), (31.0, 200.0), (30.05, 230.0), (30.0, 900.0)]
SOFT = [(40.0, 100.0), (31.0, 200.0), (30.0, 230.0)]
BACK = [(40.0, 80.0), (48.0, 0.0)]


def to(*phases):
    return SimpleNamespace(phases=phases, spring=SimpleNamespace(block_height=30.0))


def test_the_last_step_before_the_vertical_is_where_coils_close():
    """From 30.05 mm on 670 N in 0.05 mm: by 1 % of the travel 298 % of the force; to there 33 % by 1 %."""
    steps, setup = stepped(WALL, BACK), to("block", "force 0 N")
    travels, forces = [step.travel_mm for step in steps], [step.force_N for step in steps]
    assert steepness(travels, forces, 3) == pytest.approx(670.0 / 0.05 * 20.0 / 900.0)
    assert closing(setup, steps).force_N == 230.0
    assert closing_entries(setup, steps)["closing_height_mm"] == 30.05
    assert stands_on_wall(setup, steps)


@pytest.mark.parametrize(
    ("steps", "phases"),
    [
        (stepped(SOFT, BACK), ("block", "force 0 N")),  # no vertical
        (stepped(WALL[:3], BACK), ("height 30.05 mm", "force 0 N")),  # above block
        (stepped(WALL[:3], BACK)[:2], ("block", "force 0 N")),  # ended before block
        ([], ()),
    ],
)
def test_without_a_vertical_to_block_there_is_none(steps, phases):
    assert closing(to(*phases), steps) is None
    assert not stands_on_wall(to(*phases), steps)


def test_steps_too_long_to_show_the_vertical_have_its_error():
    """A nest in 12 steps of 8 mm: from 35 to 80 kN ± 90 % in the last one, which is a slope of 7 % by 1 %."""
    forces = [33e3, 80e3]
    assert before_vertical([90.0, 98.0], forces, [200.0, 70e3]) == 0
    assert before_vertical([90.0, 98.0], forces, [200.0, 1e3]) is None
    assert before_vertical([90.0, 98.0], forces, [None, None]) is None


def test_of_several_compressions_the_last_one_counts():
    again = [(height, 0.9 * force) for height, force in WALL]
    assert closing(to("block", "force 0 N", "block"), stepped(WALL, BACK, again)).force_N == pytest.approx(207.0)


def test_the_force_behind_the_closing_is_not_printed():
    summary = {"force_max_N": 900.0, "free_length_before_mm": 50.0, "block_height_mm": 30.0}
    closed = {"closing_force_N": 230.0, "closing_height_mm": 30.05, "estimated_closing_force_error_N": 2.0}
    assert {one.words for one in quantities(summary)} >= {"maximum force"}
    found = {one.words: one for one in quantities(summary | closed)}
    assert "maximum force" not in found
    assert found["force where the coils close"].text == "230 ± 2 N"
    assert found["force where the coils close"].remark.startswith("at 30.05 mm")
