"""Step control: cutting, growing, stations hit exactly, and what cannot be reached."""

import logging

import numpy as np
import pytest
from mpi4py import MPI

from coilset.model.analysis import Analysis
from coilset.model.case import read_case
from coilset.model.errors import SolveError

COARSE = ["mesh.elements_per_turn=10", "mesh.section.rule=abramowitz9"]


@pytest.fixture
def make(example):
    """The example on a coarse mesh with another load program."""

    def make(loading, *settings):
        return Analysis(read_case(example, [*COARSE, f"loading={loading}", *settings]), MPI.COMM_SELF)

    return make


def test_a_step_twenty_times_too_large_is_survived(make, caplog):
    """From first touch to block in one step, where twenty need no cut: found at once, or with five iterations by cuts.

    One increment of backward Euler over 6 % of strain misses the force at block by 10 %: its size alone is tested.
    """
    caplog.set_level(logging.INFO, logger="coilset.steps")
    fine = make("[{to: block, steps: 20}]").run().steps
    assert len(fine) == 20
    for options in ([], ["solver.options.snes_max_it=5"]):
        caplog.clear()
        large = make("[{to: block, steps: 1}]", *options).run().steps
        assert len(large) < 20
        assert large[-1].seat_height_mm == fine[-1].seat_height_mm == 17.5
        assert large[-1].force_N == pytest.approx(fine[-1].force_N, rel=0.15)
        cuts = sum("cut to" in record.message for record in caplog.records)
        assert cuts == sum(step.cuts for step in large)
        assert (cuts > 0) == bool(options)


def test_automatic_steps_grow_on_ease_and_hit_their_stations(make):
    program = "[{to: {travel: 5}, steps: auto}, {to: {force: 100}, steps: auto}, {to: {force: 0}, steps: auto}]"
    steps = make(program).run().steps
    ends = [[step for step in steps if step.phase == phase][-1] for phase in range(3)]
    assert ends[0].travel_mm == pytest.approx(5.0, abs=1e-12)
    assert ends[1].force_N == pytest.approx(100.0, rel=1e-12)
    assert ends[2].force_N == pytest.approx(0.0, abs=1e-8)
    travels = np.diff([0.0] + [step.travel_mm for step in steps if step.phase == 0])
    assert travels[:-1].max() > 1.4 * travels[0]


@pytest.mark.parametrize("program", ["[{to: {height: 3}, steps: 4}]", "[{to: {force: 1e6}, steps: 4}]"])
def test_an_impossible_target_is_given_up_with_all_that_was_reached(make, program):
    """Wires of 5 mm cannot be pressed to 3 mm, nor bear 1 MN: the coils would lie in each other."""
    analysis = make(program)
    with pytest.raises(SolveError, match="no equilibrium beyond") as caught:
        analysis.run()
    assert caught.value.exit_code == 3
    assert "\n" not in str(caught.value)
    result = analysis.result
    assert result.steps
    assert not result.complete
    assert result.snapshots[-1].height == result.steps[-1].seat_height_mm > 5.0
    assert analysis.system.max_penetration <= 0.1  # 0.02 wire diameters
