"""The tutorial's files, as they stand on its pages, give the numbers that stand beside them."""

import re
from math import atanh, tanh
from pathlib import Path

import numpy as np
import pytest
import yaml

from coilset.model.analysis import Analysis
from coilset.model.case import check, read_case
from coilset.model.material import library, programs
from coilset.model.results.summary import summarise
from coilset.model.sweep.plan import Plan

PAGES = {path.stem: path.read_text(encoding="utf-8")
         for path in (Path(__file__).resolve().parents[2] / "docs/tutorial").glob("*.md")}  # fmt: skip
LINES = {"free length before": "free_length_before_mm", "free length after": "free_length_after_mm", "set": "set_mm",
         "initial rate": "rate_N_per_mm", "greatest force": "force_max_N", "block height": "block_height_mm",
         "greatest residual shear stress": "residual_shear_max_MPa",
         "residual shear stress, coil's inside": "residual_shear_inside_MPa"}  # fmt: skip


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
    analysis = Analysis(case)
    result = analysis.run()
    return summarise(analysis.setup, result)


def compare(page, summary):
    """Every line of a summary on the page, to its last digit."""
    stated = dict(re.findall(r"^      (\S.*?)  +(-?[\d.]+) (?:mm|N|N/mm|MPa)$", PAGES[page], re.MULTILINE))
    stated = {words: number for words, number in stated.items() if words in LINES}
    assert len(stated) >= 7
    digits = {words: len(number.partition(".")[2]) for words, number in stated.items()}
    wrong = [words for words, number in stated.items()
             if abs(summary[LINES[words]] - float(number)) > 0.51 * 10.0 ** -digits[words]]  # fmt: skip
    assert {words: f"{summary[LINES[words]]:.{digits[words]}f}" for words in wrong} == {}


def test_my_first_spring(folder):
    compare("first-spring", solved(read_case(folder / "first.yaml")))


def test_my_own_steel_in_tension(folder):
    """Against the formula of the page, which is another way to the same stress."""
    law = library.load(folder / "my_steel.yaml")
    history = programs.run(law, programs.read(folder / "tension.yaml"))
    end = np.flatnonzero(history.step == 0)[-1]
    stress, strain = history.stress[end, 0], history.strain[-1, 0]
    assert stress == pytest.approx(1700 * tanh(atanh(1300 / 1700) + 0.5 * 0.15 * 1700 * strain), rel=2e-4)
    assert f"{stress:.1f}" in PAGES["own-steel"]
    assert f"{strain:.5f}" in PAGES["own-steel"]


def test_the_spring_of_my_own_steel(folder):
    steel = f"material={folder / 'my_steel.yaml'}"
    compare("own-steel", solved(read_case(folder / "first.yaml", [steel, "spring.pitch=14"])))


def test_the_study_of_many_springs(folder):
    """Its two cases at a pitch of 13 mm: what the wire's tolerance does."""
    plan = Plan(folder / "study.yaml")
    assert len(plan) == 10
    thin, thick = (solved(check(plan.data(row))) for row in plan.rows if row[0] == 13.0)
    page = PAGES["many-springs"]
    assert f"{thin['free_length_after_mm'] - thick['free_length_after_mm']:.2f} mm shorter" in page
    assert f"by {thick['set_mm']:.2f} instead of {thin['set_mm']:.2f} mm" in page
    assert yaml.safe_load((folder / "study.yaml").read_text())["vary"]["spring.wire_diameter"]["values"] == [3.9, 4.1]
