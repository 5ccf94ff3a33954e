"""Entries in words: a table's value by its turn, a phase's target by its phase, all with their units."""

import pytest

from coilset.model.core.case.names import entry_name

TABLE = {"turns": [0, 2, 3.5, 6], "values": [7.0, 7.0, 13.0, 13.0], "interpolation": "linear"}


@pytest.mark.parametrize(
    ("entry", "head"),
    [
        ("spring.wire_diameter", "wire diameter, mm"),
        ("spring.pitch.values.2", "pitch at turn 3.5, mm"),
        ("spring.wire_diameter.values.0", "wire diameter at point 1, mm"),  # the case has no such table
        ("spring.mean_diameter.middle", "mean diameter, middle, mm"),
        ("spring.turns", "turns"),
        ("loading.1.to.height", "height of phase 2, mm"),
        ("mesh.elements_per_turn", "elements per turn"),
        ("rates_at.0", "rates at, number 1, mm"),
        ("material", "material"),
    ],
)
def test_entries_in_words(entry, head):
    assert entry_name(entry, {"spring": {"pitch": TABLE, "wire_diameter": 4.0}}).head == head
