"""The page of a run: whole, self-contained, and with the numbers of summary.json."""

import base64
import gzip
import json
import re

import numpy as np
import pytest
from mpi4py import MPI

from coilset.meshes.errors import InputError
from coilset.model.report.glossary import GLOSSARY
from coilset.model.report.page import CHAPTERS, write_report
from coilset.model.report.scale import round_end
from coilset.model.report.wire import tubes
from coilset.model.results.opened import open_run
from coilset.scripts.solve import solve

CASE = """
spring: {wire_diameter: 5, mean_diameter: 40, turns: 2.5, pitch: 12}
material: ck15
loading: [{to: block, steps: 4}, {to: {force: 0}, steps: 2}]
mesh: {elements_per_turn: 8, section: {kind: curved, radial: 2, angular: 8}}
"""
MOST = 15e6  # bytes of a page


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("run")
    (place / "spring.yaml").write_text(CASE)
    solve(place / "spring.yaml", place / "spring", False, [], pictures=False, comm=MPI.COMM_SELF)
    return place / "spring"


@pytest.fixture(scope="module")
def page(folder):
    return write_report(open_run(folder)).read_text(encoding="utf-8")


def part(page, name):
    return re.search(rf'<script type="[^"]*" id="{name}">(.*?)</script>', page, re.S).group(1)


def test_it_stands_by_itself(page):
    """No address is asked for, whatever the library's own texts say."""
    assert len(page.encode()) < MOST
    own = page.replace(part(page, "plotly"), "")
    assert not re.findall(r'(?:src|href)="(?!#)', own)
    assert b"Plotly" in gzip.decompress(base64.b64decode(part(page, "plotly")))


def test_each_figure_is_there_with_a_text(page):
    figures = json.loads(part(page, "figures"))
    assert len(figures) >= sum(len(draw) for _, draw in CHAPTERS) - 2  # rate and error are not of every run
    for name in figures:
        assert re.search(rf'role="img" aria-label="[^"]{{30,}}" data-figure="{name}"', page), name


def test_numbers_are_those_of_the_summary(folder, page):
    """A summary with another set, and nothing else changed, gives a page with that set."""
    path = folder / "summary.json"
    before = path.read_text()
    summary = json.loads(before)
    assert f"<strong>{summary['set_mm']:.3f} mm</strong>" in page
    try:
        path.write_text(json.dumps({**summary, "set_mm": 1.234567}))
        assert "<strong>1.235 mm</strong>" in write_report(open_run(folder)).read_text(encoding="utf-8")
    finally:
        path.write_text(before)


def test_words_of_the_glossary_are_explained(page):
    for word in ("set", "initial rate", "residual shear stress"):
        assert GLOSSARY[word].replace("'", "&#39;") in page


def test_the_tube_is_round_the_wire(folder):
    """Each point of the surface is a wire radius from the centre line, the first of a ring towards the axis."""
    places, stress = tubes(open_run(folder))
    centre = places[:, :, :-1].mean(axis=2)
    assert np.linalg.norm(places - centre[:, :, None], axis=-1) == pytest.approx(2.5, rel=1e-9)
    assert np.all(np.hypot(*np.moveaxis(places[:, :, 0, :2], -1, 0)) < np.hypot(*np.moveaxis(centre[..., :2], -1, 0)))
    assert np.array_equal(stress[:, :, 0], stress[:, :, -1])
    assert stress[1].min() > 0.0 > stress[-1].min()  # with the load at block; against it, somewhere, after


@pytest.mark.parametrize(("value", "end"), [(0.0, 1.0), (1.0, 1.0), (101.0, 150.0), (0.037, 0.04), (9.9e5, 1e6)])
def test_scales_end_round(value, end):
    assert round_end(value) == pytest.approx(end)


def test_a_folder_without_a_run_is_refused(tmp_path):
    with pytest.raises(InputError, match="no results of a run"):
        open_run(tmp_path)
    (tmp_path / "summary.json").write_text("{")
    with pytest.raises(InputError, match="not readable"):
        open_run(tmp_path)
