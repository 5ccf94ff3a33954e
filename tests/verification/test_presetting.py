"""A part of the case contact-meshes of verification, which is slow."""

from pathlib import Path

import pytest

from coilset import model
from coilset.verification.cases.contact.contact_meshes import FAILED, IN_PARTS, SOLVED, press
from coilset.verification.spring_references.coil_by_coil import CoilByCoil


@pytest.mark.slow
def test_cone_reaches_block_and_comes_back_without_a_failed_solve():
    """16 elements a turn, twelve equal steps down and up; what springs back is that of coils in torsion within 10 %."""
    analysis, summary, counter = press("cone", 16, False)
    assert len(analysis.result.steps) == 24
    assert counter.failed == 0
    by_hand = CoilByCoil(analysis.spring, analysis.law)
    assert by_hand.block_travel() - summary["set_mm"] == pytest.approx(by_hand.spring_back(), rel=0.1)


def test_failed_solves_are_found_by_the_words_of_the_log():
    """Or none would ever be counted."""
    sources = "".join(path.read_text() for path in Path(model.__path__[0]).rglob("*.py"))
    assert [words for words in (*FAILED, *SOLVED, *IN_PARTS) if words not in sources] == []
