"""The fast cases of verification are part of the tests; and a case that is off is said to be."""

import json
from pathlib import Path

import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from coilset.model.core.base.errors import SolveError
from coilset.scripts.commands.verify import verify
from coilset.verification import registry
from coilset.verification.cases.contact import force_centre, two_circles
from coilset.verification.page import page
from coilset.verification.study import Study

FAST = [name for name in registry.names() if registry.load(name).fast]
LONGER = {
    "ring-between-plates",
    "section-elastic",
    "solid-closed-solutions",
}  # tests/core/contact, section, solid have parts


def test_the_tables_of_the_thesis_are_among_the_fast_ones():
    assert {"table-4-1", "table-6-1", "table-6-2"} <= set(FAST)


@pytest.mark.parametrize("name", [pytest.param(name, marks=[pytest.mark.slow] * (name in LONGER)) for name in FAST])
def test_fast_cases_are_within_tolerance(name, tmp_path):
    study = Study(tmp_path)
    registry.load(name).run(study)
    judged = [check for check in study.checks if check.judged]
    off = [f"{check.quantity}: {check.ours} instead of {check.reference}" for check in judged if not check.passed]
    assert judged
    assert not off
    assert study.figures


@pytest.mark.parametrize(
    ("ours", "reference", "tolerance", "kind", "good"),
    [
        (1.009, 1.0, 0.01, "relative", True),
        (-1.0, 1.0, 0.01, "relative", False),
        (1.02, 1.0, 0.01, "absolute", False),
        (float("nan"), 1.0, 0.01, "absolute", False),
        (7, 6, 0, "at_most", False),
        (1, 6, 0, "at_most", True),
        (float("nan"), 6, 0, "at_most", False),
    ],
)
def test_a_number_that_is_off_does_not_pass(tmp_path, ours, reference, tolerance, kind, good):
    study = Study(tmp_path)
    study.check("a number", ours, reference, "by hand", tolerance, kind)
    assert study.checks[0].passed is good


def test_a_number_that_is_shown_is_not_judged(tmp_path):
    study = Study(tmp_path)
    study.shown("a number", 2.0, 1.0, "by hand", "nobody knows it better")
    assert study.checks[0].verdict == "not judged: nobody knows it better"
    assert not study.passed  # nothing is judged
    study.check("another", 1.0, 1.0, "by hand")
    assert study.passed
    study.check("a third", 2.0, 1.0, "by hand", 0.5)
    assert study.checks[-1].verdict == "not met"
    assert not study.passed


def test_the_legend_of_the_force_centre_is_clear_of_the_ring(tmp_path, monkeypatch):
    drawn = []
    monkeypatch.setattr(Study, "figure", lambda study, name, figure: drawn.append(figure))
    pressed = {
        ends: force_centre.press(ends, "elastic", [{"to": {"travel": 1.0}, "steps": 1}])
        for ends in force_centre.SPRINGS
    }
    force_centre.draw_paths(Study(tmp_path), pressed)
    canvas = FigureCanvasAgg(drawn[0])
    canvas.draw()
    plan, _over, *maps = drawn[0].axes
    legend = plan.get_legend().get_window_extent(canvas.get_renderer())
    assert not any(legend.overlaps(axes.get_window_extent()) for axes in drawn[0].axes)
    assert not any(legend.overlaps(axes.title.get_window_extent(canvas.get_renderer())) for axes in maps)


def test_a_figure_is_titled_with_its_result(tmp_path):
    study = Study(tmp_path)
    study.check("close", 1.001, 1.0, "closed form", 0.1)
    study.check("force, N", 1.05, 1.0, "closed form", 0.1)
    near = "nearest its limit is force, N, off by 5 % (10 % allowed; reference: closed form)"
    assert study.finding == f"All 2 numbers are within tolerance; {near}"
    figure = Figure(figsize=(20.0, 3.0))
    figure.suptitle("A spring")
    study.figure("one", figure)
    study.write("one")
    assert (tmp_path / "one.png").is_file()
    kept = near.replace(" %", "\u00a0%")  # where the title's lines are not broken
    assert figure.get_suptitle() == f"A spring\nAll 2 numbers are within tolerance; {kept}"
    study.check("off", 3.0, 1.0, "open", 1.0, "absolute")
    assert study.finding == "1 of 3 numbers are beyond their tolerance"


def test_the_page_names_what_uses_most_of_its_tolerance(tmp_path):
    study = Study(tmp_path / "two-circles")
    study.check("close", 1.001, 1.0, "closed", 0.1)
    study.check("closer to its limit", 1.05, 1.0, "closed", 0.1)
    study.check("off", 3.0, 1.0, "open", 1.0, "absolute")
    study.shown("odd", 2.0, 1.0, "closed", "unknown")
    study.write("two-circles")
    rows = [line for line in page(tmp_path).splitlines() if line.startswith("| `two-circles`")]
    assert rows == [
        "| `two-circles` | closed | 2 | closer to its limit | 1.05 | 1 | +5 % | 10 % | met |",
        "| `two-circles` | open | 1 | off | 3 | 1 | +2 | 1 | 1 of 1 not met |",
        "| `two-circles` | closed | 1 | odd | 2 | 1 | +100 % | – | not judged: unknown |",
    ]
    assert "| `elastica` |  |  |  |  |  |  |  | not run |" in page(tmp_path)
    before = "| `elastica` | of before |\n| `two-circles` | of before |\n"
    assert page(tmp_path, before) == page(tmp_path).replace(
        "| `elastica` |  |  |  |  |  |  |  | not run |", "| `elastica` | of before |"
    )


def test_the_page_shows_a_number_that_is_not_met(tmp_path):
    study = Study(tmp_path / "two-circles")
    study.check("near its limit", 1.09, 1.0, "closed", 0.1)
    study.check("off, and no deviation is allowed", 1.01, 1.0, "closed", 0.0, "absolute")
    study.check("off, and a bound", 6.001, 6.0, "closed", kind="at_most")
    study.write("two-circles")
    (row,) = [line for line in page(tmp_path).splitlines() if line.startswith("| `two-circles`")]
    assert "| off, and" in row
    assert row.endswith("| 2 of 3 not met |")


def test_a_case_that_stops_is_failed_on_the_page(tmp_path, monkeypatch, capsys):
    def stops(study):
        study.check("first", 1.0, 1.0, "closed", 0.1)
        raise SolveError("no equilibrium at step 3")

    monkeypatch.setattr(two_circles, "run", stops)
    assert verify(["two-circles"], tmp_path, fast=False, page_file=str(tmp_path / "page.md")) == 1
    assert not json.loads((tmp_path / "two-circles" / "record.json").read_text())["passed"]
    rows = [line for line in page(tmp_path).splitlines() if line.startswith("| `two-circles`")]
    assert rows[0].endswith("| met |")
    assert rows[1].endswith("| stopped: no equilibrium at step 3 |")
    assert (tmp_path / "page.md").read_text() == page(tmp_path)


def test_the_page_in_docs_names_every_case():
    text = (Path(__file__).resolve().parents[2] / "docs" / "verification.md").read_text(encoding="utf-8")
    for case in map(registry.load, registry.names()):
        assert f"- **{case.name}**" in text
        assert case.title in text


def test_the_page_in_docs_gives_the_reason_for_each_case_that_is_not_met():
    text = (Path(__file__).resolve().parents[2] / "docs" / "verification.md").read_text(encoding="utf-8")
    off = {line.split("`")[1] for line in text.splitlines() if line.startswith("| `") and "not met |" in line}
    assert off == {name for name in registry.names() if registry.load(name).unmet}
    assert [name for name in off if f"*Not met*: {registry.load(name).unmet}" not in text] == []
