"""An analysis is freed as soon as it is no longer used, without a search for cycles: it holds all points' states."""

import gc
import weakref

import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.core.case import read_case

SMALL = ["mesh={elements_per_turn: 6, section: {radial: 2, angular: 6}}"]
PRESSED = "loading=[{to: {travel: 2}, steps: 2}, {to: {force: 0}, steps: 1}]"
HEATED = "loading=[{to: {travel: 2}, steps: 1}, {heat: {to: 400, minutes: 5}, steps: 2}]"
KINDS = {
    "clamped": ["ends=clamped", "accuracy=none", PRESSED],
    "friction": ["contact.friction={seats: 0.1, coils: 0.1}", "accuracy=none", PRESSED],
    "estimates": ["accuracy=0.01", PRESSED],
    "heat": ["material=creeping", "accuracy=none", HEATED],
}


@pytest.mark.parametrize("kind", KINDS)
def test_an_analysis_is_freed_at_once(example, kind):
    gc.collect()
    gc.disable()
    try:
        analysis = Analysis(read_case(example, [*SMALL, *KINDS[kind]]), MPI.COMM_SELF)
        analysis.run()
        kept = {name: weakref.ref(getattr(analysis, name)) for name in ("rod", "system", "newton", "recorder")}
        del analysis
        assert [name for name, part in kept.items() if part() is not None] == []
    finally:
        gc.enable()
