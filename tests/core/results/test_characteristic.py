"""The characteristic between steps against the curve that its steps are of."""

import numpy as np
import pytest

from coilset.model.core.base.errors import InputError
from coilset.model.core.results.characteristic import ERROR, Run, place_at

PRESSED = np.array([1.0, 2.5, 4.0, 6.0, 8.0, 10.0])
FREED = np.array([9.5, 8.5, 7.0, 5.5])


def load(travel):
    return 100.0 * (1.0 - np.exp(-0.3 * travel))


def unload(travel):
    return load(10.0) - 30.0 * (10.0 - travel)


@pytest.fixture
def run():
    columns = {
        "phase": np.repeat([0, 1], [len(PRESSED), len(FREED)]),
        "travel_mm": np.append(PRESSED, FREED),
        "force_N": np.append(load(PRESSED), unload(FREED)),
        ERROR: np.full(len(PRESSED) + len(FREED), 0.25),
    }
    return Run({name: ("step", values) for name, values in columns.items()})


@pytest.mark.parametrize("travel", [0.5, 1.7, 3.2, 5.0, 9.1])
def test_force_and_rate_between_steps(run, travel):
    """The cubic is nearer to the curve than the chord is, and than its error says."""
    off = abs(run.force_at(travel) - load(travel))
    steps = np.append(0.0, PRESSED)
    assert off < 0.5 * abs(np.interp(travel, steps, load(steps)) - load(travel))
    assert off < run.force_error_at(travel)
    assert run.rate_at(travel) == pytest.approx(30.0 * np.exp(-0.3 * travel), rel=0.15)


def test_at_a_step_it_is_the_steps_force_with_its_error(run):
    assert run.force_at(4.0) == pytest.approx(load(4.0), rel=1e-14)
    assert run.force_error_at(4.0) == pytest.approx(0.25, rel=1e-12)


def test_a_release_has_its_own_branch(run):
    assert run.force_at(8.0, phase=1) == pytest.approx(unload(8.0), rel=1e-12)
    assert run.rate_at(8.0, phase=1) == pytest.approx(30.0, rel=1e-12)
    assert run.force_at(8.0) == pytest.approx(load(8.0), rel=1e-12)


def test_where_coils_close_it_does_not_overshoot():
    travel, force = np.array([2.0, 4.0, 6.0, 7.0, 7.5]), np.array([20.0, 40.0, 60.0, 90.0, 300.0])
    data = Run({"phase": ("step", np.zeros(5, int)), "travel_mm": ("step", travel), "force_N": ("step", force)})
    found = np.array([place_at(data, at).force for at in np.linspace(0.0, 7.5, 151)])
    assert np.all(np.diff(found) > 0.0)
    assert np.isnan(data.force_error_at(3.0))


def test_a_travel_that_is_not_reached_is_refused(run):
    with pytest.raises(InputError, match="12 mm is reached in no phase"):
        run.force_at(12.0)
    with pytest.raises(InputError, match=r"not in loading\.1"):
        run.force_at(2.0, phase=1)
