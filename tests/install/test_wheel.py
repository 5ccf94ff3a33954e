"""The wheel is whole: built from a copy of the sources, installed in a folder of its own, used from elsewhere."""

import json
import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from coilset.model.core.base.version import __version__

REPOSITORY = Path(__file__).resolve().parents[2]
ROOMS = ("model", "meshes", "verification", "scripts", "examples")
COARSE = "loading=[{to: {travel: 4}, steps: 2}]", "mesh.elements_per_turn=8", "accuracy=none"
SHORT = [*(word for entry in COARSE for word in ("--set", entry)), "--no-pictures"]

pytest.importorskip("pip")


def run(command, cwd, **environment):
    words, environment = list(map(str, command)), os.environ | environment
    done = subprocess.run(words, cwd=cwd, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_every_package_is_in_the_list():
    """A package that pyproject.toml does not name is missing in the wheel."""
    with open(REPOSITORY / "pyproject.toml", "rb") as file:
        listed = tomllib.load(file)["tool"]["setuptools"]["packages"]
    there = {path.parent.relative_to(REPOSITORY) for room in ROOMS for path in (REPOSITORY / room).rglob("*.py")}
    assert sorted(listed) == ["coilset", *sorted(".".join(("coilset", *folder.parts)) for folder in there)]


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """The folder that the wheel is installed in."""
    folder = tmp_path_factory.mktemp("wheel")
    for room in ROOMS:
        shutil.copytree(REPOSITORY / room, folder / "source" / room, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "README.md", "__init__.py", "api.py", "open.py", "py.typed"):
        shutil.copy(REPOSITORY / name, folder / "source")
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check"]
    offline = ["--no-deps", "--no-index"]
    run([*pip, "wheel", *offline, "--no-build-isolation", "--wheel-dir", folder, folder / "source"], folder)
    (wheel,) = folder.glob("*.whl")
    assert wheel.name.startswith(f"coilset-{__version__}-")
    run([*pip, "install", *offline, "--target", folder / "installed", wheel], folder)
    return folder / "installed"


def coilset(installed, cwd, *arguments):
    """The installed command; the checkout is not on its path."""
    return run([sys.executable, "-m", "coilset.scripts", *arguments], cwd, PYTHONPATH=str(installed))


def test_it_is_the_wheel_that_runs(installed, tmp_path):
    modules = "coilset.model", "coilset.examples", "coilset.api", "coilset.open"
    where = f"import {', '.join(modules)}; print({', '.join(f'{name}.__file__' for name in modules)})"
    for path in run([sys.executable, "-c", where], tmp_path, PYTHONPATH=str(installed)).split():
        assert Path(path).is_relative_to(installed)
    assert (installed / "bin" / "coilset").is_file()


def test_a_folder_of_the_same_name_does_not_hide_it(installed, tmp_path):
    """As that of one's results; a checkout of that name would."""
    (tmp_path / "coilset").mkdir()
    where = "import coilset.api; print(coilset.__version__, coilset.api.__file__)"
    version, path = run([sys.executable, "-c", where], tmp_path, PYTHONPATH=str(installed)).split()
    assert version == __version__
    assert Path(path).is_relative_to(installed)


def test_it_is_typed_for_others(installed):
    """By PEP 561 a checker reads annotations of packages with this file at their top."""
    assert (installed / "coilset" / "py.typed").is_file()


USE = """
from coilset.api import Case, solve

result = solve(Case.read("case.yaml"))
reveal_type(result.force)
reveal_type(result.set)
reveal_type(result.force_at(1.0))
result.force_at("1 mm")
"""
SEEN = ["numpy.ndarray", "builtins.float, None", "builtins.float", 'has incompatible type "str"; expected "float"']
OPTIONS = ["--ignore-missing-imports", "--follow-imports=silent"]


@pytest.mark.slow
def test_others_see_the_types(installed, tmp_path):
    """By mypy, which need not read the libraries for that."""
    pytest.importorskip("mypy")
    (tmp_path / "use.py").write_text(USE)
    with open(REPOSITORY / "pyproject.toml", "rb") as file:
        (libraries,) = (one for one in tomllib.load(file)["tool"]["mypy"]["overrides"] if "numba.*" in one["module"])
    skipped = f"[mypy]\n[mypy-{','.join(libraries['module'])}]\nfollow_imports = skip\n"
    (tmp_path / "mypy.ini").write_text(skipped)
    command = [sys.executable, "-m", "mypy", *OPTIONS, "--cache-dir", str(tmp_path / "cache"), "use.py"]
    environment = os.environ | {"MYPYPATH": str(installed)}
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    for line, found in zip(done.stdout.splitlines(), SEEN, strict=False):
        assert found in line
    assert "Found 1 error" in done.stdout


def test_every_file_of_data_is_there(installed):
    rooms = [path for room in ROOMS for path in (REPOSITORY / room).rglob("*.*")]
    data = [path for path in rooms if path.suffix in (".yaml", ".csv")]
    assert len(data) > 20
    missing = [path for path in data if not (installed / "coilset" / path.relative_to(REPOSITORY)).is_file()]
    assert missing == []


def test_an_example_is_listed_copied_and_solved(installed, tmp_path):
    assert "sweeps/tolerances.yaml" in coilset(installed, tmp_path, "examples")
    coilset(installed, tmp_path, "examples", "ck15_presetting")
    coilset(installed, tmp_path, "solve", "ck15_presetting.yaml", *SHORT)
    summary = json.loads((tmp_path / "results" / "ck15_presetting" / "summary.json").read_text())
    assert summary["complete"]
    assert summary["force_max_N"] > 100.0


def test_materials_and_data_of_examples_are_there(installed, tmp_path):
    assert "Ck 15" in coilset(installed, tmp_path, "material", "show", "ck15")
    copied = coilset(installed, tmp_path, "examples", "measured.yaml", "--out", "here")
    assert copied.split() == ["here/springs/measured.yaml", "here/springs/measured.csv"]
    copied = coilset(installed, tmp_path, "examples", "sweeps/tolerances.yaml", "--out", "here")
    assert copied.split() == ["here/sweeps/tolerances.yaml", "here/ck15_presetting.yaml"]


def test_tests_are_said_to_be_elsewhere(installed, tmp_path):
    command = [sys.executable, "-m", "coilset.scripts", "test"]
    done = subprocess.run(
        command,
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(installed)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert done.stderr == "coilset: test: the tests are in coilset's repository; there, run scripts/coilset test\n"
