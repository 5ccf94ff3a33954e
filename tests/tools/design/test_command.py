"""`coilset design` from the command line: its folder, and what is left of a design that is refused."""

import base64
import gzip
import json
import re

import pytest
import yaml

import coilset.open
from coilset.model.core.base.errors import InputError
from coilset.model.tools.report.design_page import LEAST_OFF, write_design_report
from coilset.model.tools.sweep.journal import read_records
from coilset.scripts.commands.design import design
from coilset.scripts.commands.report import report

FIND, SUCH = {"loading.0.to.height": [18, 34]}, {"free_length_after_mm": 25.0}


def test_a_folder_is_not_overwritten_unasked_and_a_cut_journal_is_gone_on_from(design_file, tmp_path, capsys):
    path, out = str(design_file(FIND, SUCH)), tmp_path / "out"
    design(path, str(out), False, False)
    said = json.loads((out / "design.json").read_text(encoding="utf-8"))
    assert said["met"]
    assert said["conditions"][0]["value"] == pytest.approx(25.0, rel=1e-6)
    assert yaml.safe_load((out / "found.yaml").read_text(encoding="utf-8"))["loading"][0]["to"] == {
        "height": said["found"]["loading.0.to.height"]
    }
    assert "off by" in capsys.readouterr().out
    page_of(out, said)
    labelled(out, said)
    with pytest.raises(InputError, match="holds a design already"):
        design(path, str(out), False, False)
    lines = (out / "evaluations.jsonl").read_text(encoding="utf-8").splitlines(keepends=True)
    (out / "evaluations.jsonl").write_text("".join(lines[:2]) + lines[2][:40], encoding="utf-8")  # a kill while writing
    (out / "design.json").unlink()
    with pytest.raises(InputError, match="holds an unfinished search"):
        design(path, str(out), False, False)
    design(path, str(out), False, True)
    assert "(known)" in capsys.readouterr().out
    assert [record["x"] for record in read_records(out / "evaluations.jsonl")] == [
        json.loads(line)["x"] for line in lines
    ]
    again = json.loads((out / "design.json").read_text(encoding="utf-8"))
    assert again["found"] == said["found"]


def page_of(folder, said):
    """Its page begins with what was found, and tells each evaluation."""
    text = write_design_report(folder).read_text(encoding="utf-8")
    assert f"<strong>{said['found']['loading.0.to.height']:.4f} mm</strong>" in text
    assert f"<strong>{said['summary']['set_mm']:.5g} mm</strong>" in text
    assert (folder / "found.yaml").read_text(encoding="utf-8").splitlines()[-1] in text
    (trace,) = unpacked(text, "data")["figures"]["search"]["data"]
    off = [abs(r["values"][0] - 25.0) / 25.0 for r in read_records(folder / "evaluations.jsonl")]
    assert trace["y"] == [max(one, LEAST_OFF) for one in off]  # as low as the figure goes


def labelled(folder, said):
    """What `coilset.open` gives of it."""
    data, records = coilset.open(folder), list(read_records(folder / "evaluations.jsonl"))
    name = "loading.0.to.height"
    assert data[name].attrs == {"units": "mm"}
    assert data[name].values.tolist() == [record["x"][0] for record in records]
    assert data["free_length_after_mm"].attrs == {"units": "mm", "target": 25.0}
    assert data["free_length_after_mm"].values.tolist() == [record["values"][0] for record in records]
    assert data[f"found_{name}"].item() == said["found"][name]
    slope = data["slope"].sel(condition="free_length_after_mm", unknown=name)
    assert slope.item() == said["slopes"]["such_that.free_length_after_mm"][name]
    assert data["summary_set_mm"].item() == said["summary"]["set_mm"]
    assert json.loads(data.attrs["case"])["loading"][0]["to"]["height"] == said["found"][name]


def unpacked(page, name):
    """What a page keeps compressed."""
    kept = re.search(rf'<script type="text/plain" id="{name}">(.*?)</script>', page).group(1)
    return json.loads(gzip.decompress(base64.b64decode(kept)))


def test_nothing_is_left_of_a_design_that_is_refused(design_file, tmp_path):
    path = str(design_file({"rates_at.0": [1, 2]}, SUCH, rates_at=[1.0]))
    out = tmp_path / "out"
    with pytest.raises(InputError, match="no condition depends on it"):
        design(path, str(out), False, False)
    assert not out.exists()


def test_a_journal_of_another_design_is_kept_and_not_read_as_of_this_one(design_file, tmp_path):
    """The same springs, asked for the same two numbers in the other order, and then for what cannot be had."""
    out, heights = tmp_path / "out", [{"height": 24.0, "N": 100.0}, {"height": 20.0, "N": 160.0}]
    loading = [
        {"to": {"height": 24.0}, "steps": 1},
        {"to": {"height": 20.0}, "steps": 1},
        {"to": {"force": 0}, "steps": 1},
    ]

    def found(force_at, resume):
        path = design_file(
            {"spring.wire_diameter": [4.9, 5.0]},
            {"force_at": force_at},
            loading=loading,
            material="elastic",
            accuracy="none",
        )
        design(str(path), str(out), False, resume)
        (out / "design.json").rename(out / "was.json")
        return {one["height_mm"]: one["value"] for one in json.loads((out / "was.json").read_text())["conditions"]}

    first = found(heights, False)
    journal = (out / "evaluations.jsonl").read_text()
    assert first[24.0] < first[20.0]
    assert found(heights[::-1], True) == pytest.approx(first, rel=1e-6)
    (out / "was.json").rename(out / "design.json")
    new = (out / "evaluations.jsonl").read_text()[len(journal) :]
    assert len(coilset.open(out)["evaluation"]) == len(new.splitlines())
    path = design_file({"spring.wire_diameter": [4.9, 5.0]}, {"free_length_after_mm": 200.0})
    with pytest.raises(InputError, match="out of reach"):
        design(str(path), str(out), False, True)
    assert (out / "evaluations.jsonl").read_text().startswith(journal)
    assert (out / "design.json").exists()


def test_the_page_has_the_characteristic_of_the_spring_that_was_found(design_file, tmp_path, capsys):
    """Which is solved for it, once; a page of another design does not take these results."""
    out = tmp_path / "out"
    design(str(design_file(FIND, SUCH)), str(out), False, False)
    capsys.readouterr()
    report(out)
    assert "solving" in capsys.readouterr().out
    figures = unpacked((out / "report.html").read_text(encoding="utf-8"), "data")["figures"]
    assert list(figures) == ["characteristic", "spring", "search"]
    said = json.loads((out / "design.json").read_text(encoding="utf-8"))
    own = json.loads((out / "found" / "summary.json").read_text(encoding="utf-8"))
    assert own["free_length_after_mm"] == pytest.approx(said["conditions"][0]["value"], rel=1e-9)
    report(out)
    assert "solving" not in capsys.readouterr().out
    design(str(design_file(FIND, {"free_length_after_mm": 26.0})), str(out), True, False)
    page = write_design_report(out).read_text(encoding="utf-8")
    assert list(unpacked(page, "data")["figures"]) == ["search"]
