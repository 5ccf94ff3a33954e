"""The fast cases of verification are part of the tests; and a case that is off is said to be."""

import pytest

from coilset.verification import registry
from coilset.verification.study import Study

FAST = [name for name in registry.names() if registry.load(name).fast]


def test_the_tables_of_the_thesis_are_among_the_fast_ones():
    assert {"table-4-1", "table-6-1", "table-6-2"} <= set(FAST)


@pytest.mark.parametrize("name", FAST)
def test_fast_cases_are_within_tolerance(name, tmp_path):
    study = Study(tmp_path)
    registry.load(name).run(study)
    assert study.checks
    off = [f"{check.quantity}: {check.ours} instead of {check.reference}" for check in study.checks if not check.passed]
    assert not off
    assert study.figures


@pytest.mark.parametrize(
    ("ours", "reference", "tolerance", "kind", "good"),
    [
        (1.009, 1.0, 0.01, "relative", True), (-1.0, 1.0, 0.01, "relative", False),
        (1.02, 1.0, 0.01, "absolute", False), (float("nan"), 1.0, 0.01, "absolute", False),
        (7, 6, 0, "at_most", False), (1, 6, 0, "at_most", True), (float("nan"), 6, 0, "at_most", False),
    ],
)  # fmt: skip
def test_a_number_that_is_off_does_not_pass(tmp_path, ours, reference, tolerance, kind, good):
    study = Study(tmp_path)
    study.check("a number", ours, reference, "by hand", tolerance, kind)
    assert study.checks[0].passed is good
