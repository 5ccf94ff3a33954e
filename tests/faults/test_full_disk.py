"""A disk that is full, at every file that is written: one line, exit code 1, no half file, nothing beside it.

The disk is one on which no file may grow beyond some bytes (RLIMIT_FSIZE), which needs no rights; the writers hear
EFBIG where a full disk says ENOSPC.
"""

import contextlib
import resource
import shutil
from dataclasses import replace
from pathlib import Path

import matplotlib.figure
import numpy as np
import pytest
import pyvista
import xarray as xr
from mpi4py import MPI

from coilset.model.compose import dataset, examples, run_files
from coilset.model.compose.analysis import Analysis
from coilset.model.compose.run_files import run_of
from coilset.model.compose.summary import summarise
from coilset.model.core.base.errors import CoilsetError
from coilset.model.core.case import read_case
from coilset.model.core.results.files import folder
from coilset.model.core.results.files.checkpoint import Checkpoint
from coilset.model.core.results.files.grid_file import write_grid
from coilset.model.core.results.records.provenance import origin
from coilset.model.tools.figures import png, scene
from coilset.model.tools.figures.display import ensure
from coilset.model.tools.figures.panels.characteristic import characteristic
from coilset.model.tools.sweep import dataset as sweep_data
from coilset.model.tools.sweep.journal import Journal, read_records
from coilset.scripts.main import app
from coilset.verification.study import Study

LARGEST = 200  # bytes


@contextlib.contextmanager
def full(largest=LARGEST):
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (largest, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.fixture(scope="module")
def analysis(example):
    settings = [
        "mesh.elements_per_turn=8",
        "mesh.section.rule=abramowitz9",
        "accuracy=none",
        "loading=[{to: {travel: 2}, steps: 2}]",
    ]
    analysis = Analysis(read_case(example, settings), MPI.COMM_SELF)
    analysis.run()
    return analysis


def drawn():
    figure = matplotlib.figure.Figure()
    figure.add_subplot().plot([0, 1], [0, 1])
    return figure


@pytest.fixture(scope="module")
def run(analysis):
    return run_of(analysis.setup, analysis.result, origin(analysis.case))


def grid(out, analysis):
    write_grid(out / "a.vtu", pyvista.ImageData(dimensions=(9, 9, 9)).cast_to_unstructured_grid())


def save(out, analysis):
    position = analysis.program.position
    Checkpoint(out, analysis.case).save(analysis.system.state, analysis.layout, position, analysis.result)


WRITERS = {
    "summary": lambda out, one: folder.write_summary(out, summarise(one.setup, one.result)),
    "history": lambda out, one: folder.write_history(out, one.result.steps),
    "seats": lambda out, one: folder.write_seats(out, one.result.seats),
    "points": lambda out, one: dataset.write_points(out, one.setup, one.result, {}),
    "fields": lambda out, one: run_files.write_fields(out, one.setup, one.result.snapshots),
    "checkpoint": save,
    "data of a sweep": lambda out, one: sweep_data.write(out / "sweep.nc", xr.Dataset({"a": ("n", np.zeros(999))})),
    "record of verification": lambda out, one: Study(out).write("name" * 99),
    "figure": lambda out, one: png.save(drawn(), out / "a.png"),
    "grid": grid,
    "example": lambda out, one: examples.copy("ck15_presetting.yaml", out),
}


PICTURES = {
    "panel": lambda out, run: png.write_png(out / "a.png", [characteristic(run)]),
    "springs": lambda out, run: scene.springs(out / "springs.png", run),
}


@pytest.mark.parametrize("name", [*WRITERS, *PICTURES])
def test_a_file_is_whole_or_not_there(analysis, run, tmp_path, name):
    if name == "springs" and not ensure():
        pytest.skip("no display and no Xvfb")
    with full(), pytest.raises(CoilsetError, match="cannot be written") as caught:
        (WRITERS | PICTURES)[name](tmp_path, run if name in PICTURES else analysis)
    assert "\n" not in str(caught.value)
    assert caught.value.exit_code == 1
    left = [path.name for path in tmp_path.rglob("*") if path.is_file() and path.stat().st_size]
    assert set(left) <= {"steps.jsonl"}  # of which the state, which is not there, says how many lines count


@pytest.mark.parametrize("suffix", [".msh", ".vtu", ".inp", ".xdmf"])
def test_a_mesh_is_whole_or_not_there(example, tmp_path, capsys, suffix):
    with full(), pytest.raises(CoilsetError, match="cannot be written") as caught:
        app(["mesh", str(example), "--no-pictures", "--write", str(tmp_path / f"wire{suffix}")], standalone_mode=False)
    assert "\n" not in str(caught.value)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("command", ["material show ck15", "mesh CASE"])
def test_commands_leave_no_half_file(example, tmp_path, capsys, command):
    words = [str(example) if word == "CASE" else word for word in command.split()]
    with full(), pytest.raises(CoilsetError, match="cannot be written"):
        app([*words, "--out", str(tmp_path / "out")], standalone_mode=False)
    assert list((tmp_path / "out").iterdir()) == []


def test_a_record_of_a_sweep_is_whole_or_not_there(tmp_path):
    path = tmp_path / "journal.jsonl"
    journal = Journal(path)
    record = {"key": "first", "status": "done", "summary": {"text": "x" * 100}}
    journal.append(record)
    with full(), pytest.raises(CoilsetError, match="cannot be written: File too large"):
        journal.append({**record, "key": "second"})
    journal.append({**record, "key": "third"})  # there is room again
    journal.close()
    assert [one["key"] for one in read_records(path)] == ["first", "third"]


def test_a_checkpoint_that_cannot_be_written_leaves_the_one_before(analysis, tmp_path):
    checkpoint, begun = Checkpoint(tmp_path, analysis.case), analysis.result
    shorter = replace(begun, steps=begun.steps[:1], seats=begun.seats[:1], frames=begun.frames[:1])

    def save(result):
        checkpoint.save(analysis.system.state, analysis.layout, analysis.program.position, result)

    save(shorter)
    with full(), pytest.raises(CoilsetError):
        save(begun)
    assert len(Checkpoint(tmp_path, analysis.case).load(MPI.COMM_SELF).result.steps) == 1


@pytest.mark.parametrize("command", ["solve CASE", "slice CASE", "mesh CASE", "sweep SWEEP", "material show ck15"])
def test_a_default_folder_that_is_a_file_gets_one_line(example, tmp_path, monkeypatch, command):
    monkeypatch.chdir(tmp_path)
    Path("results").write_text("mine")
    shutil.copytree(example.parent, tmp_path / "examples")
    names = {"CASE": "examples/ck15_presetting.yaml", "SWEEP": "examples/sweeps/tolerances.yaml"}
    with pytest.raises(CoilsetError, match="results") as caught:
        app([names.get(word, word) for word in command.split()], standalone_mode=False)
    assert "\n" not in str(caught.value)
    assert caught.value.exit_code == 2
    assert Path("results").read_text() == "mine"
