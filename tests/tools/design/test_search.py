"""Searches on small springs: what was found is solved anew from its file, and meets the conditions."""

import numpy as np
import pytest
import yaml
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.summary import summarise
from coilset.model.core.base.errors import InputError
from coilset.model.core.case import read_case
from coilset.model.tools.design.design import find, make_search
from coilset.model.tools.design.file import read_design_file
from coilset.model.tools.design.output import found_data

CLOSE = 1e-6  # of the target
SPRING = {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 4.5, "pitch": 12.0}


def solved(tmp_path, search, found):
    """Summary and last forces of phases, of the case that was found, read from a file."""
    path = tmp_path / "found.yaml"
    path.write_text(yaml.safe_dump(found_data(found)), encoding="utf-8")
    analysis = Analysis(read_case(path), MPI.COMM_SELF)
    steps = analysis.run().steps
    return summarise(analysis.setup, analysis.result), {step.phase: step.force_N for step in steps}


def test_one_unknown(search, tmp_path):
    one = search({"loading.0.to.height": [18, 34]}, {"free_length_after_mm": 25.0})
    found = find(one)
    assert found.met
    assert one.evaluator.count <= 5
    assert solved(tmp_path, one, found)[0]["free_length_after_mm"] == pytest.approx(25.0, rel=CLOSE)


def test_two_unknowns_a_length_and_a_force(search, tmp_path):
    one = search(
        {"loading.0.to.height": [18, 24], "spring.wire_diameter": [4, 5.5]},
        {"free_length_after_mm": 25.0, "force_at": {"height": 21.0, "N": 160.0}},
    )
    found = find(one)
    assert one.evaluator.count <= 8
    summary, forces = solved(tmp_path, one, found)
    assert summary["free_length_after_mm"] == pytest.approx(25.0, rel=CLOSE)
    assert forces[2] == pytest.approx(160.0, rel=CLOSE)


def test_a_condition_that_the_uniform_rod_does_not_know(search, tmp_path):
    one = search({"loading.0.to.height": [18, 30]}, {"residual_shear_inside_MPa": -50.0})
    summary, _ = solved(tmp_path, one, find(one))
    assert summary["residual_shear_inside_MPa"] == pytest.approx(-50.0, rel=CLOSE)


def test_a_target_of_zero_is_met_absolutely(search):
    """The force line of an elastic spring comes to the axis, to 1e-5 mm; the slopes are in mm per mm."""
    entries = {
        "spring": SPRING,
        "material": "elastic",
        "ends": "clamped",
        "accuracy": "none",
        "loading": [{"to": {"travel": 5.0, "top": {"sideways": [1.0, 0.0]}}, "steps": 1}],
        "working": {"lengths": [54.0]},
        "force_line": {"upper": 59.0},
    }
    one = search({"loading.0.to.top.sideways.0": [-9.0, 9.0]}, {"working": {"line_upper_x_at_54_mm": 0.0}}, **entries)
    found = find(one)
    assert found.met
    (value,) = found.best.values
    assert abs(value) <= 1e-5
    (condition,) = one.conditions
    assert condition.off(0.5) == pytest.approx(0.005)
    assert condition.deviation(0.005) == "0.5 mm"


def test_more_conditions_than_unknowns_are_met_as_well_as_they_can_be(search):
    """At the least sum of squares both residuals' changes cancel: the slopes are at right angles to them."""
    one = search(
        {"loading.0.to.height": [18, 24]}, {"free_length_after_mm": 25.0, "force_at": {"height": 21.0, "N": 150.0}}
    )
    found = find(one)
    assert not found.met
    assert np.abs(found.off).max() > 0.01
    step = 1e-3 * one.width
    squares = [
        np.sum(one.off(one.evaluator.run(x, one.plan).values) ** 2) for x in (found.x - step, found.x, found.x + step)
    ]
    assert squares[1] < min(squares[0], squares[2])


def test_an_evaluation_that_is_known_is_not_run(design_file):
    read = read_design_file(design_file({"loading.0.to.height": [18, 34]}, {"free_length_after_mm": 25.0}))
    records = []
    first = find(one := make_search(read, keep=records.append))
    assert (one.evaluator.solves, len(records)) == (one.evaluator.count, one.evaluator.count)
    again = make_search(read, {record["key"]: record for record in records})
    assert find(again).x == pytest.approx(first.x, rel=1e-15)
    assert (again.evaluator.solves, again.evaluator.count) == (0, one.evaluator.count)
    part = make_search(read, {record["key"]: record for record in records[:2]})
    assert find(part).x == pytest.approx(first.x, rel=1e-12)
    assert part.evaluator.solves == one.evaluator.count - 2


def test_a_target_out_of_reach_is_refused_with_the_range(search):
    one = search({"loading.0.to.height": [22, 26]}, {"free_length_after_mm": 33.0})
    with pytest.raises(
        InputError, match=r"33 mm is out of reach: between the bounds it goes from about 26\.\d+ to 30\.2\d+ mm"
    ):
        find(one)


def test_a_target_out_of_reach_where_presetting_does_nothing_has_its_range_too(search):
    """The nearest springs to one of 40 mm do not yield: they keep the 35 mm that they are wound to."""
    one = search({"loading.0.to.height": [18, 34]}, {"free_length_after_mm": 40.0})
    with pytest.raises(InputError, match=r"40 mm is out of reach: .* from about 2\d\.\d+ to 35 mm, the maximum with"):
        find(one)


def test_past_the_fully_plastic_torque_winding_makes_no_longer_spring(search):
    one = search(
        {"spring.pitch": [11, 16]}, {"free_length_after_mm": 24.0}, loading=[{"to": "block"}, {"to": {"force": 0}}]
    )
    with pytest.raises(InputError, match="beyond that no longer winding makes a longer spring"):
        find(one)


def test_an_unknown_that_nothing_feels_is_named(search):
    one = search({"rates_at.0": [1, 2]}, {"free_length_after_mm": 25.0}, rates_at=[1.0])
    with pytest.raises(InputError, match=r"find\.rates_at\.0: no condition depends on it"):
        find(one)


def test_springs_that_cannot_be_are_refused(search):
    one = search({"spring.wire_diameter": [11, 12]}, {"free_length_after_mm": 25.0})
    with pytest.raises(InputError, match="no spring can be run between these bounds"):
        find(one)
