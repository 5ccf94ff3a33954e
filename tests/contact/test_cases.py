"""The fast cases of verification about contact are within their tolerances."""

import pytest

from coilset.verification import registry
from coilset.verification.cases.contact_meshes import press
from coilset.verification.study import Study


@pytest.mark.parametrize(
    "name", ["force-centre", "table-7-1", "yield-load", "cantilever-on-plane", "ring-between-plates", "crossed-rods"]
)
def test_case_is_within_its_tolerances(name, tmp_path):
    study = Study(tmp_path)
    registry.load(name).run(study)
    assert [check for check in study.checks if not check.passed] == []
    assert study.passed


def test_cone_reaches_block_and_comes_back_without_a_failed_solve():
    """A part of contact-meshes: 16 elements a turn, twelve equal steps; the set as with 64, 38.482 mm, within 0.1 %."""
    analysis, summary, counter = press("cone", 16, False)
    assert len(analysis.result.steps) == 24
    assert counter.failed == 0
    assert summary["set_mm"] == pytest.approx(38.482, rel=1e-3)
