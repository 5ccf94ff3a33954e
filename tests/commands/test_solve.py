"""`coilset solve` from outside: what it writes, and one clear line for every wrong input."""

import csv
import json
import os
import re
import subprocess
import sys

import pytest
import yaml

from coilset.model.core.base.errors import CoilsetError, InputError
from coilset.model.core.case import read_case

SHORT = ["--set", "loading=[{to: {travel: 6}, steps: 3}, {to: {force: 0}, steps: 2}]", "--no-pictures"]


def coilset(*arguments, cwd):
    command = [sys.executable, "-m", "coilset.scripts", *map(str, arguments)]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False)


def test_a_name_in_another_encoding_gets_one_line(tmp_path):
    done = subprocess.run(
        [sys.executable, "-m", "coilset.scripts", "solve", b"Feder\xe4.yaml"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert done.stderr == "coilset: Feder\\udce4.yaml: is not written in UTF-8; rename it\n"


DURING_A_CHECK_IS_BUILT = """
import os, signal, time
from pydantic import TypeAdapter
from coilset.scripts import running

class Entry:
    @classmethod
    def __get_pydantic_core_schema__(cls, source, handler):
        os.kill(os.getpid(), signal.SIGINT)
        print("built")
        return handler.generate_schema(int)

signal.signal(signal.SIGINT, signal.default_int_handler)  # tests in the background ignore it
running._listen()
try:
    TypeAdapter(Entry)
    time.sleep(60)
except KeyboardInterrupt:
    print("interrupted")
"""


def test_ctrl_c_while_the_check_of_an_entry_is_built_is_heard_after_it():
    """In the midst of it, pydantic makes an error of its own of the interruption."""
    done = subprocess.run([sys.executable, "-c", DURING_A_CHECK_IS_BUILT], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["built", "interrupted"]


def test_letters_that_the_output_lacks_are_replaced(example, tmp_path):
    done = subprocess.run(
        [sys.executable, "-m", "coilset.scripts", "sheet", example, "--no-pictures"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | {"PYTHONIOENCODING": "ascii"},
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert "wire length l" in done.stdout
    assert "? D n_t" in done.stdout  # for π


def test_solve_writes_what_the_readme_lists(example, tmp_path):
    done = coilset("solve", example, "--out", "here", *SHORT, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    summary = json.loads((tmp_path / "here" / "summary.json").read_text())
    rows = list(csv.DictReader((tmp_path / "here" / "history.csv").read_text().splitlines()))
    assert [float(row["travel_mm"]) for row in rows[:3]] == pytest.approx([2, 4, 6], abs=1e-9)
    assert {"seat_height_mm", "travel_mm", "force_N", "iterations", "contacts"} <= set(rows[0])
    shorter = summary["free_length_before_mm"] - summary["free_length_after_mm"]
    assert summary["set_mm"] == pytest.approx(shorter, abs=1e-12)
    assert summary["force_max_N"] == pytest.approx(max(float(row["force_N"]) for row in rows), rel=1e-12)
    assert summary["block_height_mm"] == pytest.approx(17.5, rel=1e-12)  # (2.5 + 1) wires of 5 mm
    assert summary["complete"]
    printed = dict(re.findall(r"^  (\S.*?)  +(\S+(?: ± \S+)? \S+)(?:  .*)?$", done.stdout, re.MULTILINE))
    for words, entry, of_error in (
        ("set", "set_mm", "estimated_set_error_mm"),
        ("free length", "free_length_after_mm", "estimated_set_error_mm"),
        ("maximum force", "force_max_N", "estimated_force_error_N"),
        ("initial rate", "rate_N_per_mm", "estimated_rate_error_N_per_mm"),
    ):
        value, _, error = printed[words].rpartition(" ")[0].partition(" ± ")
        assert summary[of_error] <= float(error)
        assert float(value) == pytest.approx(summary[entry], abs=float(error))
    assert printed["block height"] == "17.5 mm"
    assert printed["maximum residual shear stress"] == f"{summary['residual_shear_max_MPa']:.1f} MPa"
    again = coilset("solve", example, "--out", "here", *SHORT, cwd=tmp_path)
    assert again.returncode == 2
    assert "--overwrite" in again.stderr


WRONG = [
    ("material=ck99", "ck99"),
    ("spring.wire_diameter=-5", "spring.wire_diameter"),
    ("spring.wire_diameter=five millimetres", "spring.wire_diameter"),
    ("spring.wire_diametre=5", "unknown entry"),
    ("spring.pitch=4", "coils overlap"),  # the coils overlap: wire 5 mm
    ("spring.turns=.nan", "spring.turns"),
    ("mesh.elements_per_turn=2", "mesh.elements_per_turn"),
    ("mesh.section.rule=simpson", "mesh.section.rule"),
    ("loading.0.to=blok", "block"),
    ("ends=glued", "ends"),
    ("loading=[]", "loading"),
    ("loading.0.to.travel=1", "block"),  # `to: block` has no entries
    ("loading.7.steps=1", "0 to 1"),
    ("loading.0.to={travel: 1, force: 2}", "exactly one"),
    ("loading.0.to={travel: fast}", "travel"),
    ("loading.0.steps=0", "steps"),
    ("solver.tolerance=0", "solver.tolerance"),
    ("no-equals-sign", "key=value"),
    ("spring={wire_diameter: [", "YAML"),
]


@pytest.mark.parametrize(("setting", "words"), WRONG)
def test_wrong_settings_get_one_line(example, setting, words):
    with pytest.raises(CoilsetError, match=words.replace("=", ".")) as caught:
        read_and_build(example, setting)
    assert caught.value.exit_code == 2
    assert "\n" not in str(caught.value)


def read_and_build(example, setting):
    from mpi4py import MPI

    from coilset.model.compose.analysis import Analysis

    return Analysis(read_case(example, [setting]), MPI.COMM_SELF)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("spring: {wire_diameter: 5.0,\n  turns 3", "line"),
        ("- 1\n- 2", "entries"),
        ("material: ck15\nmaterial: ck15\n", "twice"),
        ("material: !!python/object/apply:os.system ['true']", "YAML"),
        ("material: ck15", "spring: this entry is required"),
        ("? [1, 2]\n: 3", "YAML"),
        ("5: 3\nspring: 1\nloading: 2", "spring"),
    ],
)
def test_wrong_files_get_one_line(tmp_path, text, words):
    file = tmp_path / "case.yaml"
    file.write_text(text)
    with pytest.raises(InputError, match=words) as caught:
        read_case(file)
    assert str(caught.value).startswith(str(file))
    assert "\n" not in str(caught.value)


def test_a_missing_file_and_a_wrong_option_leave_nothing_behind(tmp_path):
    for arguments in (["solve", "nowhere.yaml"], ["solve"], ["solve", "nowhere.yaml", "--fast"], ["solv"]):
        done = coilset(*arguments, cwd=tmp_path)
        assert done.returncode == 2, arguments
        assert len(done.stderr.strip().splitlines()) == 1, done.stderr
    assert list(tmp_path.iterdir()) == []


def test_an_impossible_target_keeps_the_results_and_ends_with_3(example, tmp_path):
    data = yaml.safe_load(example.read_text())
    data["ends"], data["loading"] = "clamped", [{"to": {"travel": 3}, "steps": 2}, {"to": {"force": 1e3}, "steps": 1}]
    data["contact"], data["accuracy"] = {"penetration_limit": 1e-4}, "none"
    data["mesh"] = {"elements_per_turn": 8, "section": {"rule": "abramowitz9"}}
    data["solver"] = {"control": {"steps": {"smallest": 0.05}}}
    (tmp_path / "case.yaml").write_text(yaml.safe_dump(data))
    done = coilset("solve", "case.yaml", "--no-pictures", cwd=tmp_path)
    assert done.returncode == 3
    assert len(done.stderr.strip().splitlines()) == 1
    assert "no equilibrium" in done.stderr
    summary = json.loads((tmp_path / "results" / "case" / "summary.json").read_text())
    assert not summary["complete"]
    assert summary["steps"] >= 2


def test_a_misspelt_entry_is_named_and_not_the_one_that_is_missing(example, tmp_path):
    file = tmp_path / "case.yaml"
    file.write_text(example.read_text().replace("wire_diameter:", "wire_diamter:"))
    with pytest.raises(InputError, match="wire_diamter: unknown entry; is wire_diameter meant"):
        read_case(file)
