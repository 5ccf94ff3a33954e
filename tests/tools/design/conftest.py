"""Designs of small springs on coarse meshes."""

import pytest
import yaml

from coilset.model.tools.design.design import make_search
from coilset.model.tools.design.file import read_design_file

COARSE = {
    "spring": {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 2.5, "pitch": 12.0},
    "material": "ck15",
    "mesh": {"elements_per_turn": 8, "section": {"radial": 3, "angular": 10}},
    "loading": [{"to": {"height": 20.0}}, {"to": {"force": 0}}],
}


@pytest.fixture
def design_file(tmp_path):
    """Path of a design of the coarse spring; keyword arguments replace entries of its file."""

    def write(find, such_that, **entries):
        path = tmp_path / "design.yaml"
        path.write_text(yaml.safe_dump({**COARSE, **entries, "find": find, "such_that": such_that}), encoding="utf-8")
        return path

    return write


@pytest.fixture
def search(design_file):
    """The search of such a design."""
    return lambda *args, **entries: make_search(read_design_file(design_file(*args, **entries)))
