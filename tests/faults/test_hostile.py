"""Each attempt of hostile.py is held, soon."""

import time

import pytest
from hostile import HOSTILE, attack, made, put

SLOWEST = 20.0  # seconds of the processor


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    return made(tmp_path_factory.mktemp("results"))


def test_there_are_enough():
    assert len(HOSTILE) >= 50
    assert len({(attempt.mouth, attempt.what) for attempt in HOSTILE}) == len(HOSTILE)


@pytest.mark.parametrize("attempt", HOSTILE, ids=lambda attempt: f"{attempt.mouth}: {attempt.what}")
def test_it_is_held(attempt, results, tmp_path):
    put(attempt, tmp_path, results)
    began = time.process_time()
    attack(attempt, tmp_path)
    assert time.process_time() - began < SLOWEST
