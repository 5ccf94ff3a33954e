"""What a page shows first is what its title says, and all of a spring is in its 3D view."""

import numpy as np
import pytest
from mpi4py import MPI

from coilset.model.core.results.files.opened import open_run
from coilset.model.tools.figures.panels.along_wire import moments_along_wire
from coilset.model.tools.figures.panels.spring_view import TALLEST, scene_of
from coilset.scripts.commands.solve import solve

PROGRAM = "loading=[{to: {travel: 8}, steps: 3}, {to: {force: 0}}]"
PRESSED = ["mesh.elements_per_turn=8", "mesh.section.rule=abramowitz9", PROGRAM]


@pytest.mark.parametrize("tall", [10.0, 35.0, 200.0, 2000.0])
def test_springs_of_any_slenderness_fit_into_the_view(tall):
    """With one unit of the scene for each of the box's equal shares, a spring of L0/D above 2.1 was cut off."""
    ratio = scene_of(np.array([[-20.0, -20.0, 0.0], [20.0, 20.0, tall]]))["scene"]["aspectratio"]
    assert ratio["z"] / ratio["x"] == pytest.approx(tall / 40.0)  # true to scale
    assert ratio["z"] <= TALLEST + 1e-12
    assert np.linalg.norm(list(ratio.values())) <= np.sqrt(3.0) + 0.02  # the diagonal of a cube, which fits


def test_the_torque_of_the_title_is_shown_first(example, tmp_path):
    """The title named the state of the greatest torque while the last one, without torque, was shown."""
    solve(example, tmp_path / "run", False, PRESSED, comm=MPI.COMM_SELF)
    panel = moments_along_wire(open_run(tmp_path / "run"))
    first = len(panel.choices) - 1  # the last choice is shown first
    shown = [trace for trace in panel.traces if trace["meta"]["choice"] == first and trace["name"] == "torque Mt"]
    greatest = max(np.abs(trace["y"]).max() for trace in panel.traces if trace["name"] == "torque Mt")
    assert np.abs(shown[0]["y"]).max() == greatest
    assert panel.title.endswith(f"at {panel.choices[first]}")
