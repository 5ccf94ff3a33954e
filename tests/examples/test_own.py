"""Kinds of contact and step controls of one's own: the examples run, and their own assertions judge them."""

import runpy
from pathlib import Path

import pytest

OWN = sorted((Path(__file__).resolve().parents[2] / "examples" / "own").glob("*.py"))


@pytest.mark.parametrize("path", OWN, ids=lambda path: path.stem)
def test_an_example_runs(path):
    assert "\nassert " in path.read_text(encoding="utf-8")
    runpy.run_path(str(path))
