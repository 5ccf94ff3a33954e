"""What README.md shows is what comes out: its Python snippet, run, prints the numbers under "What comes out"."""

import itertools
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from coilset.model.core.case import read_case
from coilset.model.tools.sweep.rehearsal import build_input
from coilset.scripts.commands import test as suite

REPOSITORY = Path(__file__).resolve().parents[2]
README = (REPOSITORY / "README.md").read_text(encoding="utf-8")


def test_commands_follow_each_other():
    """None meets the results of one before it, unless it says what is to be done with them, and each can be built."""
    lines = re.findall(r"^    scripts/coilset (.*?)(?: +#.*)?$", README, re.MULTILINE)
    solves = [words for words in map(shlex.split, lines) if "solve" in words]
    assert len(solves) >= 5
    taken = set()
    for words in solves:
        option = dict(itertools.pairwise(words))
        case = REPOSITORY / option["solve"]
        folder = option.get("--out", f"results/{case.stem}")
        assert folder not in taken or {"--overwrite", "--resume"} & set(words), words
        assert folder in taken or not {"--overwrite", "--resume"} & set(words), words
        taken.add(folder)
        settings = [value for word, value in itertools.pairwise(words) if word == "--set"]
        build_input(read_case(case, settings))


def test_readme_states_the_time_of_the_tests(monkeypatch, capsys):
    monkeypatch.setattr(suite, "usable_cores", lambda: 1)
    monkeypatch.setattr(suite, "run", lambda *_: 0)
    assert suite.test([]) == 0
    (told,) = re.findall(r"\w+ minutes on two cores", capsys.readouterr().out)
    assert told in " ".join(README.split())


def stated(words):
    """The number that README gives for a line of the summary."""
    return float(re.search(rf"^ +{words} +(\S+)", README, re.MULTILINE)[1])


def test_the_python_snippet_gives_the_stated_numbers(tmp_path):
    """As README says: saved in a file and run. Force in N and travel in mm of every step, then set and stress."""
    (snippet,) = re.findall(r"^```python\n(.*?)^```$", README, re.MULTILINE | re.DOTALL)
    (tmp_path / "set.py").write_text(snippet, encoding="utf-8")
    done = subprocess.run([sys.executable, "set.py"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    *steps, (set_mm, residual) = [tuple(map(float, line.split())) for line in done.stdout.splitlines()]
    assert max(force for _, force in steps) == pytest.approx(stated("maximum force"), abs=0.05)
    assert set_mm == pytest.approx(stated("set"), abs=0.005)
    assert residual == pytest.approx(stated("maximum residual shear stress"), abs=0.05)
    before = stated("free length") + stated("set")
    assert before == pytest.approx(2.5 * 12.0 + 5.0, abs=1e-9)
    assert max(travel for travel, _ in steps) == pytest.approx(before - stated("block height"), abs=1e-9)
    # the initial rate is the tangent, before the wire flows: the chord of the first step, 1.09 mm, lies below it
    assert 0.8 * stated("initial rate") < steps[0][1] / steps[0][0] < stated("initial rate")
