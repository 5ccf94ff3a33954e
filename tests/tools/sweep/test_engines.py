"""Shards, engines and studies: the same cases, however they are shared."""

import os
import socket

import numpy as np
import pytest
import xarray as xr

from coilset.api import Study
from coilset.model.core.base.errors import InputError
from coilset.model.tools.sweep import dataset, parquet
from coilset.model.tools.sweep.engines.dask import dask_pool
from coilset.model.tools.sweep.journal import Journal, Records
from coilset.model.tools.sweep.plan import Plan
from coilset.model.tools.sweep.run import Limits, finished, missing, run
from coilset.model.tools.sweep.shards import WHOLE, Shard, duration
from coilset.scripts.main import app

UNIFORM = """
    model: uniform_rod
    rods: 2
    vary: {spring.wire_diameter: {from: 4.8, to: 5.2}, spring.pitch: {from: 11, to: 13}}
    design: sobol
    samples: 8
"""


@pytest.fixture
def solve(workers):
    """Run what is missing of a shard; returns the records in their order."""

    def solve(plan, folder, shard=WHOLE, pool=None, limits=None):
        records = []
        folder.mkdir(exist_ok=True)
        journal = Journal(folder / shard.journal, locked=False)
        todo = plan.work(missing(plan, finished(folder, retry=False), shard))
        if pool is not None:
            run(plan, todo, pool, journal, records.append, limits)
        else:
            with workers.pool(folder / "log") as own:
                run(plan, todo, own, journal, records.append, limits)
        journal.close()
        return records

    return solve


@pytest.fixture
def plan(write_sweep):
    return Plan(write_sweep(UNIFORM))


def summaries(plan, folder):
    return {one["key"]: one["summary"] for one in Records(folder, plan.task_keys)}


def test_shards_together_are_the_whole_and_none_runs_twice(plan, tmp_path, solve):
    whole, shared = tmp_path / "whole", tmp_path / "shared"
    assert {one["status"] for one in solve(plan, whole)} == {"done"}
    shards = [(Plan(plan.path, shard=shard), shard) for shard in (Shard(1, 3), Shard(2, 3), Shard(3, 3))]
    assert [sum(map(bool, part.keys)) for part, _shard in shards] == [3, 3, 2]  # only its own cases are checked
    ran = [one["key"] for part, shard in shards for one in solve(part, shared, shard)]
    assert sorted(ran) == sorted(key.decode() for key in plan.task_keys)
    assert len(set(ran)) == 10
    assert summaries(plan, shared) == summaries(plan, whole)
    assert solve(plan, shared, Shard(2, 3)) == []  # again: nothing is missing
    a, b = dataset.collect(plan, whole), dataset.collect(plan, shared)
    xr.testing.assert_identical(a.drop_vars("seconds"), b.drop_vars("seconds"))


def test_a_killed_shard_is_taken_over_and_a_living_one_is_not(tmp_path):
    shard = Shard(3, 100)
    with shard.claimed(tmp_path):
        claim = tmp_path / "journal-3-of-100.running"
        assert claim.read_text() == f"{socket.gethostname()} {os.getpid()}"
        with pytest.raises(InputError, match=r"shard 3/100 is being run by process \d+ on"), shard.claimed(tmp_path):
            pass
    assert not claim.exists()
    claim.write_text(f"{socket.gethostname()} 999999999")  # no such process
    with shard.claimed(tmp_path):
        assert str(os.getpid()) in claim.read_text()
    claim.write_text("elsewhere 1")
    with pytest.raises(InputError, match="on elsewhere"), shard.claimed(tmp_path):
        pass
    os.utime(claim, (0, 0))  # silent for long
    with shard.claimed(tmp_path):
        pass


@pytest.mark.parametrize("text", ["0/3", "4/3", "3", "1/0", "a/b"])
def test_a_wrong_shard_is_refused(text):
    with pytest.raises(InputError, match="3/100"):
        Shard.parse(text)


def test_durations():
    assert duration("3:50:00", "--until") == 13800.0
    assert duration(None, "--until") == float("inf")
    with pytest.raises(InputError, match="3:50:00"):
        duration("3h", "--until")


def test_a_budget_ends_a_sweep_and_it_goes_on(plan, tmp_path, solve):
    first = solve(plan, tmp_path / "out", limits=Limits(budget=1e-9))
    assert 1 <= len(first) < 10
    rest = solve(plan, tmp_path / "out")
    assert len(first) + len(rest) == 10


def test_parquet_has_every_record_with_units(plan, tmp_path, solve):
    pq = pytest.importorskip("pyarrow.parquet")
    folder = tmp_path / "out"
    solve(plan, folder)
    path = folder / "sweep.parquet"
    records = Records(folder, plan.task_keys)
    assert records.counts == {"done": 10, "failed": 0, "missing": 0}
    assert parquet.write(path, plan, records) == 10
    table = pq.read_table(path)
    assert table.schema.field("set_mm").metadata[b"units"] == b"mm"
    rows = {(row["case"], row["model"]): row for row in table.to_pylist()}
    assert len(rows) == 10
    data = dataset.collect(plan, folder)
    for case in range(8):
        row = rows[case, "uniform_rod"]
        assert row["set_mm"] == data.set_mm.values[case]
        assert row["spring.pitch"] == plan.rows[case][1]
    np.testing.assert_array_equal([rows[case, "rod"]["set_mm"] for case in (0, 1)], data.rod_set_mm.values[:2])
    assert np.isnan(data.rod_set_mm.values[2:]).all()


def test_a_large_sweep_is_shown_by_some_of_its_cases(plan, tmp_path, solve):
    folder = tmp_path / "out"
    solve(plan, folder)
    some, every = dataset.collect(plan, folder, most=4), dataset.collect(plan, folder)
    assert some.attrs["cases"] == 8
    assert some.key.values.tolist() == every.key.values[::2].tolist()
    np.testing.assert_array_equal(some.set_mm.values, every.set_mm.values[::2])


def test_dask_finds_what_processes_find(plan, tmp_path, solve):
    distributed = pytest.importorskip("distributed")
    solve(plan, tmp_path / "processes")
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0") as cluster,
        distributed.Client(cluster) as client,
    ):
        client.wait_for_workers(2, timeout=60)
        with dask_pool(cluster.scheduler_address) as pool:
            assert pool.workers == 2
            solve(plan, tmp_path / "dask", pool=pool)
    assert summaries(plan, tmp_path / "dask") == summaries(plan, tmp_path / "processes")


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (["--engine", "dask"], "--scheduler: give"),
        (["--scheduler", "tls://a:1"], "--engine dask"),
        (["--engine", "mpi"], "ranks"),
    ],
)
def test_engines_and_schedulers_belong_together(options, reason):
    with pytest.raises(InputError, match=reason):
        app(["sweep", "sweep.yaml", *options], prog_name="coilset", standalone_mode=False)


def test_a_scheduler_that_does_not_answer_is_named(monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr("coilset.model.tools.sweep.engines.dask.CONNECT_SECONDS", 1)
    with pytest.raises(InputError, match="no scheduler answers"), dask_pool("tcp://127.0.0.1:9"):
        pass


def test_a_study_goes_on_where_it_was(plan, tmp_path):
    study = Study(plan.path, tmp_path / "study")
    trials = study.ask(3)
    assert [trial.inputs["spring.pitch"] for trial in trials] == [row[1] for row in plan.rows][:3]
    found = study.evaluate(trials[:2], jobs=1)
    study.tell(trials[2].key, None, "broke")
    (given,) = study.ask(values=[{"spring.wire_diameter": 5.0, "spring.pitch": 12.5}])
    assert given.data["spring"]["pitch"] == 12.5
    study.tell(given.key, {"set_mm": 1.5})
    data = study.results()
    study.close()
    assert data.sizes["case"] == 9
    np.testing.assert_array_equal(data.set_mm.values[:2], [one["set_mm"] for one in found])
    assert data.status.values.tolist() == ["done", "done", "failed", *["missing"] * 5, "done"]
    assert data.set_mm.values[8] == 1.5
    again = Study(plan.path, tmp_path / "study")
    assert again.ask(1)[0].key == plan.keys[3]
    with pytest.raises(InputError, match=r"the plan has spring\.wire_diameter, spring\.pitch"):
        again.ask(values=[{"spring.pitch": 12.0}])
    again.close()
