"""Each package of physics and of tools can be deleted: a copy without it solves a spring to the same numbers."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))
import rooms

PACKAGES = sorted(name for name in rooms.plan()["rooms"] if rooms.floor_of(name) in rooms.PACKAGES)
USED = {"accuracy", "further_runs", "limits", "outlines", "reactions", "stability", "standards", "warping", "wires"}
"""Packages that every run is without if they are deleted, or if those are that they are built on."""
SMALL = [
    "mesh.elements_per_turn=4",
    "mesh.section={radial: 2, angular: 8}",
    "loading=[{to: block, steps: 8}, {to: {force: 0}, steps: 6}]",  # `accuracy` controls automatic ones
]


def copy_without(packages, folder):
    """A copy of the program in which the files of packages are missing."""
    root = folder / "coilset"
    for path in rooms.sources():
        if rooms.room_of(path) not in packages:
            (root / path).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(rooms.ROOT / path, root / path)
    for top in rooms.TOPS:
        for path in (rooms.ROOT / top).rglob("*"):
            to = root / path.relative_to(rooms.ROOT)
            if path.is_file() and path.suffix != ".py" and to.parent.is_dir():
                shutil.copy(path, to)
    shutil.copy(rooms.ROOT / "__init__.py", root)
    return root


SOLVE = """
import json, sys
from pathlib import Path
from coilset.model.compose.analysis import Analysis
from coilset.model.compose.run_files import write_run
from coilset.model.compose.summary import summarise
from coilset.model.core.case import read_case
from coilset.model.core.results.records.provenance import origin
analysis = Analysis(read_case(sys.argv[1], sys.argv[2:]))
result = analysis.run()
write_run(Path("out"), analysis.setup, result, summarise(analysis.setup, result), origin(analysis.case))
"""


def solved(folder, example):
    """Summary and history of the example, solved by the copy in a folder."""
    (folder / "out").mkdir()
    environment = os.environ | {"PYTHONPATH": str(folder)}
    command = [sys.executable, "-c", SOLVE, str(example), *SMALL]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    summary = json.loads((folder / "out" / "summary.json").read_text())
    return summary, (folder / "out" / "history.csv").read_text().splitlines()


@pytest.fixture(scope="module")
def whole(tmp_path_factory, example):
    folder = tmp_path_factory.mktemp("whole")
    copy_without((), folder)
    return solved(folder, example)


def check(packages, whole, folder, example):
    """The numbers that remain are equal to the bit, and one line says what the run lacks."""
    copy_without(packages, folder)
    (theirs, steps), (summary, history) = whole, solved(folder, example)
    different = {
        name: (value, theirs[name])
        for name, value in summary.items()
        if name not in ("origin", "warnings") and value != theirs[name] and value is not None
    }
    assert different.keys() <= {"estimated_errors"}
    lacks = [one["message"] for one in summary["warnings"] if one["name"] == "packages"]
    assert len(lacks) == bool(USED & set(packages))
    header = history[0].split(",")
    assert header == steps[0].split(",")
    for mine, other in zip(history[1:], steps[1:], strict=True):
        pairs = zip(header, mine.split(","), other.split(","), strict=True)
        assert [name for name, one, two in pairs if one not in (two, "")] == []


@pytest.mark.slow
@pytest.mark.parametrize("package", PACKAGES)
def test_a_run_without_a_package_has_the_same_numbers(package, whole, tmp_path, example):
    check((package,), whole, tmp_path, example)


def test_a_run_without_any_package_has_the_same_numbers(whole, tmp_path, example):
    check(PACKAGES, whole, tmp_path, example)


@pytest.mark.slow
def test_the_cores_own_tests_pass_without_any_package(tmp_path):
    """Those that need a package by its name in a case are refused, and skipped by tests/conftest.py: a fifth."""
    root = copy_without(PACKAGES, tmp_path)
    for name in ("examples", "docs", "tests/core"):
        shutil.copytree(rooms.ROOT / name, root / name, dirs_exist_ok=True)
    for name in ("tests/conftest.py", "tests/rate_equations.py", "pyproject.toml"):
        shutil.copy(rooms.ROOT / name, root / name)
    command = [sys.executable, "-m", "pytest", "-q", "-m", "not mpi and not slow", "tests/core"]
    environment = os.environ | {"PYTHONPATH": str(tmp_path)}
    done = subprocess.run(command, cwd=root, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout
    counts = {word: int(count) for count, word in re.findall(r"(\d+) (passed|skipped)", done.stdout)}
    assert counts["skipped"] < 0.2 * counts["passed"]
