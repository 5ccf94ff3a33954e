"""What a run will take is said before it begins; what no machine could hold is refused."""

import pytest

from coilset.model.compose import build
from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.errors import InputError
from coilset.model.core.case import read_case
from coilset.model.physics.accuracy import effort
from coilset.model.physics.accuracy.effort import Effort, machine_memory


def test_the_estimate_is_that_of_the_measured_table():
    """docs/scaling.md: 100,000 elements with 96 points, 10 iterations of one step: 25 s and 2.6 GiB.

    400,000 without the error of the steps: 7.4 GiB.
    """
    effort = Effort.of(100_000, 96, 1)
    assert effort.seconds == pytest.approx(25.0 * 6 / 10, rel=0.1)
    assert effort.memory == pytest.approx(2.6 * 2**30, rel=0.1)
    assert Effort.of(400_000, 96, 1, estimated=False).memory == pytest.approx(7.4 * 2**30, rel=0.1)


def test_more_than_the_memory_is_refused():
    effort = Effort.of(40_000, 96, 1)
    effort.check_memory(effort.memory)
    with pytest.raises(InputError, match=r"40,000 elements need about 1\.25 GiB, and this machine has 1 GiB"):
        effort.check_memory(2.0**30)
    assert 2**28 < machine_memory() < 2**50


@pytest.mark.parametrize(
    "setting", ["mesh.elements_per_turn=1e6", "mesh.section={radial: 64, angular: 256}", "mesh.sagitta=1e-12"]
)
def test_a_mesh_without_measure_is_refused_at_once(example, monkeypatch, setting):
    monkeypatch.setattr(build, "line_mesh", None)  # nothing is built
    monkeypatch.setattr(effort, "machine_memory", lambda: 2.0**33)
    with pytest.raises(InputError, match="mesh") as caught:
        Analysis(
            read_case(example, ["mesh.elements_per_turn=2000", setting, "ends=clamped", "loading=[{to: {travel: 1}}]"])
        )
    assert "\n" not in str(caught.value)


def test_a_run_of_hours_is_said():
    assert Effort.of(40, 96, 24).warnings() == []
    (warning,) = Effort.of(40_000, 96, 1000).warnings()
    assert warning.name == "duration"
    assert warning.value == pytest.approx(1.7, abs=0.05)
    assert "about 1.7 hours" in warning.message
