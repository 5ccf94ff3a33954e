"""Rates from a characteristic, against curves whose slope is known, and active turns of a spring that is released."""

import numpy as np
import pytest
from mpi4py import MPI

from coilset.model.case import read_case
from coilset.model.results.records.rates import finished, first_compression, makers_rate, rate_at
from coilset.model.results.records.record import Step
from coilset.model.results.records.summary import summarise
from coilset.model.run.analysis import Analysis

TRAVEL = np.linspace(0.0, 10.0, 21)


def step(number, travel, force, free_length=50.0):
    return Step(number, 0, 1.0, free_length - travel, travel, force, 1, 1, 0, 0, 0, 0.0)


def test_the_makers_rate_is_the_secant_from_30_to_70():
    force = 3.0 * TRAVEL + 0.5 * TRAVEL**2
    assert makers_rate(TRAVEL, force, 10.0) == pytest.approx((3 * 4 + 0.5 * (49 - 9)) / 4)
    assert makers_rate(TRAVEL, force, 15.0) is None


@pytest.mark.parametrize("at", [0.1, 4.2, 9.9])
def test_the_rate_at_a_travel_is_exact_for_a_parabola(at):
    assert rate_at(TRAVEL, 3.0 * TRAVEL + 0.5 * TRAVEL**2, at) == pytest.approx(3.0 + at, rel=1e-10)
    assert rate_at(TRAVEL, TRAVEL, 10.1) is None


def test_branches_of_a_characteristic():
    there = [step(k, travel, 2 * travel) for k, travel in enumerate((2.0, 4.0, 6.0))]
    back = [step(3 + k, travel, 3 * (travel - 2.0)) for k, travel in enumerate((4.0, 2.0))]
    assert first_compression([*there, *back])[0].tolist() == [0.0, 2.0, 4.0, 6.0]
    grown = [step(k, -0.1 * k, 0.0) for k in range(3)]  # by heat
    assert first_compression([*grown, *there, *back])[0].tolist() == [0.0, 2.0, 4.0, 6.0]
    travel, force = finished([*there, *back], 0, 48.0)
    assert travel.tolist() == [0.0, 2.0, 4.0]
    assert force.tolist() == [0.0, 6.0, 12.0]
    again = [Step(9, 1, 1.0, 48.0 - travel, 2.0 + travel, 2.5 * travel, 1, 1, 0, 0, 0, 0.0) for travel in (1.0, 3.0)]
    assert finished([*there, *back, *again], 0, 48.0)[1].tolist() == [0.0, 2.5, 7.5]


def test_steps_to_where_the_spring_is_end_no_branch():
    """As of phases to the same target; one in which the force has fallen at the same height is another branch."""
    there = [step(k, travel, 2 * travel) for k, travel in enumerate((2.0, 4.0, 4.0, 6.0))]
    back = [step(4 + k, travel, 3 * (travel - 2.0)) for k, travel in enumerate((4.0, 4.0, 2.0, 2.0 + 1e-12, 2.0))]
    assert first_compression([*there, *back])[0].tolist() == [0.0, 2.0, 4.0, 6.0]
    assert finished([*there, *back], 0, 48.0)[1].tolist() == [0.0, 6.0, 12.0]
    relaxed = [step(0, 2.0, 4.0), step(1, 2.0, 3.0), step(2, 4.0, 7.0)]
    assert first_compression(relaxed)[1].tolist() == [0.0, 4.0]
    assert first_compression([])[0].tolist() == [0.0]


@pytest.fixture(scope="module")
def pressed(example):
    loading = "loading=[{to: {travel: 13}, steps: 7}, {to: {force: 0}, steps: 5}, {to: {force: 100}, steps: 2}]"
    settings = ["mesh.elements_per_turn=8", "mesh.section.rule=abramowitz9", "rates_at=[1.0]", "accuracy=none", loading]
    analysis = Analysis(read_case(example, settings), MPI.COMM_SELF)
    analysis.run()
    return analysis


def test_active_turns_of_release_are_those_of_loading(pressed):
    """A spring that has set keeps a torque that goes with no force: counted with it there were more than all turns."""
    active = np.array([one.active_turns for one in pressed.result.seats])
    forces = np.array([one.force_N for one in pressed.result.steps])
    assert np.isnan(active[11])  # free of load
    assert active[7:11] == pytest.approx(active[0], rel=0.02)
    assert active[12:] == pytest.approx(active[0], rel=0.02)
    assert np.all(np.diff(forces[7:12]) < 0)


def test_the_rates_of_a_spring_that_sets(pressed):
    summary = summarise(pressed.setup, pressed.result)
    assert summary["rate_30_70_N_per_mm"] < 0.2 * summary["rate_N_per_mm"]  # it yields from a tenth of the travel on
    (asked,) = summary["rates"]
    assert asked["travel_mm"] == 1.0
    assert asked["rate_N_per_mm"] == pytest.approx(summary["rate_N_per_mm"], rel=0.1)


def test_free_length_and_set_are_those_after_the_last_release(pressed):
    """The spring is loaded again at the end; before, its set was not reported."""
    summary = summarise(pressed.setup, pressed.result)
    (release,) = summary["releases"]
    assert (release["phase"], release["step"]) == (2, 12)
    free = pressed.result.steps[11]
    assert (free.phase, free.force_N) == (1, pytest.approx(0.0, abs=1e-6))
    assert summary["free_length_after_mm"] == release["free_length_mm"]
    assert summary["set_mm"] == pytest.approx(pressed.spring.free_length - release["free_length_mm"], rel=1e-12)
    assert 0.0 < summary["set_mm"] < 13.0
    assert summary["residual_shear_inside_MPa"] < 0.0
    assert 1.0 <= summary["residual_shear_inside_turn"] <= 1.5  # a turn from the tips of 2.5


def test_each_release_has_its_free_length(example):
    loading = "loading=[{to: {travel: 10}, steps: 5}, {to: {force: 0}}, {to: {travel: 16}, steps: 5}, {to: {force: 0}}]"
    settings = ["mesh.elements_per_turn=8", "mesh.section.rule=abramowitz9", loading]
    analysis = Analysis(read_case(example, settings), MPI.COMM_SELF)
    analysis.run()
    summary = summarise(analysis.setup, analysis.result)
    lengths = [release["free_length_mm"] for release in summary["releases"]]
    assert len(lengths) == 2
    assert 35.0 > lengths[0] > lengths[1] == summary["free_length_after_mm"]
