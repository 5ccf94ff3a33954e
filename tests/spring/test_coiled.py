"""Springs made of coiled wire: they stand as drawn, without a force, and what coiling left counts in their set."""

import numpy as np
import pytest
from mpi4py import MPI

from coilset.meshes.errors import InputError
from coilset.model.analysis import Analysis
from coilset.model.case.case import check
from coilset.model.results.summary import summarise
from coilset.model.slice.analysis import SliceAnalysis

SPRING = {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 1.0, "pitch": 20.0, "made_by": "coiling"}
CASE = {
    "spring": SPRING, "material": "ck15", "ends": "clamped",
    "mesh": {"elements_per_turn": 8, "section": {"radial": 4, "angular": 12}},
    "loading": [{"to": {"travel": 6}, "steps": 3}, {"to": {"force": 0}, "steps": 2}],
}  # fmt: skip


def analysis_of(**changes):
    return Analysis(check(CASE | changes), MPI.COMM_SELF)


def test_a_coiled_spring_stands_as_drawn_and_is_as_stiff():
    """It bears no force at its drawn height, and starts elastically; Ck 15, hardened by coiling, sets less."""
    coiled, free = analysis_of(), analysis_of(spring={**SPRING, "made_by": None})
    scale = np.array([1.0, 1.0, 1.0, 2.5, 2.5, 2.5])
    area = np.pi * 2.5**2
    assert np.abs(coiled.rod.s.values / scale).max() < 1e-3 * area  # of 1 N/mm²
    assert np.abs(coiled.rod.surface_state[..., 0]).max() > 100.0
    results = [one.run() for one in (coiled, free)]
    summaries = [summarise(one.setup, run) for one, run in zip((coiled, free), results, strict=True)]
    assert summaries[0]["rate_N_per_mm"] == pytest.approx(summaries[1]["rate_N_per_mm"], rel=1e-9)
    assert 0.0 < summaries[0]["set_mm"] < 0.8 * summaries[1]["set_mm"]
    assert 36.0 < summaries[0]["coiling_diameter_mm"] < 40.0
    assert summaries[1]["coiling_diameter_mm"] is None


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"material": "elastic"}, "spring.made_by: 'coiling' needs a wire that yields and keeps its shape"),
        ({"mesh": {"section": {"kind": "warping"}}}, "spring.made_by: coiling needs sections of fibres"),
    ],
)
def test_what_cannot_be_coiled(changes, message):
    with pytest.raises(InputError) as caught:
        analysis_of(**changes)
    assert message in str(caught.value)


def test_a_slice_has_no_past():
    with pytest.raises(InputError, match="a slice begins free of stress"):
        SliceAnalysis(check(CASE))
