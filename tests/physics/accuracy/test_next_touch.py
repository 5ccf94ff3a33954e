"""Automatic steps where coils first touch: they end just before it, without a cut, and the step across it is short."""

import numpy as np
import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.core.case import read_case
from coilset.model.physics.accuracy.next_touch import CROSSING

COARSE = ["mesh.elements_per_turn=12", "mesh.section.radial=3", "mesh.section.angular=8"]


def pressed(example, *settings):
    """Steps of the example to 15.3 mm, beyond the first touch of its coils at 15.0 mm, and their regular length."""
    loading = "loading=[{to: {travel: 15.3}}]"
    analysis = Analysis(read_case(example, [*COARSE, loading, *settings]), MPI.COMM_WORLD, estimates=False)
    return analysis.run().steps, 15.3 / analysis.case.solver.control.steps.automatic


def test_a_step_ends_at_the_first_touch_and_none_before_is_cut(example):
    """60 evaluations; 186 with four cuts where steps went on into the touch."""
    steps, regular = pressed(example)
    touch = next(number for number, step in enumerate(steps) if step.contacts > 2)
    lengths = np.diff([0.0, *(step.travel_mm for step in steps)]) / regular
    assert lengths[touch] == pytest.approx(CROSSING, rel=1e-6)
    assert lengths[touch - 1] < 0.05 < 0.5 < lengths[touch - 2]
    assert not any(step.cuts for step in steps[: touch + 1])
    assert sum(step.evaluations for step in steps) < 75


def test_elastic_wire_takes_no_steps_to_a_touch(example):
    steps, regular = pressed(example, "material=elastic")
    lengths = np.diff([0.0, *(step.travel_mm for step in steps)]) / regular
    assert lengths[:-1].min() >= 1.0 - 1e-9


def test_flat_faces_that_yield_end_a_step_at_their_first_touch(example):
    """Faces need the guess's rotations, too."""
    square = "{wire: {rectangle: {width: 5, height: 5}}, mean_diameter: 40, turns: 2.5, pitch: 12}"
    steps, regular = pressed(example, f"spring={square}", "mesh.section.radial=3", "mesh.section.angular=12")
    touch = next(number for number, step in enumerate(steps) if step.contacts > 2)
    lengths = np.diff([0.0, *(step.travel_mm for step in steps)]) / regular
    assert lengths[touch] == pytest.approx(CROSSING, rel=1e-6)
    assert not any(step.cuts for step in steps[: touch + 1])
