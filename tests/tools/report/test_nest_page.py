"""The page of a nest: both springs, their shares of the force, the clearance, and links to their own pages."""

import base64
import gzip
import json
import re

import numpy as np
import pytest
import yaml

from coilset.model.core.results.records.labels import within
from coilset.model.tools.figures.panels.panel import with_unit
from coilset.model.tools.nest.output import headline
from coilset.scripts.commands.nest import nest
from coilset.scripts.commands.report import report

OUTER = {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 2.5, "pitch": 14.0}
INNER = {"wire_diameter": 3.0, "mean_diameter": 24.0, "turns": 3.5, "pitch": 8.0, "hand": "left"}
COMMON = {
    "material": "ck15",
    "mesh": {"elements_per_turn": 8, "section": {"radial": 2, "angular": 8}},
    "loading": [{"to": "block"}],
}

INSIDE = "residual_shear_inside_MPa", "estimated_residual_shear_inside_error_MPa"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("nest")
    for name, spring in (("outer", OUTER), ("inner", INNER)):
        (place / f"{name}.yaml").write_text(yaml.safe_dump(COMMON | {"spring": spring}))
    members = {name: {"case": f"{name}.yaml"} for name in ("outer", "inner")}
    (place / "nest.yaml").write_text(yaml.safe_dump(members | {"loading": [{"to": {"height": 22.0}, "steps": 4}]}))
    nest(place / "nest.yaml", place / "out", False, False)
    return place / "out"


@pytest.fixture(scope="module")
def page(folder):
    report(folder)
    return (folder / "report.html").read_text(encoding="utf-8")


def test_the_answer_has_both_springs(folder, page):
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    of_set = within(summary["set_mm"], summary["estimated_set_error_mm"], "mm", 3)
    of_force = within(summary["force_max_N"], summary["estimated_force_error_N"], "N", 2)
    assert "±" in of_set
    assert "±" in of_force
    for text in (of_set, of_force, f"{summary['clearance_min_mm']:.3f} mm"):
        assert f"<strong>{text}</strong>" in page
    shares = [float(share) for share in re.findall(r"<td>([\d.]+) %</td>", page)]
    assert shares[0] == pytest.approx(100.0 * summary["outer"]["force_max_N"] / summary["force_max_N"], abs=0.051)
    assert sum(shares) == pytest.approx(100.0, abs=0.11)
    assert len(shares) == 2
    for name in ("outer", "inner"):
        assert f'href="{name}/report.html"' in page
        assert (folder / name / "report.html").is_file()
        inside, error = (summary[name][key] for key in INSIDE)
        assert within(inside, error, "MPa", 1).replace("-", "−") in page


def test_the_figures_are_of_both_springs(page):
    kept = re.search(r'<script type="text/plain" id="data">(.*?)</script>', page).group(1)
    figures = json.loads(gzip.decompress(base64.b64decode(kept)))["figures"]
    both, *each = figures["characteristic"]["data"]
    assert [trace["name"] for trace in (both, *each)] == ["both", "outer", "inner"]
    assert both["y"] == pytest.approx(np.sum([trace["y"] for trace in each], axis=0))
    assert len(figures["springs"]["data"]) == 2 * 3
    assert "clearance" in figures


def test_the_title_of_its_picture_is_in_plain_numbers():
    assert headline({"force_max_N": 83812.3, "set_mm": -1e-7}) == "Maximum force 83812 N, set 0 mm"
    assert headline({"force_max_N": 412.68, "set_mm": 30.7037}) == "Maximum force 412.68 N, set 30.704 mm"
    unsure = {"force_max_N": 844.39, "set_mm": 30.7385, "estimated_force_error_N": 56.0, "estimated_set_error_mm": 2.1}
    assert headline(unsure) == "Maximum force 840 ± 60 N, set 31 ± 3 mm"
    assert with_unit(-1e-7, "mm", 3) == "0.000 mm"
