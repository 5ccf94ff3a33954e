"""Names and words of files are shown as they are: no markup, no formula."""

import csv
import io

import pytest
from matplotlib.figure import Figure
from typer.testing import CliRunner

from coilset.model.core.base.columns import as_text
from coilset.model.core.base.style import as_written
from coilset.model.core.material.library import FOLDER
from coilset.model.core.results.files.folder import write_table
from coilset.model.tools.figures.png import save
from coilset.scripts.main import app
from coilset.scripts.terminal.console import Console, styled, table

NAMES = ["a[/red]", "[bold red]x", "[link=http://x]y[/link]", "[a4]", "\\[b]", "$\\frac{a$", "x^", "a_b$c"]


def printed(thing):
    console = Console(file=io.StringIO(), width=200)
    console.print(thing)
    return console.file.getvalue()


@pytest.mark.parametrize("name", NAMES)
def test_the_console_reads_no_markup(name):
    assert name in printed(name)
    assert name in printed(styled("bold", name, f" {name}"))
    assert printed(table([name, "value"], [[name, name]], title=name)).count(name) == 4
    console = Console(file=io.StringIO(), width=200)
    console.pairs([(name, name)])
    console.warn(name)
    assert console.file.getvalue().count(name) == 3


@pytest.mark.parametrize("name", NAMES)
def test_a_material_is_shown_by_its_own_words(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    text = (FOLDER / "ck15.yaml").read_text(encoding="utf-8").replace("name: ck15", f"name: '{name}'", 1)
    assert name in text
    (tmp_path / "own.yaml").write_text(text, encoding="utf-8")
    done = CliRunner().invoke(app, ["material", "show", "own.yaml", "--out", "out"], catch_exceptions=False)
    assert done.exit_code == 0
    assert name in done.output
    assert (tmp_path / "out" / "functions.png").stat().st_size > 10_000


@pytest.mark.parametrize("name", NAMES)
def test_a_picture_has_names_as_letters(tmp_path, name):
    figure = Figure()
    axes = figure.add_subplot()
    axes.loglog([1.0, 1e3], [1.0, 1e4], label=name)
    axes.set(title=name, xlabel=name)
    axes.legend()
    save(figure, tmp_path / "a.png")
    assert (tmp_path / "a.png").stat().st_size > 5_000
    as_written(figure)
    assert axes.xaxis.get_majorticklabels()[1].get_parse_math()  # powers of ten are still formulas


FORMULAS = ['=HYPERLINK("http://x","y")', "+1+2", "@SUM(1)", "-2+3+cmd|' /C calc'!A0", "\t=1", " =1"]
PLAIN = ["-", "-5.2", "+1e3", "-1,5", "a=b", "", "–", -1.5, 3, None]


def test_a_table_has_no_formulas(tmp_path):
    write_table(tmp_path / "a.csv", ["=name"], [[cell] for cell in FORMULAS])
    head, *rows = csv.reader(io.StringIO((tmp_path / "a.csv").read_text()))
    assert head == ["'=name"]
    assert [cell for (cell,) in rows] == [f"'{cell}" for cell in FORMULAS]
    assert as_text(PLAIN) == PLAIN


def test_a_sheet_as_table_has_no_formulas(example, tmp_path):
    words = [
        "--set",
        f"sheet={{customer: '{FORMULAS[0]}', part: '@SUM(1)'}}",
        "--wire",
        "EN 10270-1 SH",
        "--no-pictures",
    ]
    target = tmp_path / "s.csv"
    done = CliRunner().invoke(app, ["sheet", str(example), *words, "--out", str(target)], catch_exceptions=False)
    assert done.exit_code == 0, done.output
    cells = [cell for row in csv.reader(io.StringIO(target.read_text(encoding="utf-8-sig"))) for cell in row]
    assert f"'{FORMULAS[0]}" in cells
    assert "'@SUM(1)" in cells
