"""A results folder that somebody sent leads no command elsewhere: links in it are not written through."""

import contextlib
import json
import os
import time

import pytest
from mpi4py import MPI

from coilset.model.core.base.errors import CoilsetError
from coilset.model.core.results.files import folder as folders
from coilset.model.core.results.files.folder import RESULTS, clear, subfolder, whole
from coilset.model.tools.sweep.journal import Journal
from coilset.scripts.commands.fitting.files import files_to_write
from coilset.scripts.commands.solve import solve
from coilset.scripts.terminal.log import run_log

SMALL = [
    "mesh.elements_per_turn=8",
    "mesh.section.rule=abramowitz9",
    "accuracy=none",
    "loading=[{to: {travel: 2}, steps: 2}]",
]


@pytest.fixture
def victim(tmp_path):
    path = tmp_path / "victim"
    path.write_text("mine")
    return path


def test_an_unfinished_file_has_no_name_that_can_be_foreseen(tmp_path, monkeypatch):
    names = set()
    for _ in range(2):
        with whole(tmp_path / "report.html") as partial:
            names.add(partial.name)
            partial.write_text("page")
    assert len(names) == 2
    assert [path.name for path in tmp_path.iterdir()] == ["report.html"]


@pytest.mark.parametrize("age", [0.0, 1e6])
def test_a_link_of_the_name_of_an_unfinished_file_is_not_written_through(tmp_path, victim, monkeypatch, age):
    """An old one is removed, as what a killed process has left; a new one is an error."""
    monkeypatch.setattr(folders.os, "urandom", bytes)
    link = tmp_path / f".report.{bytes(8).hex()}.partial.html"
    link.symlink_to(victim)
    os.utime(link, (time.time() - age,) * 2, follow_symlinks=False)
    refused = contextlib.nullcontext() if age else pytest.raises(CoilsetError, match="cannot be written: File exists")
    with refused, whole(tmp_path / "report.html") as partial:
        partial.write_text("page")
    assert victim.read_text() == "mine"


def left_of_a_killed_process(path, age=1e6):
    """What lies beside `path` then, for some seconds."""
    with whole(path) as partial:
        partial.write_text("whole")
    partial.write_text("half")
    os.utime(partial, (time.time() - age,) * 2)
    return partial


def test_what_a_killed_process_left_goes_when_the_same_file_is_written(tmp_path):
    left, other = (left_of_a_killed_process(tmp_path / name) for name in ("report.html", "report.txt"))
    with whole(tmp_path / "report.html") as partial:
        partial.write_text("page")
        assert not left.exists()
        assert other.exists()


def test_what_others_are_writing_stays(tmp_path):
    """Two that write the same file at once: each is whole, and the last one is kept."""
    left = left_of_a_killed_process(tmp_path / "report.html", age=10.0)  # it may be of somebody who writes now
    with whole(tmp_path / "report.html") as first:
        first.write_text("first")
        with whole(tmp_path / "report.html") as second:
            second.write_text("second")
        assert (tmp_path / "report.html").read_text() == "second"
    assert (tmp_path / "report.html").read_text() == "first"
    assert left.exists()


def test_a_folder_of_the_name_of_an_unfinished_file_is_in_nobodys_way(tmp_path):
    (folder := tmp_path / f".report.{16 * '0'}.partial.html").mkdir()
    os.utime(folder, (0, 0))
    with whole(tmp_path / "report.html") as partial:
        partial.write_text("page")
    assert (tmp_path / "report.html").read_text() == "page"


def test_a_link_in_place_of_a_result_is_replaced(tmp_path, victim):
    (tmp_path / "report.html").symlink_to(victim)
    with whole(tmp_path / "report.html") as partial:
        partial.write_text("page")
    assert victim.read_text() == "mine"
    assert not (tmp_path / "report.html").is_symlink()


def test_a_file_has_the_usual_permissions(tmp_path):
    before = os.umask(0o022)
    try:
        with whole(tmp_path / "report.html") as partial:
            partial.write_text("page")
    finally:
        os.umask(before)
    assert (tmp_path / "report.html").stat().st_mode & 0o777 == 0o644


def test_a_log_is_not_written_through_a_link(tmp_path, victim):
    (tmp_path / "log.txt").symlink_to(victim)
    with pytest.raises(CoilsetError, match=r"log\.txt: cannot be written"), run_log(tmp_path, goes_on=False):
        pass
    assert victim.read_text() == "mine"


def test_a_journal_of_a_sweep_is_not_written_through_a_link(tmp_path, victim):
    (tmp_path / "journal.jsonl").symlink_to(victim)
    with pytest.raises(CoilsetError, match=r"journal\.jsonl: cannot be written"):
        Journal(tmp_path / "journal.jsonl")
    assert victim.read_text() == "mine"


@pytest.mark.parametrize("name", ["modes", "surge", "fields", "checkpoint"])
def test_nothing_is_deleted_or_written_through_a_folder_that_is_a_link(tmp_path, name):
    mine, results = tmp_path / "mine", tmp_path / "results"
    mine.mkdir()
    results.mkdir()
    files = [mine / "letter.vtu", mine / "steps.jsonl", mine / "state.npz"]
    for file in files:
        file.write_text("mine")
    (results / name).symlink_to(mine)
    clear(results, RESULTS)
    assert [file.read_text() for file in files] == ["mine"] * 3
    with pytest.raises(CoilsetError, match="is a link"):
        subfolder(results, name)


def test_a_linked_results_folder_is_the_users_own_choice(example, tmp_path):
    (tmp_path / "large_disk").mkdir()
    (tmp_path / "out").symlink_to(tmp_path / "large_disk")
    solve(example, tmp_path / "out", False, SMALL, comm=MPI.COMM_SELF)
    assert json.loads((tmp_path / "large_disk" / "summary.json").read_text())["complete"]


def test_what_a_killed_run_left_unfinished_goes_with_its_results(tmp_path):
    (tmp_path / ".0123456789abcdef.partial.nc").write_text("half")
    clear(tmp_path)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["../../x", "/tmp/x", ".."])
def test_the_name_of_a_material_leads_to_no_other_folder(tmp_path, name, monkeypatch):
    monkeypatch.chdir(tmp_path)
    if name == "..":
        (file,) = files_to_write(None, name, False, f"{name}.yaml")
        assert file.resolve().is_relative_to(tmp_path / "results")
    else:
        with pytest.raises(CoilsetError, match="a material's name has no /"):
            files_to_write(None, name, False, f"{name}.yaml")
