"""A part of the case contact-meshes of verification; the fast cases are all tested by tests/verification."""

import pytest

from coilset.verification.cases.contact_meshes import press


def test_cone_reaches_block_and_comes_back_without_a_failed_solve():
    """16 elements a turn, twelve equal steps down and up; the set as with 64, 38.482 mm, within 0.1 %."""
    analysis, summary, counter = press("cone", 16, False)
    assert len(analysis.result.steps) == 24
    assert counter.failed == 0
    assert summary["set_mm"] == pytest.approx(38.482, rel=1e-3)
