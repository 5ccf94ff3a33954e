"""The benchmarks measure what they say: stages do not overlap, records are whole, tables and figure come of them."""

import importlib.util
import itertools
import json
import os
import sys
from types import SimpleNamespace

import pytest
from mpi4py import MPI

from coilset.model.base.errors import CoilsetError, InputError
from coilset.model.run import build
from coilset.scripts.commands import bench as command
from coilset.verification.benchmarks import everyday, measure, run, same_spring, stopwatch, walk
from coilset.verification.benchmarks.ranks import compare
from coilset.verification.benchmarks.stopwatch import Stopwatch
from coilset.verification.benchmarks.target import ITERATION, per_element, seconds, spread, targets


@pytest.fixture
def clock(monkeypatch):
    """Hands of the clock and of the processor that the stopwatch reads, moved by the test, s."""
    hands = SimpleNamespace(wall=100.0, cpu=7.0)
    fake = SimpleNamespace(perf_counter=lambda: hands.wall, process_time=lambda: hands.cpu)
    monkeypatch.setattr(stopwatch, "time", fake)
    return hands


def test_a_stage_does_not_count_the_stages_within_it(clock):
    """Outer: 2 s and 4 s at full work, within it 5 s of waiting, and 16 s after the end that belong to nobody."""

    def work(seconds):
        clock.wall, clock.cpu = clock.wall + seconds, clock.cpu + seconds

    def wait(seconds):
        clock.wall += seconds

    watch, owner = Stopwatch(), SimpleNamespace(wait=wait)
    watch.watch(owner, "wait", "inner")
    with watch.stage("outer"):
        work(2.0)
        owner.wait(5.0)
        work(4.0)
    work(16.0)
    assert watch.wall == {"inner": 5.0, "outer": 6.0}
    assert watch.cpu == {"inner": 0.0, "outer": 6.0}
    watch.split("outer", {"part": 1.5})
    assert watch.wall == {"inner": 5.0, "outer": 4.5, "part": 1.5}
    assert watch.cpu == {"inner": 0.0, "outer": 4.5, "part": 1.5}


def test_a_stage_ends_where_it_is_left_by_an_error(clock):
    def fail():
        clock.wall += 1.0
        raise ValueError("left")

    watch, owner = Stopwatch(), SimpleNamespace(fail=fail)
    watch.watch(owner, "fail", "outer")
    with pytest.raises(ValueError, match="left"):
        owner.fail()
    clock.wall += 2.0
    with watch.stage("next"):
        clock.wall += 4.0
    assert watch.wall == {"outer": 1.0, "next": 4.0}


FOUND = {"force_N": 345.0, "set_mm": 1.57, "iterations": 170, "threads": 2}
COMPARED = {
    "elements": 40,
    "axis": "chords",
    "coilset": FOUND | {"seconds": 0.25, "elapsed": 0.16},
    "unestimated": FOUND | {"seconds": 0.2, "elapsed": 0.125},
    "opensees": {"force_N": 345.2, "set_mm": 1.56, "iterations": 204, "threads": 1, "seconds": 1.0, "elapsed": 1.1},
}


def compared_ranks(runs):
    """Rows as if two ranks were measured; the run with `ranks` of them takes turns with the one on one rank."""
    turns = []

    def measured(*job, ranks):
        turns.append(ranks)
        return runs[ranks - 1] | {"force_N": 100.0 + ranks}

    rows = compare(measured, "quick", lambda name: None)
    assert turns == [1, 2] * (len(turns) // 2)
    return rows


def test_every_tangent_counts_as_assembly():
    """Between clamped heads most are built with the section forces that a correction predicts."""
    case = measure.read_example(["ends=clamped", "mesh.elements_per_turn=8", "loading=[{to: {travel: 2}}]"])
    watch, stages = Stopwatch(), []
    analysis = measure.build(watch, case, MPI.COMM_SELF)
    matrix = analysis.newton.iteration.matrix
    fill = matrix.fill
    matrix.fill = lambda *args: (stages.append(watch._open[-1]), fill(*args))
    with watch.stage("other"):
        assert analysis.newton.solve(analysis.control.to_height(analysis.control.height - 2.0)).converged
    assert analysis.newton.iteration.predicted
    assert stages
    assert set(stages) == {"assemble"}


@pytest.fixture(scope="module")
def record():
    """A bench of the smallest size, its measurements made in this process."""
    with pytest.MonkeyPatch.context() as patch:
        for function in ("line_mesh", "section_placement"):  # what is watched stays so until the process ends
            patch.setattr(build, function, getattr(build, function))
        example = measure.example(1)
        runs = [measure.press(elements) for elements in (20, 40)]
        unestimated = measure.press(20, 1, 0, 0) | {"elements": 100_000, "memory_GiB": 1.875}
    commands = [{"name": "solve", "first_line": [0.25, 0.75], "end": [1.5, 3.5]}]
    walked = [{"name": name, "threads": 1, "seconds": [0.25, None]} for name in walk.WALKS]
    record = {
        "machine": run.machine(),
        "commands": commands,
        "walks": walked,
        "example": example,
        "elements": runs,
        "unestimated": [unestimated],
        "ranks": [runs[0], runs[0]],
        "one_and_two_ranks": compared_ranks(runs),
        "cases": measure.cases(1),
        "opensees": [COMPARED],
        "load_after": 0.0,
    }
    return record | {"targets": targets(record)}


@pytest.mark.skipif(MPI.COMM_WORLD.size > 1, reason="measures one rank")
def test_record_is_whole(record):
    example, pressed = record["example"], record["elements"][1]
    assert example["elements"] == 40
    assert example["steps"] == 24
    assert all(pair[0] > 0.0 for pair in example["stages"].values())
    assert seconds(example["stages"], 0) <= example["analysis"][0] * (1 + 1e-9)
    assert pressed["elements"] == 40
    assert 0.5 < pressed["plastic"] < 1.0
    assert pressed["evaluations"] > pressed["iterations"] > 2
    assert record["cases"]["failed"] == 0
    # the stages of the iteration add up to the cost of an element
    assert sum(per_element(pressed, stage) for stage in ITERATION) == pytest.approx(per_element(pressed))
    assert json.loads(json.dumps(record)) == record


def test_spread_is_of_the_large_runs():
    def made(elements, cost):
        stages = {stage: [0.0, 0.0] for stage in ITERATION}
        stages["law"][1] = 1e-6 * cost * elements * 3
        return {"elements": elements, "iterations": 3, "stages": stages}

    runs = [made(40, 90.0), made(4000, 50.0), made(16000, 55.0), made(100_000, 52.0)]
    assert per_element(runs[1]) == pytest.approx(50.0)
    assert spread(runs, 4000) == pytest.approx(0.1)
    assert spread(runs[:2], 4000) is None


@pytest.mark.skipif(MPI.COMM_WORLD.size > 1, reason="measures one rank")
def test_command_prints_and_writes(record, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(command, "measure_all", lambda full, cold, environment, report, against: record)
    command.bench(tmp_path / "out", False, False)
    said = capsys.readouterr().out
    for words in (
        "factorise",
        "µs",
        "ranks",
        "an hour and core",
        "aimed at",
        "first line, the other",
        "as shipped",
        "0.250",
        "times as fast",
        "with contact",
        "9.9e-03",
        "345.200",
        "4.0",
        "6.9",
        "8.8",
        "1.88 GiB",
    ):
        assert words in said
    assert "OpenSees is not here" not in said
    assert json.loads((tmp_path / "out" / "bench.json").read_text()) == record
    assert (tmp_path / "out" / "bench.png").stat().st_size > 10_000


def test_it_is_said_where_opensees_is_missing(capsys):
    command.Console(width=140).print(command._opensees([COMPARED | {"opensees": None}]))
    assert "OpenSees is not here" in capsys.readouterr().out


@pytest.mark.skipif(not importlib.util.find_spec("openseespy"), reason="there is no OpenSees")
def test_opensees_finds_the_same_force_with_the_same_chords(monkeypatch):
    """Elements differ by terms of second order in their length: 7.5e-4 with 40 of them, 6e-6 with 320."""
    monkeypatch.setattr(same_spring, "STEPS", 10)
    found = same_spring.compare(40, repeats=1)
    assert found["opensees"]["force_N"] == pytest.approx(found["coilset"]["force_N"], rel=1.5e-3)
    assert found["opensees"]["set_mm"] == pytest.approx(found["coilset"]["set_mm"], rel=1e-2)


def test_commands_are_timed_in_turns_and_the_first_run_does_not_count(monkeypatch, tmp_path):
    """The clock of the first run of each is that of its compilers."""
    (tmp_path / "scripts").mkdir()
    (tmp_path / "scripts" / "coilset").touch()
    called, clock = [], itertools.count(10)

    def timed(command, environment):
        called.append(command[0])
        assert "COILSET_STARTED" not in environment  # or its times would count from when this one was started
        return 0.5, 100.0 if len(called) <= 2 else float(next(clock))

    monkeypatch.setattr(everyday, "timed", timed)
    monkeypatch.setattr(everyday, "COMMANDS", {"--help": ["--help"]})
    rows = everyday.everyday(everyday.launchers(tmp_path), {"COILSET_STARTED": "1"}, 3)
    assert rows == [{"name": "--help", "first_line": [0.5, 0.5], "end": [12.0, 13.0]}]  # of 10, 12, 14 and 11, 13, 15
    assert called == 4 * [called[0], str(tmp_path / "scripts" / "coilset")]


def test_what_is_no_checkout_is_said(tmp_path):
    with pytest.raises(InputError, match="is no checkout of coilset"):
        everyday.launchers(tmp_path)


def test_a_command_is_timed_to_its_first_line_and_to_its_end():
    slow = "import time; print('first', flush=True); time.sleep(0.3); print('last')"
    first, end = everyday.timed([sys.executable, "-c", slow], dict(os.environ))
    assert 0.0 < first <= end - 0.3
    with pytest.raises(CoilsetError, match="failed: no such thing"):
        everyday.timed([sys.executable, "-c", "import sys; sys.exit('no such thing')"], dict(os.environ))


def test_walks_of_several_checkouts_are_timed_in_turns(tmp_path):
    """Medians of what each prints; a checkout that cannot walk so has none."""
    starts, log = [], tmp_path / "log"
    for side in "ab":
        script = tmp_path / side
        script.write_text(
            f"""#!{sys.executable}
import json, os, sys
assert sys.argv[1] == "python" and "COILSET_STARTED" not in os.environ
with open({str(log)!r}, "a+") as log:
    log.write({side!r})
    log.seek(0)
    count = log.read().count({side!r})
print("a line before")
print(json.dumps([{{"name": "w", "threads": 1, "seconds": count ** 2 if {side!r} == "a" else None}}]))
"""
        )
        script.chmod(0o755)
        starts.append([str(script)])
    rows = everyday.walks(starts, dict(os.environ) | {"COILSET_STARTED": "1"}, 3)
    assert rows == [{"name": "w", "threads": 1, "seconds": [4, None]}]
    assert log.read_text() == "ababab"


@pytest.mark.skipif(MPI.COMM_WORLD.size > 1, reason="measures one rank")
def test_a_walk_is_timed():
    assert 0.0 < walk.walk(["loading=[{to: {travel: 1}, steps: 1}]", "mesh.elements_per_turn=8"], 1) < 60.0
    assert walk.walk(["no.such.entry=1"], 1) is None
