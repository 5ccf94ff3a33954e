"""Ctrl-C during a callback of PETSc ends a command like any other, not with PETSc's error."""

import pytest

from coilset.model.compose.analysis import Analysis
from coilset.model.core.case import read_case
from coilset.model.physics.slice.analysis import SliceAnalysis

SHORT = ["loading=[{to: {travel: 1}, steps: 1}]", "ends=clamped", "mesh.elements_per_turn=8"]


def interrupt(*_args, **_kwargs):
    raise KeyboardInterrupt


@pytest.mark.parametrize("place", ["residual", "search"])
def test_an_interrupted_callback_of_the_rod_ends_as_interrupted(example, monkeypatch, place):
    analysis = Analysis(read_case(example, SHORT))
    owner = analysis.system if place == "residual" else analysis.newton.iteration
    monkeypatch.setattr(owner, place, interrupt)
    with pytest.raises(KeyboardInterrupt):
        analysis.run()


def test_an_interrupted_callback_of_the_slice_ends_as_interrupted(example, monkeypatch):
    analysis = SliceAnalysis(read_case(example, SHORT), across=3.0)
    monkeypatch.setattr(analysis.problem.system, "residual", interrupt)
    with pytest.raises(KeyboardInterrupt):
        analysis.run()
