"""What compares killed runs sees what differs, and some are killed; more by kills.py and in test_resume.py."""

import random

import numpy as np
import pytest
from kills import differing, tried

FOUND = {
    "state_x": np.array([1.0, 100.0]),
    "set_mm": 13.28,
    "iterations": 400,
    "complete": True,
    "block_height_mm": None,
    "history.csv iterations": np.array([9.0, 11.0]),
    "history.csv force_N": np.array([10.0, np.nan]),
}


@pytest.mark.parametrize(
    ("name", "value", "to_the_bit", "nearly"),
    [
        ("state_x", np.array([1.0 + 1e-15, 100.0]), True, False),
        ("state_x", np.array([1.0 + 1e-6, 100.0]), True, True),
        ("state_x", np.array([1.0]), True, True),
        ("set_mm", 13.28 + 1e-12, True, False),
        ("set_mm", 13.28 + 1e-6, True, True),
        ("iterations", 401, True, False),
        ("history.csv iterations", np.array([9.0, 12.0]), True, False),
        ("history.csv force_N", np.array([10.0, 0.0]), True, True),
        ("complete", False, True, True),
        ("block_height_mm", 17.5, True, True),
        ("new", 1, True, True),
    ],
)
def test_differences_are_seen(name, value, to_the_bit, nearly):
    now = {**FOUND, name: value}
    assert differing(FOUND, now, True) == ({name} if to_the_bit else set())
    assert differing(FOUND, now, False) == ({name} if nearly else set())
    assert differing(now, dict(now), True) == set()


@pytest.mark.parametrize("name", ["finer run", "nest", "page"])
def test_a_killed_command_goes_on_as_if_undisturbed(name, tmp_path):
    random.seed(name)
    outcome = tried(name, 1, tmp_path, compared=False)
    assert outcome.kills == 1
    assert not outcome.unlike
    assert not outcome.left
