"""Coils that lie on each other rise by a wire's diameter; coils that have slipped past each other by less."""

import numpy as np
import pytest

from coilset.meshes.springs.spring import SpringSpec
from coilset.model.compose.shape import LeastRise

TURNS = np.linspace(0.0, 4.0, 65)


def helix(pitch):
    angle = 2 * np.pi * TURNS
    return np.stack([20 * np.cos(angle), 20 * np.sin(angle), pitch * TURNS], axis=1)


def spring(diameter=40.0):
    return SpringSpec(wire_diameter=5.0, mean_diameter=diameter, turns=4.0, pitch=12.0).build()


@pytest.mark.parametrize("pitch", [5.0, 2.5, -1.0])
def test_the_rise_is_counted_in_wires(pitch):
    assert LeastRise(TURNS, spring()).of(helix(pitch)) == pytest.approx(pitch / 5.0, rel=1e-12)


def test_coils_of_a_flat_cone_pass_each_other_by_their_shape():
    cone = {"shape": "cone", "bottom": 100.0, "top": 50.0}
    entries = {"wire_diameter": 5.0, "mean_diameter": cone, "turns": 4.0, "pitch": 12.0}
    assert LeastRise(TURNS, SpringSpec.model_validate(entries).build()).of(helix(1.0)) is None
