"""A spring whose force rises when it is released: the heads are opened."""

import numpy as np
import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.entry import check_entries
from coilset.model.core.case import Case

TELESCOPING = {  # its coils slip past each other, and its force falls from there to block
    "spring": {
        "wire_diameter": 13.97,
        "mean_diameter": {"shape": "cone", "bottom": 163.4, "top": 134.6},
        "turns": 2.5,
        "pitch": 102.3,
    },
    "material": "elastic",
    "ends": "seats",
    "mesh": {"elements_per_turn": 6, "section": {"kind": "plane", "rule": "abramowitz9"}},
    "loading": [{"to": "block", "steps": 6}, {"to": {"force": 0.0}, "steps": 4}],
    "accuracy": "none",
}


@pytest.fixture
def case():
    return check_entries(TELESCOPING, Case)


def test_a_release_by_force_goes_on_by_height_where_no_smaller_force_is_near(case, resumed_after):
    whole = Analysis(case, MPI.COMM_SELF)
    pressed, released = ([step for step in whole.run().steps if step.phase == phase] for phase in (0, 1))
    assert whole.program.position.stage == 2
    # elastic wire comes back along its way, to the free spring
    assert (np.diff([step.seat_height_mm for step in released]) > 0.0).all()
    assert (np.diff([0.0, *(step.progress for step in released)]) > 0.0).all()
    assert released[-1].progress == 1.0
    assert released[-1].seat_height_mm == pytest.approx(whole.spring.free_length, abs=1e-6)
    way = sorted([(whole.spring.free_length, 0.0), *((step.seat_height_mm, step.force_N) for step in pressed)])
    forces = np.interp([step.seat_height_mm for step in released[1:]], *np.transpose(way))
    assert forces == pytest.approx([step.force_N for step in released[1:]], rel=0.01, abs=1e-6)
    resumed = resumed_after(case, len(pressed) + 1)
    steps = resumed.run().steps
    assert [step.force_N for step in steps] == pytest.approx([step.force_N for step in whole.result.steps], abs=1e-6)
