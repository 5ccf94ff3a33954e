"""What only some commands need is an extra: a run does without it, and a command that needs it says how to get it."""

import json
import os
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from coilset.model.core.base.errors import EXTRAS

REPOSITORY = Path(__file__).resolve().parents[2]
DISTRIBUTIONS = {"PIL": "pillow", "vtkmodules": "vtk"}  # that have another name than their modules
SMALL = ["mesh.elements_per_turn=4", "mesh.section={radial: 2, angular: 8}", "loading=[{to: {travel: 1}, steps: 1}]"]
MISSING = "raise ModuleNotFoundError(f'No module named {__name__!r}', name=__name__)\n"


def coilset(folder, extra, *words):
    """Run a command where the modules of an extra, or of all, are not installed."""
    modules = EXTRAS[extra] if extra else [module for group in EXTRAS.values() for module in group]
    (folder / "lacks").mkdir(exist_ok=True)
    for module in modules:
        (folder / "lacks" / f"{module}.py").write_text(MISSING)
    environment = os.environ | {"PYTHONPATH": f"{folder / 'lacks'}:{os.environ['PYTHONPATH']}"}
    command = [sys.executable, "-m", "coilset.scripts", *map(str, words)]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)


def test_the_extras_are_those_of_the_package():
    with open(REPOSITORY / "pyproject.toml", "rb") as file:
        extras = tomllib.load(file)["project"]["optional-dependencies"]
    listed = {
        name: {one.partition(">")[0] for one in group if not one.startswith("coilset")}
        for name, group in extras.items()
    }
    assert listed.pop("all") == set()
    assert listed == {name: {DISTRIBUTIONS.get(one, one) for one in modules} for name, modules in EXTRAS.items()}


def test_a_run_needs_none_of_them(tmp_path, example):
    settings = [word for one in SMALL for word in ("--set", one)]
    done = coilset(tmp_path, None, "solve", example, "--out", "out", *settings)
    assert done.returncode == 0, done.stderr
    said = " ".join((done.stdout + done.stderr).split())
    assert "fields for ParaView are not written: this needs meshio, which is not installed" in said
    assert "no pictures are drawn: this needs" in said
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["complete"]


@pytest.mark.parametrize(
    ("extra", "library", "words"),
    [
        ("report", "jinja2", ["report", "out"]),
        ("pictures", "matplotlib", ["mesh", "case.yaml", "--out", "there"]),
        ("mesh", "gmsh", ["slice", "case.yaml"]),
        ("modes", "slepc4py", ["modes", "out"]),
    ],
)
def test_a_command_that_lacks_one_ends_in_a_line(extra, library, words, tmp_path, example, small_run):
    (tmp_path / "case.yaml").write_text(example.read_text())
    (tmp_path / "out").symlink_to(small_run)
    done = coilset(tmp_path, extra, *words)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1), done.stderr
    assert f"this needs {library}, which is not installed: pip install 'coilset[{extra}]'" in done.stderr


@pytest.fixture(scope="module")
def small_run(tmp_path_factory, example):
    folder = tmp_path_factory.mktemp("run")
    settings = [word for one in SMALL for word in ("--set", one)]
    done = coilset(folder, "search", "solve", example, "--out", "out", "--no-pictures", *settings)
    assert done.returncode == 0, done.stderr
    return folder / "out"
