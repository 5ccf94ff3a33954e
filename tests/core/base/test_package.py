"""Doors to optional packages: a file that names a missing one is refused in one line."""

import sys
from typing import Annotated, Any

import pytest

from coilset.model.core.base.entry import check_entries
from coilset.model.core.base.errors import InputError
from coilset.model.core.base.package import Entry
from coilset.model.core.base.strict_entries import Strict

TAILS = "coilset.meshes.tails"
LIMIT = "coilset.model.tools.limits.limit_entries:Limits"


def group(form):
    """A new group, whose entry has not been read yet."""

    class Group(Strict):
        given: Annotated[Any, Entry(form)] = None

    return Group


def test_an_entry_of_a_missing_package_is_refused_with_its_name(monkeypatch):
    monkeypatch.setitem(sys.modules, TAILS, None)
    kind = group(f"{TAILS}:Hooks")
    with pytest.raises(InputError) as refused:
        check_entries({"given": {"bottom": {"shape": "german"}}}, kind, "case.yaml")
    expected = f"case.yaml: given: this entry needs the package {TAILS}, which this installation lacks"
    assert str(refused.value) == expected
    assert check_entries({}, kind).given is None


def test_an_entry_of_a_package_is_checked_and_written_as_any_other():
    kind = group(f"{TAILS}:Hooks")
    data = {"given": {"bottom": {"shape": "german", "length": 20.0}}}
    assert check_entries(data, kind).model_dump(mode="json", exclude_unset=True) == data
    with pytest.raises(InputError, match=r"given\.bottom\.shape: 'round': must be 'german', 'english' or 'side'"):
        check_entries({"given": {"bottom": {"shape": "round"}}}, kind)


def test_an_entry_that_is_no_group_is_as_strict_and_written_with_the_groups_in_it():
    kind = group(LIMIT)
    data = {"given": {"rate_initial": {"nominal": 3.0, "tolerance": 0.2}, "set": [1.0, 2.0]}}
    assert check_entries(data, kind).model_dump() == data
    with pytest.raises(InputError, match=r"given\.rate_initial\.nominal: True: must be a number"):
        check_entries({"given": {"rate_initial": {"nominal": True, "tolerance": 0.2}}}, kind)
