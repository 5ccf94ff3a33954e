"""The summary's entries: names, units and what derives from them; the releases of a load program."""

from dataclasses import fields, replace

import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.summary import summarise, summary
from coilset.model.core.case import read_case
from coilset.model.core.results.records.releases import releases
from coilset.model.core.results.records.summary_entries import NUMBERS, UNSEEN, Summary
from coilset.model.core.results.records.units import unit_of

COARSE = ["mesh.elements_per_turn=8", "mesh.section.rule=abramowitz9"]


@pytest.fixture(scope="module")
def twice(example):
    """Released after 10 mm and after 13 mm, and pressed again at the end."""
    loading = (
        "loading=[{to: {travel: 10}, steps: 5}, {to: {force: 0}, steps: 4}, {to: {travel: 16.5}, steps: 6}, "
        "{to: {force: 0}, steps: 4}, {to: {force: 100}, steps: 2}]"
    )
    analysis = Analysis(read_case(example, [*COARSE, "accuracy=none", loading]), MPI.COMM_SELF)
    analysis.run()
    return analysis


def test_names_end_with_their_units():
    counts = {"", "turns"}
    for item in fields(Summary):
        unit = item.metadata["unit"]
        assert unit_of(item.name) == ("1" if unit in counts else unit), item.name
    assert "set_mm" in NUMBERS
    assert not {"material", "buckled", "complete", "rates", "warnings"} & set(NUMBERS)
    assert "buckled" in UNSEEN
    assert "set_mm" not in UNSEEN


def test_a_spring_under_load_keeps_the_set_of_its_last_release(twice):
    """It was None, as if the spring had never been released."""
    found = summary(twice.setup, twice.result)
    assert [one["phase"] for one in found.releases] == [2, 4]
    first, last = found.releases
    assert 0.0 < first["set_mm"] < last["set_mm"] == found.set_mm
    assert found.free_length_after_mm == last["free_length_mm"]
    assert found.rate_30_70_after_N_per_mm > 0.8 * found.rate_N_per_mm  # elastic
    assert found.residual_shear_max_MPa > 0.0
    assert 0.0 < found.residual_shear_inside_turn < twice.spring.turns


def test_the_same_release_gives_the_same_numbers_whatever_follows(twice):
    """Without the last phase, and without anything after the first release."""
    result = twice.result
    for phases, number in ((4, 1), (2, 0)):
        steps = tuple(step for step in result.steps if step.phase < phases)
        part = replace(result, steps=steps, snapshots=result.snapshots[: phases + 1])
        assert summarise(twice.setup, part)["set_mm"] == summarise(twice.setup, result)["releases"][number]["set_mm"]


def test_a_spring_that_was_never_released_has_no_set(twice):
    part = replace(twice.result, steps=twice.result.steps[:5], snapshots=twice.result.snapshots[:2])
    assert releases(twice.setup, part) == []
    found = summarise(twice.setup, part)
    assert found["set_mm"] is found["residual_shear_max_MPa"] is found["rate_30_70_after_N_per_mm"] is None
