"""The benchmarks measure what they say: stages do not overlap, records are whole, tables and figure come of them."""

import itertools
import json
import os
import sys
from types import SimpleNamespace

import pytest
from mpi4py import MPI

from coilset.model.compose import build
from coilset.model.core.base.errors import CoilsetError, InputError
from coilset.scripts.commands import bench as command
from coilset.verification.benchmarks import everyday, measure, stopwatch
from coilset.verification.benchmarks.stopwatch import Stopwatch


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
        patch.setattr(command, "measure", lambda *job, ranks: runs[ranks - 1] | {"force_N": 100.0 + ranks})
        ranks = {"kind": command.KINDS[1], **command.one_and_two({}, 40, 1)}
    seconds = {kind: [0.25, 1.5] for kind in everyday.MEASURED}
    return {
        "machine": command.machine(),
        "commands": [{"name": "solve", **seconds}],
        "example": example,
        "elements": runs,
        "ranks": [ranks],
        "load_after": 0.0,
    }


@pytest.mark.skipif(MPI.COMM_WORLD.size > 1, reason="measures one rank")
def test_record_is_whole(record):
    example, pressed = record["example"], record["elements"][1]
    assert example["elements"] == 40
    assert example["steps"] == 24
    assert all(pair[0] > 0.0 for pair in example["stages"].values())
    assert sum(pair[0] for pair in example["stages"].values()) <= example["analysis"][0] * (1 + 1e-9)
    assert pressed["elements"] == 40
    assert 0.5 < pressed["plastic"] < 1.0
    assert pressed["evaluations"] > pressed["iterations"] > 2
    # the stages of the iteration add up to the cost of an element
    spent = sum(pressed["stages"][stage][1] for stage in measure.ITERATION)
    assert measure.per_element(pressed) == pytest.approx(1e6 * spent / 40 / pressed["iterations"])
    assert record["ranks"][0]["difference"] == pytest.approx(1.0 / 101.0)
    assert json.loads(json.dumps(record)) == record


@pytest.mark.skipif(MPI.COMM_WORLD.size > 1, reason="measures one rank")
def test_command_prints_and_writes(record, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(command, "everyday", lambda starts, environment: record["commands"])
    jobs = {"example": [record["example"]], "press": record["elements"]}
    monkeypatch.setattr(command, "measure", lambda environment, job, *size, ranks=1: jobs[job][ranks - 1])
    command.bench(tmp_path / "out", False, True)
    said = capsys.readouterr().out
    for words in ("factorise", "µs", "first line, the other", "1.50", "coils in contact", "compile, from nothing"):
        assert words in said
    kept = json.loads((tmp_path / "out" / "bench.json").read_text())
    assert kept["example"] == record["example"]
    assert len(kept["ranks"]) == 4


def test_commands_are_timed_in_turns_and_the_first_run_does_not_count(monkeypatch, tmp_path):
    """The clock of the first run of each is that of its compilers."""
    (tmp_path / "scripts").mkdir()
    (tmp_path / "scripts" / "coilset").touch()
    called, clock = [], itertools.count(10)

    def timed(command, environment):
        called.append(command[0])
        assert "COILSET_STARTED" not in environment  # or its times would count from when this one was started
        return 0.5, 100.0 if len(called) <= 2 else float(next(clock)), 0.25

    monkeypatch.setattr(everyday, "timed", timed)
    monkeypatch.setattr(everyday, "COMMANDS", {"--help": ["--help"]})
    rows = everyday.everyday(everyday.launchers(tmp_path), {"COILSET_STARTED": "1"}, 3)
    (row,) = rows
    assert row == {"name": "--help", "first line": [0.5, 0.5], "end": [12.0, 13.0], "processor": [0.25, 0.25]}
    assert called == 4 * [called[0], str(tmp_path / "scripts" / "coilset")]


def test_what_is_no_checkout_is_said(tmp_path):
    with pytest.raises(InputError, match="is no checkout of coilset"):
        everyday.launchers(tmp_path)


def test_a_command_is_timed_to_its_first_line_and_to_its_end():
    slow = "import time; print('first', flush=True); time.sleep(0.3); print('last')"
    first, end, processor = everyday.timed([sys.executable, "-c", slow], dict(os.environ))
    assert 0.0 < first <= end - 0.3
    assert processor > 0.0
    with pytest.raises(CoilsetError, match="failed: no such thing"):
        everyday.timed([sys.executable, "-c", "import sys; sys.exit('no such thing')"], dict(os.environ))
