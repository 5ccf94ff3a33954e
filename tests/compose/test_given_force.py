"""Where the load program gives the maximum force, the height under it is the result."""

from types import SimpleNamespace

import pytest

from coilset.model.compose.run_warnings import allowed_force
from coilset.model.compose.setup import forces_given
from coilset.model.core.case import check
from coilset.model.core.results.records.record import Result, Setup, Step


def test_forces_of_the_load_program() -> None:
    """A force holds while time passes under it; a force that was reached at a height is not given."""
    spring = {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 2.5, "pitch": 12.0}
    hold = {"hold": {"hours": 1, "keep": "force"}}
    loading = [{"to": {"travel": 3}}, hold, {"to": {"force": 100}}, hold, {"hold": {"hours": 1}}, {"to": {"force": 0}}]
    case = check({"spring": spring, "material": "sh", "loading": loading})
    assert forces_given(case) == (False, False, True, True, False, True)


@pytest.mark.parametrize(("given", "allowed"), [(False, 2.0), (True, 8.0)])
def test_accuracy_of_a_given_force(given: bool, allowed: float) -> None:
    """On a wall of 200 N/mm, 0.2 % of a travel of 20 mm are 8 N, those of a force of 1,000 N are 2 N."""
    errors = {"steps_force_error_N": 0.2, "steps_height_error_mm": -1e-3}
    step = Step(1, 0, 1.0, 80.0, 20.0, 1000.0, 1, 1, 0, 0, 0, 0.0, **errors)
    setup = SimpleNamespace(forces_given=(given,), limits=SimpleNamespace(accuracy=2e-3), mean_diameter=40.0)
    setup.spring = SimpleNamespace(free_length=100.0, mean_diameter=40.0)
    setup.is_force_given = lambda step: Setup.is_force_given(setup, step)
    assert allowed_force(setup, Result(steps=(step,))) == pytest.approx(allowed)
