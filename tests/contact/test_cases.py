"""The fast cases of verification about contact are within their tolerances."""

import pytest

from coilset.verification import registry
from coilset.verification.study import Study


@pytest.mark.parametrize("name", ["table-7-1", "yield-load"])
def test_case_is_within_its_tolerances(name, tmp_path):
    study = Study(tmp_path)
    registry.load(name).run(study)
    assert [check for check in study.checks if not check.passed] == []
    assert study.passed
