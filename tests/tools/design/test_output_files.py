"""The case that a search has found runs without the folders of its author."""

import shutil

import yaml

from coilset.model.core.case import read_case
from coilset.model.core.material import library
from coilset.model.tools.design.output import with_files


def test_a_found_case_is_complete_in_its_folder(tmp_path):
    """It held the absolute path of the material file."""
    author, results, elsewhere = (tmp_path / name for name in ("author", "results", "elsewhere"))
    author.mkdir()
    results.mkdir()
    steel = author / "steel.yaml"
    steel.write_bytes((library.FOLDER / "ck15.yaml").read_bytes())
    spring = {"wire_diameter": 5, "mean_diameter": 40, "turns": 2.5, "pitch": 12}
    data = {"spring": spring, "material": str(steel), "loading": [{"to": "block"}]}
    (results / "found.yaml").write_text(yaml.safe_dump(with_files(data, results)), encoding="utf-8")
    assert str(tmp_path) not in (results / "found.yaml").read_text(encoding="utf-8")
    assert data["material"] == str(steel)  # the data of the search itself are as they were
    results.rename(elsewhere)
    shutil.rmtree(author)
    assert read_case(elsewhere / "found.yaml").material == str(elsewhere / "steel.yaml")
