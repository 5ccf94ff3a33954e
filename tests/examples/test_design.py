"""The shipped wish is met by the numbers that its page gives, and by what its file wishes."""

import re
from pathlib import Path

import pytest

from coilset.model.design.design import find, make_search
from coilset.model.design.wish import read_wish

REPOSITORY = Path(__file__).resolve().parents[2]


def test_length_and_force():
    search = make_search(read_wish(REPOSITORY / "examples/design/length_and_force.yaml"))
    found = find(search)
    page = (REPOSITORY / "docs/how-to/design.md").read_text(encoding="utf-8")
    stated = dict(re.findall(r"^([\w.]+) = ([\d.]+)$", page, re.MULTILINE))
    assert list(stated) == search.evaluator.names
    assert found.x == pytest.approx([float(value) for value in stated.values()], rel=1e-6)
    assert found.best.values == pytest.approx([25.0, 160.0], rel=1e-6)
    assert search.evaluator.count <= 6
