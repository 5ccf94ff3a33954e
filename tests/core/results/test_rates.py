"""Rates from a characteristic, against curves whose slope is known."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.summary import summarise
from coilset.model.core.base.between_steps import Between
from coilset.model.core.case import read_case
from coilset.model.core.results.records.rates import finished, first_compression, makers_rate, tension
from coilset.model.core.results.records.record import Step

TRAVEL = np.linspace(0.0, 10.0, 21)


def step(number, travel, force, free_length=50.0):
    return Step(number, 0, 1.0, free_length - travel, travel, force, 1, 1, 0, 0, 0, 0.0)


def test_the_makers_rate_is_the_secant_from_30_to_70():
    force = 3.0 * TRAVEL + 0.5 * TRAVEL**2
    curve = Between.through(TRAVEL, force)
    assert makers_rate(curve, 10.0) == pytest.approx((3 * 4 + 0.5 * (49 - 9)) / 4)
    assert makers_rate(curve, 15.0) is None


def test_the_rate_is_that_of_open_coils_where_a_step_closes_them():
    """Open up to 8 mm with 3 N/mm, then 50 N/mm, in steps of which one leads from 5 to 9 mm."""
    travel = np.array([0.0, 2.0, 5.0, 9.0, 10.0])
    curve = Between(travel, np.maximum(3.0 * travel, 24.0 + 50.0 * (travel - 8.0)), np.array([2, 2, 2, 6, 8]))
    assert makers_rate(curve, 10.0) == pytest.approx(3.0)
    assert [curve.at(travel)[0] for travel in (1.0, 8.5, 9.5)] == pytest.approx([3.0, 49.0, 99.0])


WOUND = SimpleNamespace(initial_tension=25.2)


def pulled(number, travel, phase=0, held=25.0, free=0.0):
    """Coils that give way by 27 N/mm from where the spring is free, behind F0 by 3 N/mm, which bends a little."""
    opens = free + held / 27.0
    way = travel - opens
    force = held + 3.0 * way + 2e-4 * way**2 if way > 0.0 else 27.0 * (travel - free)
    contacts = 0 if way > 0.0 else 432
    one = Step(number, phase, 1.0, 50.0 + travel, -travel, -force, 1, 1, 0, 0, contacts, 0.0)
    return replace(one, estimated_force_error_N=0.001)


@pytest.mark.parametrize("first", [(0.5,), ()])
def test_the_initial_tension_needs_no_step_in_which_coils_touch(first):
    """With a step on the way to F0, and without; two open steps show it, but not its error."""
    steps = [pulled(number, travel, 0) for number, travel in enumerate((*first, 10.0, 20.0), 1)]
    found = tension(WOUND, SimpleNamespace(steps=steps, rate=27.0), None)
    assert found["initial_tension_N"] == pytest.approx(25.0, abs=0.05)
    assert found["initial_tension_given_N"] == 25.2
    assert found["open_rate_N_per_mm"] == pytest.approx(3.0, rel=0.01)
    assert found["estimated_initial_tension_error_N"] is None


@pytest.mark.parametrize("number", [3, 4, 8, 20, 100])
def test_the_initial_tension_hardly_depends_on_the_steps(number):
    """Nor on the step at whose end the spring is free of load, its coils closed; it is within its error."""
    there = [pulled(k, 100.0 * k / number) for k in range(1, number + 1)]
    ways = (80.0, 50.0, 30.0, 10.0)
    back = [pulled(number + k, way, 1, 14.0, 0.2) for k, way in enumerate(ways, 1)]
    last = Step(number + 5, 1, 1.0, 50.2, -0.2, -1e-9, 1, 1, 0, 0, 432, 0.0)
    steps = [*there, *back, last]
    release = SimpleNamespace(step=last, phase=1)
    found = tension(WOUND, SimpleNamespace(steps=steps, rate=27.0), release)
    for name, held in (("", 25.0), ("_after", 14.0)):
        error = found[f"estimated_initial_tension{name}_error_N"]
        assert 0.001 <= error < 0.6
        assert abs(found[f"initial_tension{name}_N"] - held) <= error
    opened = tension(WOUND, SimpleNamespace(steps=steps, rate=27.0), SimpleNamespace(step=replace(last, contacts=0)))
    assert opened["initial_tension_after_N"] == 0.0


def test_an_initial_tension_that_steps_do_not_show_is_none():
    for travels in ((100.0,), (0.2, 0.4)):
        steps = [pulled(k, travel) for k, travel in enumerate(travels, 1)]
        found = tension(WOUND, SimpleNamespace(steps=steps, rate=27.0), None)
        assert found.pop("initial_tension_given_N") == 25.2
        assert set(found.values()) == {None}


@pytest.mark.parametrize("at", [0.1, 4.2, 9.9])
def test_the_rate_at_a_travel_is_exact_for_a_parabola(at):
    assert Between.through(TRAVEL, 3.0 * TRAVEL + 0.5 * TRAVEL**2).at(at)[1] == pytest.approx(3.0 + at, rel=1e-10)


def test_branches_of_a_characteristic():
    there = [step(k, travel, 2 * travel) for k, travel in enumerate((2.0, 4.0, 6.0))]
    back = [step(3 + k, travel, 3 * (travel - 2.0)) for k, travel in enumerate((4.0, 2.0))]
    assert first_compression([*there, *back]).travel.tolist() == [0.0, 2.0, 4.0, 6.0]
    grown = [step(k, -0.1 * k, 0.0) for k in range(3)]  # by heat
    assert first_compression([*grown, *there, *back]).travel.tolist() == [0.0, 2.0, 4.0, 6.0]
    curve = finished([*there, *back], 0, 48.0)
    assert curve.travel.tolist() == [0.0, 2.0, 4.0]
    assert curve.force.tolist() == [0.0, 6.0, 12.0]
    again = [Step(9, 1, 1.0, 48.0 - travel, 2.0 + travel, 2.5 * travel, 1, 1, 0, 0, 0, 0.0) for travel in (1.0, 3.0)]
    assert finished([*there, *back, *again], 0, 48.0).force.tolist() == [0.0, 2.5, 7.5]


def test_steps_to_where_the_spring_is_end_no_branch():
    """As of phases to the same target; one in which the force has fallen at the same height is another branch."""
    there = [step(k, travel, 2 * travel) for k, travel in enumerate((2.0, 4.0, 4.0, 6.0))]
    back = [step(4 + k, travel, 3 * (travel - 2.0)) for k, travel in enumerate((4.0, 4.0, 2.0, 2.0 + 1e-12, 2.0))]
    assert first_compression([*there, *back]).travel.tolist() == [0.0, 2.0, 4.0, 6.0]
    assert finished([*there, *back], 0, 48.0).force.tolist() == [0.0, 6.0, 12.0]
    relaxed = [step(0, 2.0, 4.0), step(1, 2.0, 3.0), step(2, 4.0, 7.0)]
    assert first_compression(relaxed).force.tolist() == [0.0, 4.0]
    assert first_compression([]).travel.tolist() == [0.0]


@pytest.fixture(scope="module")
def pressed(example):
    loading = "loading=[{to: {travel: 13}, steps: 7}, {to: {force: 0}, steps: 5}, {to: {force: 100}, steps: 2}]"
    settings = ["mesh.elements_per_turn=8", "mesh.section.rule=abramowitz9", "rates_at=[1.0]", "accuracy=none", loading]
    analysis = Analysis(read_case(example, settings), MPI.COMM_SELF)
    analysis.run()
    return analysis


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
