"""What a run finds in its folder, and what it leaves there: damaged checkpoints, earlier runs, changed files."""

import json
import os
import shutil
import signal
import zipfile
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.errors import CoilsetError, InputError, SolveError
from coilset.model.core.case import read_case
from coilset.model.core.material import library
from coilset.model.core.results.files import folder as folders
from coilset.model.core.results.files import state_file
from coilset.model.core.results.files.checkpoint import Checkpoint
from coilset.model.core.results.files.opened import open_run
from coilset.model.core.results.records import provenance
from coilset.scripts.commands.solve import solve
from coilset.scripts.terminal.log import run_log

COMM = MPI.COMM_SELF
SMALL = [
    "mesh.elements_per_turn=8",
    "mesh.section.rule=abramowitz9",
    "accuracy=none",
    "loading=[{to: {travel: 2}, steps: 2}]",
]


class Stop(Exception):
    """Stands for the end of the process."""


@pytest.fixture(scope="module")
def interrupted(example, tmp_path_factory):
    """Folder of a run that was killed after its first step."""
    folder = tmp_path_factory.mktemp("interrupted")
    case = read_case(example, SMALL)

    def stop(step):
        raise Stop

    with pytest.raises(Stop):
        Analysis(case, COMM).run(stop, Checkpoint(folder, case).save)
    return folder


@pytest.fixture
def folder(interrupted, tmp_path):
    return Path(shutil.copytree(interrupted, tmp_path / "out"))


def resume(example, folder, *more):
    solve(example, folder, False, [*SMALL, *more], resume=True, comm=COMM)


def test_an_undamaged_one_goes_on(example, folder):
    resume(example, folder)
    assert json.loads((folder / "summary.json").read_text())["steps"] == 2


@pytest.mark.parametrize(("complete", "words"), [(False, "holds an interrupted run; use --resume"), (True, "already")])
def test_an_interrupted_run_is_told_from_a_complete_one(folder, complete, words):
    (folder / "summary.json").write_text(json.dumps({"complete": complete}))
    with pytest.raises(InputError, match=words):
        folders.refuse_results(folder, False)


@pytest.mark.parametrize("force", [False, True])
def test_pictures_of_mesh_go_only_where_results_are_replaced(example, tmp_path, force):
    (tmp_path / "drawing.png").write_text("of this spring, or of another")
    solve(example, tmp_path, force, SMALL, comm=COMM)
    assert (tmp_path / "drawing.png").exists() != force


@pytest.mark.parametrize("name", ["history.csv", "seats.csv"])
def test_an_empty_table_is_one_line(example, tmp_path, name):
    solve(example, tmp_path, False, SMALL, comm=COMM)
    (tmp_path / name).write_text("")
    with pytest.raises(InputError, match=rf"{name}: is not readable: it is empty"):
        open_run(tmp_path)


def test_a_continued_run_leaves_nothing_that_shows_the_earlier_numbers(example, folder):
    """Page, film, pictures and time series are drawn from results that are written anew."""
    drawn = ["report.html", "animation.gif", "springs.png", "fields/line.pvd", "fields/line-01.vtu"]
    (folder / "fields").mkdir()
    for name in drawn:
        (folder / name).write_text("old")
    (folder / "notes.txt").write_text("mine")
    resume(example, folder)
    assert not [name for name in drawn if (folder / name).exists()]
    assert (folder / "fields" / "00.vtu").exists()
    assert (folder / "notes.txt").read_text() == "mine"


def rewrite(path, change):
    with np.load(path) as file:
        arrays = {name: file[name] for name in file.files}
    change(arrays)
    np.savez(path, **arrays)


def rewrite_fields(path, change):
    """Change the fields of the state, which are kept as one array."""

    about, fields, others = state_file.read(path)
    change(fields)
    with open(path, "wb") as file:
        state_file.write(file, about, fields, others)


def flip(path):
    content = bytearray(path.read_bytes())
    for place in range(len(content) // 5, len(content), len(content) // 5):
        content[place] ^= 0xFF
    path.write_bytes(bytes(content))


def lengthen_a_name(path):
    """The first array's name in its archive has 272 letters, of which the reader repeats all; found by the fuzzer."""
    content = bytearray(path.read_bytes())
    content[27] = 1
    path.write_bytes(bytes(content))


def older(arrays):
    about = json.loads(str(arrays["about"]))
    del about["provenance"]
    arrays["about"] = np.array(json.dumps(about))


def other_layout(*names):
    """Entries of the text beside the arrays that have another name, as before a change of the program."""

    def change(path):
        def rename(arrays):
            about = group = json.loads(str(arrays["about"]))
            *above, last = names
            for name in above:
                group = group[name]
            group[f"earlier_{last}"] = group.pop(last)
            arrays["about"] = np.array(json.dumps(about))

        rewrite(path, rename)

    return change


STATE, STEPS, SNAPSHOT = "state.npz", "steps.jsonl", "snapshot-00.npz"
DAMAGES = {
    "truncated": (STATE, lambda path: path.write_bytes(path.read_bytes()[:-300])),
    "flipped": (STATE, flip),
    "name without end": (STATE, lengthen_a_name),
    "empty": (STATE, lambda path: path.write_bytes(b"")),
    "array missing": (STATE, lambda path: rewrite_fields(path, lambda fields: fields.pop("x"))),
    "wrong shape": (STATE, lambda path: rewrite_fields(path, lambda fields: fields.update(x=np.zeros((3, 3))))),
    "not a number": (STATE, lambda path: rewrite_fields(path, lambda fields: fields["x"].fill(np.nan))),
    "numbers missing": (STATE, lambda path: rewrite(path, lambda arrays: arrays.update(state=arrays["state"][:-1]))),
    "older version": (STATE, lambda path: rewrite(path, older)),
    "other layout": (STATE, other_layout("position", "on_path")),
    "other position": (STATE, other_layout("position", "on_path", "size")),
    "steps missing": (STEPS, lambda path: path.unlink()),
    "steps truncated": (STEPS, lambda path: path.write_bytes(path.read_bytes()[:-300])),
    "steps damaged": (STEPS, lambda path: path.write_bytes(path.read_bytes().replace(b'"step"', b'"stop"'))),
    "steps of others": (STEPS, lambda path: path.write_bytes(path.read_bytes().replace(b'"cuts"', b'"kuts"'))),
    "snapshot missing": (SNAPSHOT, lambda path: path.unlink()),
    "snapshot truncated": (SNAPSHOT, lambda path: path.write_bytes(path.read_bytes()[:-300])),
    "snapshot empty": (SNAPSHOT, lambda path: path.write_bytes(b"")),
    "snapshot of another": (SNAPSHOT, lambda path: rewrite(path, lambda arrays: arrays.update(x=np.zeros((3, 3))))),
}


@pytest.mark.parametrize("damage", ["other layout", "other position", "steps of others"])
def test_a_checkpoint_of_another_version_is_called_so(example, folder, damage):
    """Not "not readable: 'on_path'"."""
    name, spoil = DAMAGES[damage]
    spoil(folder / "checkpoint" / name)
    with pytest.raises(InputError, match="written by another version of coilset, or is damaged; use --overwrite"):
        resume(example, folder)


@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_checkpoint_gets_one_line(example, folder, damage):
    name, spoil = DAMAGES[damage]
    spoil(folder / "checkpoint" / name)
    with pytest.raises(InputError) as caught:
        resume(example, folder)
    assert "\n" not in str(caught.value)
    assert "--overwrite" in str(caught.value)
    assert len(str(caught.value).replace(str(folder), "")) < 400
    assert not (folder / "summary.json").exists()


def members(folder):
    """Every array of a checkpoint: its file, its name, and where its bytes are in the file."""
    for path in sorted((folder / "checkpoint").glob("*.npz")):
        with zipfile.ZipFile(path) as file:
            for member in file.infolist():
                yield path, member.filename.removesuffix(".npy"), member.header_offset + 200, member.file_size


def changes_of(name):
    """Without an array, with another shape of it, and with a number that is none."""
    return [
        lambda arrays: arrays.pop(name),
        lambda arrays: arrays.update({name: arrays[name][1:]}),
        lambda arrays: arrays[name].flat.__setitem__(0, np.nan),
    ]


def spoilt_at(path, name, place, size):
    """Contents of a checkpoint's file that are wrong at one of its arrays."""
    whole = path.read_bytes()
    if size > 400:
        turned = bytearray(whole)
        turned[place] ^= 1
        yield bytes(turned)
    with np.load(path) as file:
        is_numbers = file[name].dtype.kind == "f" and file[name].ndim
    for change in changes_of(name)[: None if is_numbers else 1]:
        yield rewritten(path, rewrite, change)


def rewritten(path, how, change):
    """What a file would be with a change."""
    whole = path.read_bytes()
    how(path, change)
    content = path.read_bytes()
    path.write_bytes(whole)
    return content


def test_damage_at_every_array_gets_one_line(example, folder):
    """Missing, of another shape, not a number, or with one bit turned; the analysis that refuses it stays as it was."""
    case = read_case(example, SMALL)
    analysis = Analysis(case, COMM)
    before, state = analysis.system.state["x"].trial.copy(), folder / "checkpoint" / STATE
    spoilt = [(member[0], content) for member in members(folder) for content in spoilt_at(*member)]
    spoilt += [
        (state, rewritten(state, rewrite_fields, change))
        for name, _ in analysis.system.state.items()
        for change in changes_of(name)
    ]
    assert len(spoilt) > 75
    for path, content in spoilt:
        whole = path.read_bytes()
        path.write_bytes(content)
        with pytest.raises(InputError) as caught:
            analysis.resume(Checkpoint(folder, case).load(COMM))
        assert "\n" not in str(caught.value)
        assert "--overwrite" in str(caught.value)
        path.write_bytes(whole)
    np.testing.assert_array_equal(analysis.system.state["x"].trial, before)
    analysis.resume(Checkpoint(folder, case).load(COMM))
    assert analysis.continuation.number == 1


@pytest.mark.parametrize("name", ["summary.json", "points.nc", "log.txt", "springs.png", "checkpoint/state.npz"])
@pytest.mark.parametrize("force", [False, True])
def test_a_folder_in_the_way_of_a_file_is_seen_before_the_run(example, tmp_path, name, force):
    (tmp_path / "out" / name).mkdir(parents=True)
    with pytest.raises(InputError, match=f"--out: there is a folder named {name} in it"):
        solve(example, tmp_path / "out", force, SMALL, comm=COMM)
    assert not [path for path in tmp_path.rglob("*") if path.is_file()]


@pytest.mark.parametrize("name", ["checkpoint", "fields"])
def test_a_file_in_the_way_of_a_folder_is_seen_before_the_run(example, tmp_path, name):
    (tmp_path / name).write_text("mine")
    with pytest.raises(InputError, match=f"--out: there is a file named {name} in it"):
        solve(example, tmp_path, True, SMALL, comm=COMM)
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_nothing_to_go_on_from_leaves_nothing(example, tmp_path):
    with pytest.raises(InputError, match="no checkpoint to continue from"):
        resume(example, tmp_path / "out")
    assert list(tmp_path.iterdir()) == []


def test_resume_and_force_are_not_both(example, folder):
    with pytest.raises(InputError, match="--resume: continues a run, and --overwrite discards it"):
        solve(example, folder, True, SMALL, resume=True, comm=COMM)
    assert (folder / "checkpoint" / STATE).exists()


def test_a_folder_may_begin_with_a_tilde(example, tmp_path, monkeypatch):
    """It is not another user's home folder: libraries would look for it."""
    monkeypatch.chdir(tmp_path)
    solve(example, "~out", False, SMALL, comm=COMM)
    assert (tmp_path / "~out" / "points.nc").exists()


def test_an_interrupted_run_is_not_thrown_away(example, folder):
    with pytest.raises(InputError, match=r"--resume.*--overwrite"):
        solve(example, folder, False, SMALL, comm=COMM)
    assert (folder / "checkpoint" / STATE).exists()


def test_a_forced_run_leaves_nothing_of_the_old_one(example, folder, monkeypatch):
    for name in ("summary.json", "springs.png", "goodman.png", "history.csv", "report.html"):
        (folder / name).write_text("old")
    (folder / "log.txt").write_text("old\n")

    def killed(*_):
        raise Stop

    monkeypatch.setattr(Analysis, "run", killed)
    with pytest.raises(Stop):
        solve(example, folder, True, SMALL, comm=COMM)
    assert [path.name for path in folder.rglob("*") if path.is_file()] == ["log.txt"]
    assert (folder / "log.txt").read_text() == ""


def test_one_run_at_a_time_works_in_a_folder(example, folder):
    (folder / "log.txt").write_text("of the other\n")
    with run_log(folder, goes_on=True), pytest.raises(InputError, match="another run"):
        solve(example, folder, True, SMALL, comm=COMM)
    assert (folder / "log.txt").read_text() == "of the other\n"
    resume(example, folder)


def test_changed_constants_of_a_material_file_are_seen(example, tmp_path):
    source = (library.FOLDER / "ck15.yaml").read_text(encoding="utf-8")
    material = tmp_path / "mine.yaml"
    material.write_text(source, encoding="utf-8")
    case = read_case(example, [*SMALL, f"material={material}"])
    before = provenance.provenance(case)
    material.write_text(source + "\n# a remark changes nothing\n", encoding="utf-8")
    assert provenance.changed(before, provenance.provenance(case)) is None
    material.write_text(source.replace("G: 84000", "G: 60000"), encoding="utf-8")
    assert provenance.changed(before, provenance.provenance(case)) == "material"
    assert provenance.changed({**before, "version": "0.0.1"}, before) == "version"


def test_a_changed_material_does_not_go_on(example, folder, monkeypatch):
    monkeypatch.setattr(provenance, "contents", lambda case: {"material": "another"})
    with pytest.raises(InputError, match="material"):
        resume(example, folder)


def test_changed_points_of_a_measured_spring_are_seen(example, tmp_path):
    shutil.copytree(example.parent / "springs", tmp_path / "springs")
    case = read_case(tmp_path / "springs" / "measured.yaml")
    before = provenance.contents(case)
    csv = tmp_path / "springs" / "measured.csv"
    csv.write_text(csv.read_text().replace("5.0", "4.5"))
    assert provenance.contents(case)["spring.file"] != before["spring.file"]


FIRST_TOUCH = ["contact.bedding=1e13", "solver.options={pc_type: none}"]


@pytest.mark.parametrize("setting", FIRST_TOUCH)
def test_a_failure_at_the_first_touch_ends_as_any_other(example, tmp_path, setting):
    with pytest.raises(SolveError) as caught:
        solve(example, tmp_path / "out", False, [*SMALL, setting], comm=COMM)
    assert "\n" not in str(caught.value)
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert not summary["complete"]
    assert summary["rate_N_per_mm"] is None


def test_a_disk_that_fills_during_a_run_gets_one_line(example, tmp_path, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(folders.os, "posix_fallocate", full)
    with pytest.raises(CoilsetError, match=r"points\.nc: cannot be written: No space"):
        solve(example, tmp_path / "out", False, SMALL, comm=COMM)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_at_the_first_touch_ends_gently(example, tmp_path, monkeypatch, number):
    """Before the first step there is nothing to finish: results are written, and no step is taken."""
    touch = Analysis.initial_rate

    def signalled(analysis):
        os.kill(os.getpid(), number)
        return touch(analysis)

    monkeypatch.setattr(Analysis, "initial_rate", signalled)
    with pytest.raises(KeyboardInterrupt):
        solve(example, tmp_path / "out", False, SMALL, comm=COMM)
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert not summary["complete"]
    assert summary["steps"] == 0
    assert summary["rate_N_per_mm"] > 0.0
