"""The benchmarks measure what they say: stages do not overlap, records are whole, tables and figure come of them."""

import json
import time

import pytest
from mpi4py import MPI

from coilset.model import analysis
from coilset.scripts import bench as command
from coilset.verification.benchmarks import measure, run
from coilset.verification.benchmarks.stopwatch import Stopwatch
from coilset.verification.benchmarks.target import ITERATION, per_element, seconds, spread, targets


def test_a_stage_does_not_count_the_stages_within_it():
    watch, owner = Stopwatch(), type("Owner", (), {"wait": staticmethod(time.sleep)})
    watch.watch(owner, "wait", "inner")
    began = time.perf_counter()
    with watch.stage("outer"):
        time.sleep(0.02)
        owner.wait(0.05)
        time.sleep(0.02)
    whole = time.perf_counter() - began
    assert 0.05 <= watch.wall["inner"] < 0.05 + (whole - 0.09) + 1e-3
    assert watch.wall["inner"] + watch.wall["outer"] == pytest.approx(whole, abs=1e-3)
    assert sum(watch.cpu.values()) < 0.5 * whole  # who sleeps does not use the processor
    watch.split("outer", {"part": 0.01})
    assert watch.wall["part"] == 0.01
    assert watch.wall["inner"] + watch.wall["outer"] + watch.wall["part"] == pytest.approx(whole, abs=1e-3)


@pytest.fixture(scope="module")
def record():
    """A bench of the smallest size, its measurements made in this process."""
    with pytest.MonkeyPatch.context() as patch:
        for function in ("line_mesh", "section_placement"):  # what is watched stays so until the process ends
            patch.setattr(analysis, function, getattr(analysis, function))
        example = measure.example(1)
        runs = [measure.press(elements) for elements in (20, 40)]
    record = {"machine": run.machine(), "example": example, "elements": runs, "ranks": [runs[0], runs[0]],
              "cases": measure.cases(1), "load_after": 0.0}  # fmt: skip
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
    monkeypatch.setattr(command, "measure_all", lambda full, cold, environment, report: record)
    command.bench(tmp_path / "out", False, False)
    said = capsys.readouterr().out
    for words in ("factorise", "µs", "ranks", "an hour and core", "aimed at"):
        assert words in said
    assert json.loads((tmp_path / "out" / "bench.json").read_text()) == record
    assert (tmp_path / "out" / "bench.png").stat().st_size > 10_000
