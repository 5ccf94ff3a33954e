"""Sweeps from file to data set: equal to single runs, unimpressed by failing cases, whole after kill -9."""

import itertools
import json
import os
import signal
import subprocess
import sys
import time
from collections import Counter
from contextlib import closing
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from mpi4py import MPI
from typer.testing import CliRunner

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.summary import summarise
from coilset.model.core.base.errors import InputError
from coilset.model.core.case import check
from coilset.model.core.material.library import FOLDER
from coilset.model.core.results.records.units import words_and_unit
from coilset.model.tools.findings.figures import draw
from coilset.model.tools.sweep import dataset
from coilset.model.tools.sweep.engines import processes
from coilset.model.tools.sweep.engines.processes import Workers
from coilset.model.tools.sweep.evaluate import evaluate
from coilset.model.tools.sweep.journal import Journal, read_records
from coilset.model.tools.sweep.plan import Plan
from coilset.model.tools.sweep.run import finished, missing, run
from coilset.model.tools.sweep.spec import RESPONSES
from coilset.scripts.main import app
from coilset.scripts.terminal.log import only_run

THREE = """
    vary:
      spring.wire_diameter: {from: 4, to: 6, count: 3}  # the last is too thick for its coil
    change: {spring.mean_diameter: 17.0}
"""


@pytest.fixture
def sweep(workers):
    """Run what is missing; returns the keys that were run."""

    def sweep(plan, folder, retry=False, workers=workers):
        ran = []
        with closing(Journal(folder / "journal.jsonl")) as journal, workers.pool(folder / "log") as pool:
            todo = plan.work(missing(plan, finished(folder, retry)))
            run(plan, todo, pool, journal, lambda record: ran.append(record["key"]))
        return ran

    return sweep


def test_cases_are_those_of_single_runs_and_a_wrong_spring_stops_nothing(write_sweep, tmp_path, sweep):
    plan = Plan(write_sweep(THREE))
    assert len(sweep(plan, tmp_path)) == 3
    data = dataset.collect(plan, tmp_path)
    assert data.status.values.tolist() == ["done", "done", "failed"]
    assert "spring" in str(data.reason.values[2])
    for k in range(2):
        analysis = Analysis(check(plan.data(plan.rows[k])), MPI.COMM_SELF)
        result = analysis.run()
        expected = summarise(analysis.setup, result)
        for name in ("set_mm", "force_max_N", "rate_N_per_mm"):
            # the same code on the same data; where one process compiled it and the other loaded it, the last
            # bits of sums over several points at once were seen to differ (2e-13)
            assert data[name].values[k] == pytest.approx(expected[name], rel=1e-11)
        curve = [step.force_N for step in result.steps]
        found = data.curve_force_N.values[k, : len(curve)]
        np.testing.assert_allclose(found, curve, rtol=1e-11, atol=1e-9 * max(curve))
    assert data.set_mm.isnull().values.tolist() == [False, False, True]


def test_resume_runs_only_what_is_missing_and_retry_what_failed(write_sweep, tmp_path, sweep):
    plan = Plan(write_sweep(THREE))
    sweep(plan, tmp_path)
    more = Plan(write_sweep(THREE.replace("count: 3", "count: 5")))
    assert sweep(more, tmp_path) == [more.keys[1], more.keys[3]]
    assert sweep(more, tmp_path, retry=True) == [more.keys[4]]
    changed = Plan(write_sweep("change: {solver.tolerance: 1.0e-10}\nvary: {spring.wire_diameter: [4.0]}"))
    assert sweep(changed, tmp_path) == list(changed.keys)


def test_process_that_dies_is_the_reason_of_its_case_only(write_sweep, tmp_path, monkeypatch, sweep):
    """A stand-in worker that kills itself at 5 mm wire and answers otherwise."""
    stub = tmp_path / "stub.py"
    stub.write_text(
        "import json, os, sys\n"
        "assert json.loads(sys.stdin.readline()).endswith('log')\n"
        "for line in sys.stdin:\n"
        "    tasks = json.loads(line)\n"
        "    if 5.0 in [task['data']['spring']['wire_diameter'] for task in tasks]: os.kill(os.getpid(), 11)\n"
        "    rest = dict(status='done', reason='', summary={}, steps={}, seconds=0)\n"
        "    print(json.dumps([dict(key=task['key'], **rest) for task in tasks]), flush=True)\n"
    )
    monkeypatch.setattr(processes, "WORKER", [sys.executable, str(stub)])
    plan = Plan(write_sweep(THREE))
    with Workers(1, dict(os.environ)) as stand_in:
        sweep(plan, tmp_path, workers=stand_in)
    data = dataset.collect(plan, tmp_path)
    assert data.status.values.tolist() == ["done", "failed", "done"]
    assert data.reason.values[1] == "the process of this case ended with signal 11"


def test_time_limit_gives_a_case_up(write_sweep, monkeypatch):
    """A clock that goes on by 0.1 s each time that it is looked at: once at the start, and after each step."""
    clock = SimpleNamespace(perf_counter=itertools.count(step=0.1).__next__)
    monkeypatch.setattr(sys.modules[evaluate.__module__], "time", clock)
    plan = Plan(write_sweep("change: {loading.0.steps: 100}\nvary: {spring.wire_diameter: [5.0]}"))
    record = evaluate(plan.data(plan.rows[0]), MPI.COMM_SELF, time_limit=0.5)
    assert record["status"] == "failed"
    assert record["reason"] == "stopped at the time limit of 0.5 s"
    assert len(record["steps"]["force_N"]) == 6  # the first whose 0.6 s are over the limit
    assert record["summary"]["set_mm"] is None


def command(path, out, *more):
    return [sys.executable, "-m", "coilset.scripts", "sweep", str(path), "--out", str(out), "--no-pictures", *more]


def refusal(*arguments):
    """What a sweep says that is refused, in this process."""
    problem = CliRunner().invoke(app, command(*arguments)[3:]).exception
    assert isinstance(problem, InputError)
    return str(problem)


def wait_until(true, seconds=240.0):  # a busy machine takes long to start Python
    end = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.02)


def workers_of(leader):
    """Process ids of a process's children."""
    with open(f"/proc/{leader}/task/{leader}/children") as file:
        return [int(pid) for pid in file.read().split()]


def gone(pid):
    try:
        with open(f"/proc/{pid}/stat") as file:
            return file.read().rsplit(")", 1)[1].split()[0] == "Z"
    except FileNotFoundError:
        return True


def begun(path, out, records, stdout, *options, name="journal.jsonl"):
    """A sweep on one worker that has so many records behind it: its process, its workers' numbers, its journal."""
    journal = out / name
    # what a shell starts in the background ignores SIGINT, and hands that on to all that it starts
    hear = lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)  # noqa: E731
    leader = subprocess.Popen(command(path, out, "--jobs", "1", *options), stdout=stdout, preexec_fn=hear)
    wait_until(lambda: journal.exists() and journal.read_bytes().count(b"\n") >= records)
    return leader, workers_of(leader.pid), journal


@pytest.mark.slow
def test_kill_and_resume_lose_nothing_and_repeat_nothing(write_sweep, tmp_path):
    path = write_sweep("vary: {spring.wire_diameter: {from: 4, to: 5, count: 12}}")
    out = tmp_path / "out"
    leader, workers, journal = begun(path, out, 3, subprocess.DEVNULL)
    leader.send_signal(signal.SIGKILL)
    leader.wait()
    wait_until(lambda: all(gone(pid) for pid in workers))
    before = journal.read_bytes()
    kept = [record["key"] for record in read_records(journal)]
    assert 3 <= len(kept) < 12
    assert "holds a sweep" in refusal(path, out)
    subprocess.run(command(path, out, "--resume", "--jobs", "1"), check=True, stdout=subprocess.DEVNULL)
    keys = Counter(record["key"] for record in read_records(journal))
    assert set(keys) == set(Plan(path).keys)
    assert set(keys.values()) == {1}
    assert journal.read_bytes().startswith(before[: before.rfind(b"\n") + 1])
    with xr.open_dataset(out / "sweep.nc", engine="h5netcdf") as data:
        assert (data.status == "done").all()
        assert data.set_mm.notnull().all()


def test_two_allocations_on_one_plan_and_one_is_killed(write_sweep, tmp_path):
    """Each case is recorded once: the killed shard goes on beside the other one, which computes none of its cases."""
    path, out = write_sweep("vary: {spring.wire_diameter: {from: 4, to: 5, count: 24}}"), tmp_path / "out"
    other = subprocess.Popen(command(path, out, "--jobs", "1", "--shard", "2/2"), stdout=subprocess.DEVNULL)
    shard = ("--shard", "1/2")
    leader, workers, journal = begun(path, out, 2, subprocess.DEVNULL, *shard, name="journal-1-of-2.jsonl")
    leader.send_signal(signal.SIGKILL)
    leader.wait()
    wait_until(lambda: all(gone(pid) for pid in workers))
    assert 2 <= len(list(read_records(journal))) < 12
    subprocess.run(command(path, out, *shard, "--jobs", "1"), check=True, stdout=subprocess.DEVNULL)
    assert other.wait(240) == 0
    keys = [record["key"] for path in out.glob("journal-*.jsonl") for record in read_records(path)]
    assert sorted(keys) == sorted(Plan(path).keys)
    assert not list(out.glob("*.running"))


@pytest.mark.parametrize("option", ["--overwrite", "--resume"])
def test_a_sweep_leaves_the_folder_of_one_that_runs(write_sweep, tmp_path, option):
    out = tmp_path / "out"
    out.mkdir()
    (out / "journal.jsonl").write_text("of the other one")
    with only_run(out):
        assert "another run is using this folder" in refusal(write_sweep(THREE), out, option)
    assert [path.name for path in out.iterdir()] == ["journal.jsonl"]
    assert (out / "journal.jsonl").read_text() == "of the other one"


def test_ctrl_c_keeps_what_has_ended(write_sweep, tmp_path):
    path = write_sweep("vary: {spring.wire_diameter: {from: 4, to: 5, count: 200}}")
    out = tmp_path / "out"
    leader, workers, journal = begun(path, out, 2, subprocess.PIPE)
    leader.send_signal(signal.SIGINT)
    said = leader.communicate(timeout=240)[0]
    assert leader.returncode == 130
    assert b"interrupted; run the same command with --resume to continue" in said
    wait_until(lambda: all(gone(pid) for pid in workers))
    with xr.open_dataset(out / "sweep.nc", engine="h5netcdf") as data:
        done = int((data.status == "done").sum())
    assert 2 <= done < 200
    assert done == len(list(read_records(journal)))


def test_figures_of_each_kind_and_one_without_a_response(write_sweep, tmp_path):
    text = """
        vary: {spring.wire_diameter: [4.0, 5.0], spring.pitch: [11.0, 12.0]}
        figures:
          - {kind: lines, x: spring.wire_diameter, colour: spring.pitch}
          - {kind: map, x: spring.wire_diameter, y: spring.pitch}
          - {kind: characteristics, colour: spring.pitch}
          - {kind: scatter, of: force_max_N}
          - {kind: sensitivity, of: [set_mm, force_max_N]}
          - {kind: scatter, of: seconds}
    """
    plan = Plan(write_sweep(text))
    with closing(Journal(tmp_path / "journal.jsonl")) as journal:
        for row, key in zip(plan.rows, plan.keys, strict=True):
            journal.append(evaluate(**plan.task(row, key), comm=MPI.COMM_SELF))
    data = dataset.collect(plan, tmp_path)
    numbers = {name for name in data.data_vars if data[name].dims == ("case",) and data[name].dtype.kind == "f"}
    assert numbers == set(RESPONSES)  # what `figures.of` may name is known before any case runs
    files, problems = draw(tmp_path, plan, data.drop_vars("seconds"))
    assert [name.split("_")[1] for name in files] == [
        "lines.png",
        "map.png",
        "characteristics.png",
        "scatter.png",
        "sensitivity.png",
    ]
    assert all((tmp_path / name).stat().st_size > 10_000 for name in files)
    assert [error.place for error in problems] == ["figures.5.of"]
    assert "'seconds' is not a response" in problems[0].problem


@pytest.mark.parametrize(
    ("text", "value", "drawn", "problem"),
    [
        ("design: random\nsamples: 3\nvary: {spring.pitch: {from: 11, to: 12}}", float, "sensitivity", ""),
        ("design: random\nsamples: 6\nvary: {spring.pitch: {from: 11, to: 12}}", lambda _: 0.0, "characteristics", ""),
        (
            "design: sobol_indices\nsamples: 2\nvary: {spring.pitch: {from: 11, to: 12}}",
            lambda k: 1e-14 * k,
            "characteristics",
            "",
        ),
        ("design: latin_hypercube\nsamples: 4\nvary: {material: [ck15, voce]}", float, "scatter", ""),
        ("design: one_at_a_time\nchange: {material: ck15}\nvary: {material: [ck15, voce]}", float, None, ""),
        (
            "design: together\nvary: {spring.pitch: [11, 11.5, 12, 12.5], spring.wire_diameter: [4, 4.5, 5, 5.5]}\n"
            "figures: [{kind: map, x: spring.pitch, y: spring.wire_diameter}]",
            float,
            None,
            "the cases lie on one line",
        ),
    ],
    ids=["three cases", "constant", "constant, Sobol", "words", "words, one at a time", "on a line"],
)
def test_what_cannot_be_drawn_does_not_end_a_sweep(write_sweep, tmp_path, text, value, drawn, problem):
    """Responses that never change, too few cases, inputs in words: the other figures are there."""
    plan = Plan(write_sweep(text))
    with closing(Journal(tmp_path / "journal.jsonl")) as journal:
        for number, key in enumerate(plan.keys):
            steps = {name: [1.0] * (number + 1) for name in ("travel_mm", "seat_height_mm", "force_N", "phase")}
            summary = {"set_mm": value(number), "force_max_N": 10.0 + number, "warnings": []}
            journal.append(
                {"key": key, "status": "done", "reason": "", "seconds": 1.0, "summary": summary, "steps": steps}
            )
    files, problems = draw(tmp_path, plan, dataset.collect(plan, tmp_path))
    assert (files[-1].split("_")[1] if files else None) == (drawn and f"{drawn}.png")
    assert [problem in error.problem for error in problems] == [True] * bool(problem)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("vary: {spring.wire_diametre: [5.0]}", "unknown entry"),
        ("vary: {spring.wire_diameter: [5.0, -1.0]}", "spring.wire_diameter"),
        ("vary: {loading.7.steps: [3]}", "vary.loading.7.steps: '7' is not an entry of this list"),
        ("change: {material: unobtainium}\nvary: {spring.wire_diameter: [5.0]}", "unobtainium"),
        ("vary: {mesh.axis: [curved]}\ndesign: one_at_a_time", "needs this entry in the base case"),
        ("vary: 3", "vary"),
        ("vary: {spring.wire_diameter: [5.0]}\nvary: {spring.pitch: [9.0]}", "the entry 'vary' is given twice"),
        (
            "vary: {spring.wire_diameter: [4.0, 5.0, 39.0]}",
            "spring.mean_diameter: the wire is thicker than the coil allows: D/d = 1.03 at turn 0, must be at least 3; "
            "no case with spring.wire_diameter = 39.0 can be built",
        ),
        ("vary: {temperature: [293.15, 400.0]}", "no case with temperature = 400.0 can be built"),
        ("vary: {spring.wire_diameter: {from: 38, to: 39, count: 3}}", "no case of this sweep can be built"),
        (
            "vary: {spring.wire_diameter: [5.0]}\nfigures: [{kind: scatter, of: set_nm}]",
            "figures.0.of: 'set_nm' is no response of a case; is set_mm meant?",
        ),
        (
            "vary: {spring.wire_diameter: [5.0]}\nfigures: [{kind: sensitivity, of: [set_mm, weight_kg]}]",
            "figures.0.of: 'weight_kg' is no response of a case; one is free_length_before_mm",
        ),
        (
            "vary: {spring.wire_diameter: [5.0]}\nfigures: [{kind: characteristics, colour: pitch}]",
            "figures.0.colour: 'pitch' is no response of a case",
        ),
        (
            "vary: {material: [ck15, voce], spring.pitch: [9.0, 12.0]}\n"
            "figures: [{kind: map, x: spring.pitch, y: material}]",
            "figures.0.y: 'material' has values that are no numbers, and a map needs numbers; give kind: lines",
        ),
        ("vary: {status: {entries: [spring.pitch], values: [9.0]}}", "'status' is a name of the results"),
        ("vary: {curve_force_N: {entries: [spring.pitch], values: [9.0]}}", "is a name of the results"),
    ],
)
def test_wrong_entries_are_refused_before_anything_runs(write_sweep, text, words):
    with pytest.raises(InputError) as found:
        Plan(write_sweep(text))
    assert words in str(found.value)
    assert "\n" not in str(found.value)


def test_values_that_fit_in_some_cases_only_are_left_to_them(write_sweep):
    """A wire of 7.5 mm fits the pitch of 12 mm, but not that of 7 mm: one case of four fails when it runs."""
    plan = Plan(write_sweep("vary: {spring.wire_diameter: [2.5, 7.5], spring.pitch: [7.0, 12.0]}"))
    assert len(plan) == 4


def test_files_that_a_sweep_names_count_from_its_folder(write_sweep, tmp_path, monkeypatch):
    """The base case lies in another folder than the sweep, and the command is given in a third."""
    ck15 = (FOLDER / "ck15.yaml").read_text()
    for folder in ("base", "work"):
        (tmp_path / folder).mkdir()
    (tmp_path / "soft.yaml").write_text(ck15)
    (tmp_path / "base" / "hard.yaml").write_text(ck15)
    write_sweep("vary: {material: [soft.yaml, ck15]}").rename(tmp_path / "sweep.yaml")
    text = (tmp_path / "case.yaml").read_text() + "material: hard.yaml\n"
    (tmp_path / "base" / "case.yaml").write_text(text)
    (tmp_path / "sweep.yaml").write_text("case: base/case.yaml\nvary: {material: [soft.yaml, ck15]}")
    (tmp_path / "pitch.yaml").write_text("case: base/case.yaml\nvary: {spring.pitch: [12.0]}")
    monkeypatch.chdir(tmp_path / "work")
    plan = Plan("../sweep.yaml")
    assert [row[0] for row in plan.rows] == ["soft.yaml", "ck15"]
    named = [check(plan.data(row), plan.case_path).material for row in plan.rows]
    assert [Path(name).resolve() for name in named[:1]] == [tmp_path / "soft.yaml"]
    assert named[1] == "ck15"
    pitch = Plan("../pitch.yaml")
    name = check(pitch.data(pitch.rows[0]), pitch.case_path).material
    assert Path(name).resolve() == tmp_path / "base" / "hard.yaml"


def test_inputs_have_the_units_of_their_entries(write_sweep, tmp_path):
    text = """
        design: latin_hypercube
        samples: 2
        vary:
          spring.wire_diameter: [5.0]
          loading.0.to.travel: {from: 5, to: 6}
          spring.turns: [1.5]
          material: [ck15, elastic]
          inches: {values: [0.5], entries: [spring.pitch], unit: in}
          both: {values: [12.0], entries: [spring.pitch, mesh.sagitta]}
          mixed: {values: [12.0], entries: [spring.pitch, loading.1.to.force]}
    """
    data = dataset.collect(Plan(write_sweep(text)), tmp_path)
    found = {name: data[name].attrs["units"] for name in data.attrs["inputs"]}
    assert found == {
        "spring.wire_diameter": "mm",
        "loading.0.to.travel": "mm",
        "spring.turns": "",
        "material": "",
        "inches": "in",
        "both": "mm",
        "mixed": "",
    }
    assert words_and_unit("plastic_work_max_N_per_mm2") == ("maximum plastic work", "N/mm²")


def test_a_sweep_with_failed_cases_warns_and_ends_with_3(write_sweep, tmp_path):
    three = command(write_sweep(THREE), tmp_path / "out", "--jobs", "1")
    done = subprocess.run(three, capture_output=True, text=True, check=False)
    assert done.returncode == 3
    assert done.stderr.startswith("coilset: 1 case(s) failed;")
    assert "2 done, 1 failed" in done.stdout
    assert (tmp_path / "out" / "sweep.nc").exists()


def test_a_changed_material_file_makes_new_cases(write_sweep, tmp_path):
    text = "change: {material: %s}\nvary: {spring.wire_diameter: [5.0]}" % (tmp_path / "own.yaml")
    ck15 = (FOLDER / "ck15.yaml").read_text()
    (tmp_path / "own.yaml").write_text(ck15)
    first = Plan(write_sweep(text)).keys
    assert Plan(write_sweep(text)).keys == first
    assert "22480" in ck15
    (tmp_path / "own.yaml").write_text(ck15.replace("22480", "22481"))
    assert Plan(write_sweep(text)).keys != first


def test_kept_keys_count_until_plan_material_or_version_change(write_sweep, tmp_path, monkeypatch):
    text = "change: {material: %s}\nvary: {spring.wire_diameter: [5.0, 5.1]}" % (tmp_path / "own.yaml")
    ck15 = (FOLDER / "ck15.yaml").read_text()
    (tmp_path / "own.yaml").write_text(ck15)
    kept, path = tmp_path / "plan.npz", write_sweep(text)
    first = Plan(path, kept)
    first.keep(kept)
    checked = []
    original = Plan._checked
    monkeypatch.setattr(Plan, "_checked", lambda plan, row: checked.append(row) or original(plan, row))
    assert Plan(path, kept).keys == first.keys
    assert checked == [(5.0,)]  # the first case that names the material
    assert Plan(write_sweep(text.replace("5.1", "5.2"), "other"), kept).keys[1] != first.keys[1]
    (tmp_path / "own.yaml").write_text(ck15.replace("22480", "22481"))
    changed = Plan(path, kept)
    assert set(changed.keys).isdisjoint(first.keys)
    assert changed.keys == Plan(path).keys
    (tmp_path / "own.yaml").write_text(ck15)
    monkeypatch.setattr("coilset.model.tools.sweep.keys.__version__", "0.0.1")
    assert set(Plan(path, kept).keys).isdisjoint(first.keys)
    kept.write_bytes(b"torn")
    assert len(Plan(path, kept)) == 2


def test_a_material_file_that_changes_during_the_sweep_gives_no_case_of_before(write_sweep, tmp_path):
    ck15 = (FOLDER / "ck15.yaml").read_text()
    (tmp_path / "own.yaml").write_text(ck15)
    change = "change: {material: %s, loading: [{to: {travel: 1}, steps: 1}]}" % (tmp_path / "own.yaml")
    plan = Plan(write_sweep(f"{change}\nvary: {{spring.wire_diameter: [5.0]}}"))
    task = plan.task(plan.rows[0], plan.keys[0])
    assert evaluate(**task, comm=MPI.COMM_SELF)["status"] == "done"
    (tmp_path / "own.yaml").write_text(ck15.replace("22480", "22481"))
    record = evaluate(**task, comm=MPI.COMM_SELF)
    assert record["status"] == "failed"
    assert "a file that this case names has changed since the sweep was read" in record["reason"]
    assert not record["summary"]


def test_another_version_makes_new_cases(write_sweep, monkeypatch):
    text = "vary: {spring.wire_diameter: [5.0]}"
    first = Plan(write_sweep(text)).keys
    monkeypatch.setattr("coilset.model.tools.sweep.keys.__version__", "0.0.1")
    assert Plan(write_sweep(text)).keys != first


def test_records_hold_no_nan(write_sweep):
    plan = Plan(write_sweep("change: {loading: [{to: {travel: 1}, steps: 1}]}\nvary: {spring.wire_diameter: [5.0]}"))
    record = evaluate(plan.data(plan.rows[0]), MPI.COMM_SELF)
    assert record["summary"]["set_mm"] is None  # it has not been released
    json.dumps(record, allow_nan=False)
