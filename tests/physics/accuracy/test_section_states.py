"""Long rods keep no trial states of their points: what they find is the same to the last bit."""

import numpy as np
import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.core.case import read_case
from coilset.model.core.rod import section_states

SMALL = ["mesh.elements_per_turn=10", "mesh.section={radial: 3, angular: 8}"]
HELD = "[{to: {travel: 14}, steps: 3}, {hold: {hours: 100}, steps: 2}, {to: {force: 0}, steps: 2}]"
CREEPING = ["material=creeping", "temperature=373.15", "ends=clamped", f"loading={HELD}"]
SPRINGS = {
    "automatic": [],  # with attempts that are refused for their error
    "plane": ["mesh.section.kind=plane", "loading=[{to: block, steps: 4}, {to: {force: 0}, steps: 3}]"],
    "warping": ["mesh.section={kind: warping, degree: 1}", "loading=[{to: {travel: 9}, steps: 2}]"],
    "creeping": CREEPING,
}


def run(example, settings, fails=()):
    """The analysis after its program; the finer path finds no stress in the calls of these numbers."""
    analysis = Analysis(read_case(example, [*SMALL, *settings]), MPI.COMM_SELF)
    finer, calls = analysis.continuation.step_error._finer, []
    follow = finer._follow

    def failing(*args):
        calls.append(args)
        return len(calls) not in fails and follow(*args)

    finer._follow = failing
    analysis.run()
    return analysis


@pytest.mark.parametrize("settings", SPRINGS.values(), ids=SPRINGS)
def test_trial_states_need_not_be_kept(example, monkeypatch, settings):
    fails = (3,) if settings is CREEPING else ()
    kept = run(example, settings, fails)
    monkeypatch.setattr(section_states, "KEPT", 4)
    passing = run(example, settings, fails)
    assert passing.result.steps == kept.result.steps
    assert [step.steps_force_error_N is None for step in kept.result.steps].count(True) == len(fails)
    start, *later = zip(passing.result.snapshots, kept.result.snapshots, strict=True)
    # what is kept was evaluated at rest
    np.testing.assert_allclose(start[0].point_state, start[1].point_state, rtol=0.0, atol=1e-10)
    for shots in later:
        for name in ("point_state", "surface_state", "resultants"):
            np.testing.assert_array_equal(*(getattr(shot, name) for shot in shots))
    assert np.abs(kept.rod.point_state[..., :3]).max() > 1.0  # MPa, also after the release
    fields = [analysis.rod.state["point_state"] for analysis in (kept, passing)]
    held = [field.trial is field.equilibrium for field in fields]
    assert held == [False, kept.rod.sections.passing != ()]
    for name, field in kept.rod.state.items():
        np.testing.assert_array_equal(passing.rod.state[name].equilibrium, field.equilibrium, err_msg=name)
