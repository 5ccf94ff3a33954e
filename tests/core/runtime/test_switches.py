"""What makes a command start faster changes none of its results."""

import json
import os
import subprocess
import sys

import pytest

from coilset.model.core.runtime.switches import SAVINGS, enabled

PROGRAM = "loading=[{to: {travel: 8}, steps: 3}, {to: {force: 0}, steps: 2}]"
SMALL = ["--set", "mesh.elements_per_turn=8", "--set", "accuracy=none", "--set", PROGRAM]


@pytest.mark.parametrize("name", SAVINGS)
def test_each_saving_can_be_left_out(monkeypatch, name):
    monkeypatch.setenv("COILSET_WITHOUT", f"{name},another")
    assert [other for other in SAVINGS if not enabled(other)] == [name]


def test_a_run_without_any_saving_has_the_same_numbers(example, tmp_path):
    for out, without in (("with", ""), ("without", "all")):
        command = [sys.executable, "-m", "coilset.scripts", "solve", str(example), *SMALL, "--no-pictures"]
        environment = {**os.environ, "COILSET_WITHOUT": without}
        done = subprocess.run([*command, "--out", str(tmp_path / out)], env=environment, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
    results = [json.loads((tmp_path / out / "summary.json").read_text()) for out in ("with", "without")]
    for summary in results:
        del summary["origin"]["date"]
    assert results[0] == results[1]
    assert (tmp_path / "with" / "history.csv").read_text() == (tmp_path / "without" / "history.csv").read_text()
