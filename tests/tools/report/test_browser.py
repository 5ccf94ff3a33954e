"""The pages in a real browser: no serious finding of axe-core, all by keyboard, and a thousand cases at hand.

A machine without Chromium skips these. COILSET_WEBDRIVER names the address of a driver that runs elsewhere. The rules
of axe-core are asked for where COILSET_AXE names its file axe.min.js (npm install axe-core).
"""

import csv
import json
import os
from contextlib import closing
from pathlib import Path

import pytest
import yaml
from browser import ENTER, TAB, chromium, missing

from coilset.model.core.results.files.opened import open_run
from coilset.model.tools.report.design_page import write_design_report
from coilset.model.tools.report.run_page import write_report
from coilset.model.tools.report.sweep_page import write_sweep_report
from coilset.model.tools.sweep import dataset
from coilset.model.tools.sweep.journal import Journal
from coilset.model.tools.sweep.plan import Plan
from coilset.scripts.commands.design import design

DRIVER, AXE = os.environ.get("COILSET_WEBDRIVER", ""), os.environ.get("COILSET_AXE", "")
pytestmark = pytest.mark.skipif(not DRIVER and bool(missing()), reason=missing())
CASES = 1000
FILTERS = "[...document.querySelectorAll('#cases input')]"
COUNT = "return document.getElementById('count').textContent"
CASE = {
    "spring": {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 1.5, "pitch": 12.0},
    "loading": [{"to": {"travel": 6}}],
}


@pytest.fixture(scope="module")
def browser():
    with chromium(DRIVER) as one:
        yield one


@pytest.fixture(scope="module")
def run_page(folder):
    return write_report(open_run(folder))


@pytest.fixture(scope="module")
def sweep_page(tmp_path_factory):
    """A thousand cases whose records are known: the set of case k is k mm, and every tenth failed."""
    out = tmp_path_factory.mktemp("thousand")
    (out / "case.yaml").write_text(yaml.safe_dump(CASE | {"limits": {"set_mm": [100, 900]}}))
    vary = {"spring.pitch": {"from": 11.0, "to": 13.0, "count": CASES}}
    (out / "sweep.yaml").write_text(yaml.safe_dump({"case": "case.yaml", "vary": vary}))
    plan = Plan(out / "sweep.yaml")
    with closing(Journal(out / "journal.jsonl")) as journal:
        for number, key in enumerate(plan.keys, 1):
            failed = number % 10 == 0
            steps = {name: [0.0, 0.0] for name in dataset.CURVE}
            steps |= {"travel_mm": [2.0, 6.0], "force_N": [80.0, 0.2 * number]}
            journal.append(
                {
                    "key": key,
                    "status": "failed" if failed else "done",
                    "reason": "too long" if failed else "",
                    "summary": {} if failed else {"set_mm": float(number), "force_max_N": 0.2 * number},
                    "steps": steps,
                    "seconds": 1.0,
                }
            )
    dataset.write(out / "sweep.nc", dataset.collect(plan, out))
    return write_sweep_report(out)


@pytest.fixture(scope="module")
def design_page(tmp_path_factory):
    """The height to which a spring must be pressed for its length, and what else could be had."""
    folder = tmp_path_factory.mktemp("design")
    loading = [{"to": {"height": 16.0}, "steps": 3}, {"to": {"force": 0}, "steps": 2}]
    entries = {
        **CASE,
        "ends": "clamped",
        "mesh": {"elements_per_turn": 6, "section": {"radial": 2, "angular": 4}},
        "loading": loading,
        "find": {"loading.0.to.height": [14.0, 19.0]},
        "such_that": {"free_length_after_mm": 18.0},
        "trade_offs": {"spring.pitch": [11.0, 13.0]},
    }
    (folder / "design.yaml").write_text(yaml.safe_dump(entries))
    design(folder / "design.yaml", str(folder / "out"), False, False)
    return write_design_report(folder / "out")


def until(browser, script):
    """A script's answer, asked for until it is true."""
    for _ in range(200):
        if found := browser.run(script):
            return found
    raise AssertionError(script)


def drawn(browser):
    """Draw each figure, as printing does, and go back to the screen's widths."""
    browser.run("window.dispatchEvent(new Event('beforeprint'))")
    until(
        browser,
        "return [...document.querySelectorAll('.plot')].filter((one) => one.offsetParent)"
        ".every((one) => one.querySelector('svg'))",
    )
    browser.run("window.dispatchEvent(new Event('afterprint'))")


@pytest.mark.skipif(not Path(AXE).is_file(), reason="COILSET_AXE names no axe.min.js")
@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
@pytest.mark.parametrize("width", [390, 1280], ids=["phone", "desk"])
@pytest.mark.parametrize("page", ["run_page", "sweep_page", "design_page"])
def test_no_serious_finding_of_axe(request, browser, page, width, dark):
    browser.look(width, dark=dark)
    browser.open(request.getfixturevalue(page))
    drawn(browser)
    until(browser, f"return document.documentElement.scrollWidth <= {width}")  # nothing sticks out to the side
    browser.run(Path(AXE).read_text(encoding="utf-8"))
    found = browser.wait("axe.run()")
    assert len(found["passes"]) > 20
    assert [
        (one["id"], one["nodes"][0]["html"]) for one in found["violations"] if one["impact"] in ("serious", "critical")
    ] == []


def test_a_run_by_keyboard(browser, run_page):
    """Each control is reached by Tab, in the order of the page; the glossary opens on focus, the theme on Enter."""
    browser.look(1280)
    browser.open(run_page)
    wanted = browser.run(
        "return document.querySelectorAll('a[href], button, select, summary, [tabindex=\"0\"]').length"
    )
    seen = []
    for _ in range(wanted + 5):
        browser.press(TAB)
        seen.append(
            browser.run(
                "const e = document.activeElement; return (e.className || e.tagName) + (e.id || '') + "
                "[...document.querySelectorAll(e.tagName)].indexOf(e)"
            )
        )
        if seen[-1].startswith("term") and not any(one.startswith("term") for one in seen[:-1]):
            about = "getComputedStyle(document.activeElement.querySelector('.about'))"
            assert browser.run(f"return {about}.display") == "block"
        if "theme" in seen[-1] and browser.run("return document.documentElement.dataset.theme") is None:
            browser.press(ENTER)
            assert browser.run("return document.documentElement.dataset.theme") == "dark"
    closed = browser.run("return document.querySelectorAll('details:not([open]) [tabindex=\"0\"]').length")
    assert len(set(seen) - {"BODY0"}) >= wanted - closed
    assert seen[0].startswith("skip")


def test_one_of_a_thousand_is_found_and_opened_by_keyboard(browser, sweep_page):
    browser.look(1280)
    assert browser.open(sweep_page) < 20.0  # hangs nowhere; the page on reports says how long it takes
    browser.run(f"{FILTERS}.find((one) => one.ariaLabel === 'filter set, mm').focus()")
    browser.press(*"730..740")
    assert browser.run(COUNT) == "9 of 1000 cases"  # 730 and 740 failed
    browser.run("[...document.querySelectorAll('.sort')].find((one) => one.textContent === 'set, mm').focus()")
    browser.press(ENTER, ENTER)
    opens = "[...document.querySelectorAll('#cases .open')].map((one) => one.textContent)"
    assert browser.run(f"return {opens}") == [str(number) for number in range(739, 730, -1)]
    browser.run("document.querySelectorAll('#cases .open')[3].focus()")
    browser.press(ENTER)
    assert browser.run("return document.activeElement.textContent") == "Case 736"
    case = json.loads(browser.run("return document.getElementById('case').textContent"))
    pitch = 11.0 + 2.0 * 735 / (CASES - 1)
    assert case["spring"] == CASE["spring"] | {"pitch": pytest.approx(pitch, rel=1e-14)}
    numbers = browser.run("return document.getElementById('numbers').textContent")
    assert "set, mm736" in numbers
    assert "147.2" in numbers  # its force


def test_limits_have_their_table_and_histogram(browser, sweep_page):
    browser.look(1280)
    browser.open(sweep_page)
    row = browser.run("return document.querySelector('[aria-label=\"limits and capability\"] tbody').innerText")
    assert row.split("\t")[:2] == ["set", "100 to 900 mm"]
    assert "tighten" in row
    drawn(browser)
    figure = "document.getElementById('limits_set_mm')"
    notes = browser.run(f"return [...{figure}.querySelectorAll('.annotation-text')].map((one) => one.textContent)")
    assert notes == ["100", "900"]
    assert browser.run(f"return {figure}.querySelector('.scatterlayer path.js-line').getBBox().height") > 100


def test_a_failed_case_shows_the_reason(browser, sweep_page):
    browser.look(390)
    browser.open(sweep_page)
    browser.run(
        f"const f = {FILTERS}.find((one) => one.ariaLabel === 'filter status');"
        "f.value = 'fail'; f.dispatchEvent(new Event('input'))"
    )
    assert browser.run(COUNT) == "100 of 1000 cases"
    browser.run("document.querySelector('#cases .open').click()")
    assert browser.run("return document.getElementById('reason').textContent") == "too long"


def test_the_first_printed_sheet_has_the_makers_data(browser, run_page):
    """Data, verdict, drawing and characteristic fit on A4 with margins of 12 mm, 186 by 273 mm."""
    browser.look(703)
    browser.open(run_page)
    try:
        browser.command("Emulation.setEmulatedMedia", media="print")
        browser.run("window.dispatchEvent(new Event('beforeprint'))")
        until(browser, "return document.querySelector('.first #characteristic svg') !== null")
        text = browser.run("return document.querySelector('.first').innerText")
        for part in ("wire diameter d", "free length as wound", "Not known: τ at solid"):
            assert part in text
        assert 600 < browser.run("return document.querySelector('.first').getBoundingClientRect().bottom") < 1032
    finally:
        browser.command("Emulation.setEmulatedMedia", media="")
        browser.run("window.dispatchEvent(new Event('afterprint'))")
    assert browser.run("return document.querySelector('.first #characteristic')") is None
    assert browser.run("return document.querySelector('.figures #characteristic') !== null")
    assert browser.run("return getComputedStyle(document.querySelector('.first')).display") == "none"


def test_the_cases_that_pass_the_filters_are_saved_as_csv(browser, sweep_page):
    browser.look(1280)
    browser.open(sweep_page)
    browser.run(
        f"const f = {FILTERS}.find((one) => one.ariaLabel === 'filter set, mm');"
        "f.value = '731..733'; f.dispatchEvent(new Event('input'))"
    )
    browser.run(
        "document.getElementById('table').addEventListener('click', (event) => event.preventDefault());"
        "document.getElementById('table').click()"
    )
    text = browser.wait("fetch(document.getElementById('table').href).then((answer) => answer.text())")
    head, *rows = csv.reader(text.splitlines())
    assert [float(row[head.index("set_mm")]) for row in rows] == [731.0, 732.0, 733.0]
    assert rows[0][head.index("status")] == "done"
    assert len(head) == len(rows[0])
