"""Seats only press: targets that would have them pull are refused before the run, with the numbers."""

import pytest

from coilset.meshes.errors import InputError
from coilset.model.case import read_case
from coilset.model.case.targets import check_targets
from coilset.scripts.solve import solve

PULLS = [("force", -1000, "-1000 N"), ("travel", -2, "-2 mm"), ("height", 40, "40 mm, above the free length of 35 mm")]


@pytest.mark.parametrize(("entry", "value", "words"), PULLS)
def test_seats_do_not_pull(example, tmp_path, entry, value, words):
    loading = f"loading=[{{to: {{travel: 2}}}}, {{to: {{{entry}: {value}}}}}]"
    with pytest.raises(InputError, match=words) as caught:
        solve(example, tmp_path / "out", False, [loading], False)
    assert f"loading.1.to.{entry}" in str(caught.value)
    assert not (tmp_path / "out").exists()
    clamped = read_case(example, [loading, "ends=clamped"])
    check_targets(clamped, clamped.spring.build())  # heads of clamped ends pull


@pytest.mark.parametrize("target", ["force: 0", "travel: 0", "height: 35"])
def test_an_unloaded_spring_is_no_pull(example, target):
    case = read_case(example, [f"loading=[{{to: {{{target}}}}}]"])
    check_targets(case, case.spring.build())
