"""No entry, column or variable that a run writes lacks its row in the reference, and no row is of one that is gone."""

import re
from dataclasses import fields, replace
from pathlib import Path

import pytest

from coilset import model
from coilset.model.compose.analysis import Analysis
from coilset.model.compose.dataset import variables
from coilset.model.compose.summary import summarise
from coilset.model.core.case import read_case
from coilset.model.core.results.files.netcdf import coordinates
from coilset.model.core.results.records.record import BucklingMode, SeatReaction, SeatReactions, Step
from coilset.model.core.results.records.summary_entries import Summary

PAGE = (Path(__file__).resolve().parents[2] / "docs/reference/results.md").read_text(encoding="utf-8")
MODEL = Path(model.__file__).parent
SHORT = ["loading=[{to: {travel: 1}, steps: 1}, {to: {force: 0}, steps: 1}]", "mesh.elements_per_turn=8"]


def rows(heading, first="entry|column|variable"):
    """Names in the first column of the tables that begin so, under a heading."""
    section = re.split(r"^## ", PAGE.partition(f"\n## {heading}\n")[2], flags=re.MULTILINE)[0]
    found = []
    for table in re.split(r"\n\n", section):
        if re.match(rf"\s*\| (?:{first}) \|", table):
            found += re.findall(r"^\| `(\w+)` \|", table, re.MULTILINE)
    return found


@pytest.fixture(scope="module")
def run(example):
    analysis = Analysis(read_case(example, SHORT))
    return analysis.setup, analysis.run()


def test_history():
    assert sorted(rows("history.csv")) == sorted(item.name for item in fields(Step))


def test_seats(run):
    own = [item.name for item in fields(SeatReactions) if item.name not in ("bottom", "top", "pressure")]
    assert sorted(rows("seats.csv")) == sorted([*own, *(item.name for item in fields(SeatReaction))])


def test_summary(run):
    """Names, units and meanings are those of Summary; the page adds links only."""
    section = re.split(r"^## ", PAGE.partition("\n## summary.json\n")[2], flags=re.MULTILINE)[0]
    table = re.findall(r"^\| `(\w+)` \| (?:([^|]+) )?\| (.*) \|$", section, re.MULTILINE)
    page = [(name, unit, re.sub(r" \(\[[^]]*\]\([^)]*\)\)", "", text)) for name, unit, text in table]
    assert page == [(item.name, item.metadata["unit"], item.metadata["text"]) for item in fields(Summary)]
    assert list(summarise(*run)) == [item.name for item in fields(Summary)]


def test_points(run):
    setup, result = run
    x = result.snapshots[0].x
    data = variables(setup, replace(result, mode=BucklingMode(1.0, 9.0, 0.5, x, 0.0 * x)))
    assert sorted(rows("points.nc")) == sorted(set(data) - set(coordinates(data)))
    assert sorted(rows("points.nc", "coordinate")) == sorted(coordinates(data))


def test_warnings():
    """Each name that a Warning is made with is on the page, and no other."""
    made = re.compile(r"\bWarning\(\s*\"([a-z -]+)\"")
    names = {name for path in MODEL.rglob("*.py") for name in made.findall(path.read_text(encoding="utf-8"))}
    (listed,) = re.findall(r"^Warnings, by name: (.*?)\. They are printed", PAGE, re.MULTILINE | re.DOTALL)
    assert {"lift-off", "step error", "strength"} <= names
    assert set(re.findall("`([^`]+)`", listed)) == names
