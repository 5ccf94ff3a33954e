"""A stout, slender spring of ten turns whose pitch varies: its coils close one after the other, from one place on."""

import pytest

from coilset.model.core.case import check
from coilset.model.core.case.targets import closing_force
from coilset.verification.random_springs.press_one import press

SHEAR_MODULUS = 80769.0  # MPa


def test_coils_that_close_one_after_the_other_reach_block():
    """With warping sections of 8 × 20 points it took more than 150 s; here they are curved, with few points."""
    pitch = {"turns": [0.0, 4.99, 9.98], "values": [11.492, 16.418, 13.682], "interpolation": "monotone"}
    data = {
        "spring": {"wire_diameter": 5.33, "mean_diameter": 27.785, "turns": 9.98, "pitch": pitch},
        "mesh": {"elements_per_turn": 6, "section": {"radial": 2, "angular": 8}},
        "accuracy": "none",
        "loading": [{"to": "block", "steps": 12}],
    }
    spring = check(data).spring.build()
    found = press(data, 300.0)
    assert found["end"] == "complete"
    assert found["length_mm"] == pytest.approx(spring.block_height, rel=1e-9)
    assert found["force_N"] < closing_force(spring, SHEAR_MODULUS)
    assert found["evaluations"] < 4000
