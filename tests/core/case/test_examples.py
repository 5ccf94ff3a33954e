"""Every file that is shipped can be read, and says the same in its earlier reading: no word became a number."""

from pathlib import Path

import pytest
import yaml

from coilset.model.core.base.yaml import load_yaml
from coilset.model.core.case import read_case
from coilset.model.core.material import library

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"
FILES = sorted([*EXAMPLES.rglob("*.yaml"), *library.FOLDER.glob("*.yaml")])
CASES = [EXAMPLES / "ck15_presetting.yaml", *sorted((EXAMPLES / "springs").glob("*.yaml"))]


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_shipped_files_mean_what_they_meant(path):
    text = path.read_text(encoding="utf-8")
    assert load_yaml(text) == yaml.safe_load(text)


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_shipped_cases_are_valid(path):
    assert list(read_case(path).notices()) == []
