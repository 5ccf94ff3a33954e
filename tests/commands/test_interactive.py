"""Targets that are typed at the prompt are read as those of a case file."""

import pytest

from coilset.model.errors import InputError
from coilset.scripts.interactive import parse_phase


def test_targets_are_phases():
    assert parse_phase("block").to == "block"
    phase = parse_phase("{height: 20}, steps: 8")
    assert (phase.to.height, phase.steps) == (20.0, 8)


@pytest.mark.parametrize("text", ["blok", "{height: yes}", "{height: 20, height: 21}", "{height: [", "{" * 2000, ""])
def test_other_targets_get_one_short_line(text):
    with pytest.raises(InputError, match="a target is block") as caught:
        parse_phase(text)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 300
