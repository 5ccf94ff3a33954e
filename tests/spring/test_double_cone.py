"""A stiff double cone whose flanks pass each other's coils is pressed to block, with friction and in grooves."""

import pytest

from coilset.model.core.case import check
from coilset.model.core.case.targets import closing_force
from coilset.verification.random_springs.press_one import press


def test_block_is_reached_at_a_finite_force():
    """Its block height by the slope of the radius was 0.6 wires too low: 1.8e6 N, and no equilibrium after 34 s."""
    shape = {"shape": "double cone", "ends": 100.12, "middle": 160.423}
    data = {
        "spring": {"wire_diameter": 12.923, "mean_diameter": shape, "turns": 4.74, "pitch": 41.166, "hand": "left"},
        "material": "voce",
        "seats": {"hold": "groove"},
        "contact": {"friction": {"seats": 0.1, "coils": 0.1}},
        "mesh": {"section": {"radial": 3, "angular": 12}},
        "accuracy": "1 %",
        "loading": [{"to": "block"}],
    }
    spring = check(data).spring.build()
    found = press(data, 300.0)
    assert found["end"] == "complete"
    assert found["length_mm"] == pytest.approx(spring.block_height, rel=1e-9)
    assert spring.block_height > 2.0 * 12.923
    assert found["force_N"] < closing_force(spring, 80769.0)
