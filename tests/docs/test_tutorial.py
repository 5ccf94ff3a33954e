"""The tutorial's files, as they stand on its pages, give the numbers that stand beside them."""

import re
from math import atanh, tanh
from pathlib import Path

import numpy as np
import pytest
import yaml

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.summary import summarise
from coilset.model.core.case import check, read_case
from coilset.model.core.material import library
from coilset.model.core.results.quantities import ALONG, ENTRIES
from coilset.model.tools.identification import programs
from coilset.model.tools.sweep.plan import Plan

PAGES = {
    path.stem: path.read_text(encoding="utf-8")
    for path in (Path(__file__).resolve().parents[2] / "docs/tutorial").glob("*.md")
}
LINES = {ENTRIES[name][0]: name for name in ALONG if name in ENTRIES}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The files of all three parts, in one folder."""
    folder = tmp_path_factory.mktemp("tutorial")
    names = {"first-spring": ["first"], "own-steel": ["my_steel", "tension"], "many-springs": ["study"]}
    for page, files in names.items():
        blocks = re.findall(r"^```yaml\n(.*?)^```$", PAGES[page], re.MULTILINE | re.DOTALL)
        for name, block in zip(files, blocks, strict=True):
            (folder / f"{name}.yaml").write_text(block, encoding="utf-8")
    return folder


def solved(case):
    analysis = Analysis(case, estimates=False)
    result = analysis.run()
    return summarise(analysis.setup, result)


def compare(page, summary):
    """Every line of a summary on the page, within 0.3 %: the steps are chosen for an accuracy of 0.2 %."""
    stated = dict(
        re.findall(r"^      (\S.*?)  +(-?[\d.]+)(?: ± [\d.]+)? (?:mm|N|N/mm|MPa)(?:  .*)?$", PAGES[page], re.MULTILINE)
    )
    stated = {LINES[words]: float(number) for words, number in stated.items() if words in LINES}
    assert len(stated) >= 7
    assert {entry: summary[entry] for entry in stated} == pytest.approx(stated, rel=3e-3)


def test_my_first_spring(folder):
    compare("first-spring", solved(read_case(folder / "first.yaml")))


def test_my_own_steel_in_tension(folder):
    """Against the formula of the page, which is another way to the same stress."""
    law = library.load(folder / "my_steel.yaml")
    history = programs.run(law, programs.read(folder / "tension.yaml"))
    end = np.flatnonzero(history.step == 0)[-1]
    stress, strain = history.stress[end, 0], history.strain[-1, 0]
    assert stress == pytest.approx(1700 * tanh(atanh(1300 / 1700) + 0.5 * 0.15 * 1700 * strain), rel=2e-4)
    stated = re.findall(r"^ +1 tension +0.02 +([\d.]+)|^ +2 release +([\d.]+)", PAGES["own-steel"], re.MULTILINE)
    assert (stress, strain) == pytest.approx((float(stated[0][0]), float(stated[1][1])), rel=3e-3)


def test_the_spring_of_my_own_steel(folder):
    steel = f"material={folder / 'my_steel.yaml'}"
    compare("own-steel", solved(read_case(folder / "first.yaml", [steel, "spring.pitch=14"])))


def test_one_press_to_a_reliable_set():
    """Constants of the page are those of the shipped wire; its set at a third height, and the measured one beside."""
    page, examples = PAGES["one-press"], Path(__file__).resolve().parents[2] / "examples"
    third = examples / "compare/third_height"
    tables = re.findall(r"constant +value.*?tester's errors", page, re.DOTALL)
    stated = dict(re.findall(r"^ +(\w+) +([\d.]+) ", tables[1], re.MULTILINE))
    assert yaml.safe_load((third / "my_wire.yaml").read_text())["temperatures"][0]["elasticity"]["G"] == pytest.approx(
        float(stated["G"]), rel=1e-5
    )
    first, second = map(float, re.findall(r"^ +set +([\d.]+) ±", page, re.MULTILINE))
    measured = float(re.findall(r"set_mm,([\d.]+)", (third / "measured.csv").read_text())[0])
    assert f"set_mm,{measured}," in page
    assert f"sets by {measured} mm" in page
    assert f"prediction was {100 * (first / measured - 1):.1f} % too much" in page
    assert f"off by {100 * (1 - second / measured):.1f} %" in page
    settings = [f"material={third / 'my_wire.yaml'}", "loading.0.to={height: 17}", "accuracy=none"]
    settings += ["loading.0.steps=24", "loading.1.steps=8"]
    case = read_case(examples / "material/springs/spring.yaml", settings)
    assert solved(case)["set_mm"] == pytest.approx(second, rel=3e-3)


def test_the_study_of_many_springs(folder):
    """Its two cases at a pitch of 13 mm: what the wire's tolerance does."""
    plan = Plan(folder / "study.yaml")
    assert len(plan) == 10
    thin, thick = (solved(check(plan.data(row))) for row in plan.rows if row[0] == 13.0)
    page = PAGES["many-springs"]
    shorter, more, less = map(float, re.findall(r"([\d.]+) mm shorter, .* by ([\d.]+) instead of ([\d.]+) mm", page)[0])
    assert thin["free_length_after_mm"] - thick["free_length_after_mm"] == pytest.approx(shorter, abs=0.01)
    assert (thick["set_mm"], thin["set_mm"]) == pytest.approx((more, less), abs=0.06)
    assert yaml.safe_load((folder / "study.yaml").read_text())["vary"]["spring.wire_diameter"]["values"] == [3.9, 4.1]
