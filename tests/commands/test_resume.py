"""Checkpoints: killed runs go on to the same numbers, on any number of ranks, and a changed program goes on too."""

import json
import random
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.errors import InputError
from coilset.model.core.case import read_case
from coilset.model.core.results.files import state_file
from coilset.model.core.results.files.checkpoint import Checkpoint
from coilset.model.physics.time.heat_entries import HeatSpec

SETTINGS = ["mesh.section.rule=abramowitz9", "accuracy=none", "loading.0.steps=20", "loading.1.steps=20"]
CLAMPED = [
    "mesh.elements_per_turn=8",
    "ends=clamped",
    "loading=[{to: {travel: 12}, steps: 6}, {to: {force: 0}, steps: 3}]",
]
CUT = [*CLAMPED, "accuracy=0.2 %", "solver.options.snes_max_it=3"]  # 4 cut no step
KILLS = 2  # twenty were made once, see docs/restart.md; each costs a start of Python


def command(example, *more):
    settings = [part for setting in SETTINGS for part in ("--set", setting)]
    solve = [sys.executable, "-m", "coilset.scripts", "solve", str(example), "--out", "out", "--no-pictures"]
    return [*solve, *settings, *more]


def final(folder):
    with np.load(folder / "checkpoint" / "state.npz") as file:
        return {name: file[name] for name in file.files if name != "about"}


def written(state):
    """When the checkpoint was written, 0 if there is none."""
    return state.stat().st_mtime_ns if state.exists() else 0


def test_killed_runs_resume_to_the_same_bits(example, tmp_path):
    """Killed at random moments after a first new checkpoint, also while one is written; then left to end."""
    for run in ("whole", "killed"):
        (tmp_path / run).mkdir()
    subprocess.run(command(example), cwd=tmp_path / "whole", check=True, capture_output=True)
    rng, state, killed_at = random.Random(7), tmp_path / "killed" / "out" / "checkpoint" / "state.npz", []
    for _ in range(KILLS):
        before = written(state)
        more = ["--resume"] if before else []
        process = subprocess.Popen(
            command(example, *more), cwd=tmp_path / "killed", stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        while process.poll() is None and written(state) == before:
            time.sleep(0.001)
        time.sleep(rng.uniform(0.0, 0.05))
        process.send_signal(signal.SIGKILL)
        process.wait()
        with np.load(state) as file:
            killed_at.append(json.loads(str(file["about"]))["steps"])
    assert killed_at[0] < 40  # the program has 40 steps: it was killed on the way
    subprocess.run(command(example, "--resume"), cwd=tmp_path / "killed", check=True, capture_output=True)
    undisturbed, resumed = final(tmp_path / "whole" / "out"), final(tmp_path / "killed" / "out")
    for name, values in undisturbed.items():
        np.testing.assert_array_equal(resumed[name], values, err_msg=name)
    for table in ("history.csv", "seats.csv"):
        whole, killed = ((tmp_path / run / "out" / table).read_bytes() for run in ("whole", "killed"))
        assert whole == killed


class Killed(Exception):
    """Stands for the end of the process."""


def run_until(analysis, checkpoint, steps):
    """Run and stop, as if killed, after some steps."""

    def report(step):
        if step.number == steps:
            raise Killed

    with pytest.raises(Killed):
        analysis.run(report, checkpoint.save)


@pytest.mark.mpi
@pytest.mark.parametrize(("more", "stop"), [([], 17), (CLAMPED, 5)], ids=["seats", "clamped"])
def test_any_number_of_ranks_goes_on(example, tmp_path_factory, more, stop):
    """Begun on all ranks, ended on each alone: within 1e-10 of the run on one rank."""
    comm = MPI.COMM_WORLD
    folder = comm.bcast(str(tmp_path_factory.mktemp("ranks")) if comm.rank == 0 else None)
    case = read_case(example, [*SETTINGS, *more])
    whole = Analysis(case, MPI.COMM_SELF).run()
    begun = Analysis(case, comm)
    run_until(begun, Checkpoint(folder, case), stop)
    comm.barrier()
    resumed = Analysis(case, MPI.COMM_SELF)
    resumed.resume(Checkpoint(folder, case).load(resumed.comm))
    assert resumed.continuation.number == stop
    result = resumed.run()
    assert len(result.steps) == len(whole.steps)
    for name in ("seat_height_mm", "force_N"):
        ours, reference = (np.array([getattr(step, name) for step in run.steps]) for run in (result, whole))
        np.testing.assert_allclose(ours, reference, rtol=0, atol=1e-10 * np.abs(reference).max())


@pytest.mark.mpi
def test_what_is_restored_is_what_was_there(example, tmp_path_factory):
    """On each rank and to the bit, what other ranks own included: state, places on the path, records."""
    comm = MPI.COMM_WORLD
    folder = comm.bcast(str(tmp_path_factory.mktemp("ranks")) if comm.rank == 0 else None)
    loading = "loading=[{to: block, steps: 4}, {to: {force: 0}, steps: 3}]"
    friction = ["contact.friction.seats=0.1", "contact.friction.coils=0.1"]
    settings = [SETTINGS[0], "mesh.elements_per_turn=10", *friction, loading]
    case = read_case(example, settings)
    begun, resumed = Analysis(case, comm), Analysis(case, comm)
    run_until(begun, Checkpoint(folder, case), 4)
    comm.barrier()
    begun.system.restore()  # as before the next step, and as a resumed run begins
    resumed.resume(Checkpoint(folder, case).load(comm))
    assert begun.result.steps[-1].contacts > 2
    for name, field in begun.system.state.items():
        now = resumed.system.state[name]
        assert now.equilibrium.tobytes() == field.equilibrium.tobytes(), name
        assert now.trial.tobytes() == field.trial.tobytes(), name
    for name in ("E", "s"):
        now, then = (getattr(one.rod.coefficients, name) for one in (resumed, begun))
        assert now.tobytes() == then.tobytes(), name
    assert resumed.program.position == begun.program.position
    assert resumed.continuation.steps.position == begun.continuation.steps.position
    assert resumed.result.steps == begun.result.steps


@pytest.mark.parametrize(
    "more", [["mesh.elements_per_turn=12", "loading.0.steps=8", "loading.1.steps=5"], CUT], ids=["seats", "clamped"]
)
def test_every_step_can_be_the_last_one_before_a_crash(example, tmp_path, more):
    """One chain of processes, each stopped after its next step: the same bits as without a stop.

    Between seats contacts close and open on the way, so that the matrices of run and chain differ in the places of
    their zeros. Between heads, where steps are predicted with the tangents of the last equilibrium, some are cut.
    """
    case = read_case(example, [*SETTINGS, *more])
    whole, checkpoint = Analysis(case, MPI.COMM_SELF), Checkpoint(tmp_path, case)
    whole.run()
    steps = len(whole.result.steps)
    assert (more is CUT) == any(step.cuts for step in whole.result.steps)
    for step in range(1, steps + 1):
        resumed = Analysis(case, MPI.COMM_SELF)
        if step > 1:
            resumed.resume(checkpoint.load(resumed.comm))
        if step < steps:
            run_until(resumed, checkpoint, step)
    resumed.run()
    assert resumed.result.steps == whole.result.steps
    np.testing.assert_array_equal(resumed.rod.x, whole.rod.x)
    np.testing.assert_array_equal(resumed.rod.point_state, whole.rod.point_state)


def test_a_run_goes_on_with_a_step_that_needs_no_iteration(example, tmp_path):
    """Nothing was factorised yet whose pivots could tell whether its state is stable."""
    case = read_case(example, [*CLAMPED, "loading=[{to: {force: 0}, steps: 2}]"])
    run_until(Analysis(case, MPI.COMM_SELF), Checkpoint(tmp_path, case), 1)
    resumed = Analysis(case, MPI.COMM_SELF)
    resumed.resume(Checkpoint(tmp_path, case).load(resumed.comm))
    last = resumed.run().steps[-1]
    assert (last.iterations, last.negative_pivots) == (0, 0)


def test_automatic_steps_go_on_where_they_stopped(example, tmp_path):
    """What the step control knows belongs to the state: cut, grown and estimated to the same bits."""
    case = read_case(example, ["mesh.section.rule=abramowitz9", "mesh.elements_per_turn=10"])
    whole, checkpoint = Analysis(case, MPI.COMM_SELF), Checkpoint(tmp_path, case)
    whole.run()
    assert sum(step.cuts for step in whole.result.steps) > 0
    stopped = Analysis(case, MPI.COMM_SELF)
    run_until(stopped, checkpoint, next(step.number for step in whole.result.steps if step.cuts) - 1)
    for step in (len(whole.result.steps) - 3, None):
        stopped = Analysis(case, MPI.COMM_SELF)
        stopped.resume(checkpoint.load(stopped.comm))
        stopped.run() if step is None else run_until(stopped, checkpoint, step)
    assert stopped.result.steps == whole.result.steps
    np.testing.assert_array_equal(stopped.rod.point_state, whole.rod.point_state)


def test_a_kill_while_writing_leaves_the_checkpoint_before(example, tmp_path, monkeypatch):
    case = read_case(example, SETTINGS)
    analysis, checkpoint = Analysis(case, MPI.COMM_SELF), Checkpoint(tmp_path, case)
    run_until(analysis, checkpoint, 3)
    before = final(tmp_path)

    def half(file, *what):
        file.write(b"PK half a file")
        raise Killed

    monkeypatch.setattr(state_file, "write", half)
    with pytest.raises(Killed):
        checkpoint.save(analysis.system.state, analysis.layout, analysis.program.position, analysis.result)
    monkeypatch.undo()
    for name, values in before.items():
        np.testing.assert_array_equal(final(tmp_path)[name], values)


def test_a_changed_program_goes_on_and_a_changed_spring_does_not(example, tmp_path):
    case = read_case(example, [*SETTINGS, "loading.0.to={travel: 8}"])
    analysis = Analysis(case, MPI.COMM_SELF)
    analysis.run(save=Checkpoint(tmp_path, case).save)
    longer = read_case(example, [*SETTINGS, "loading=[{to: {travel: 8}, steps: 20}, {to: {travel: 6}, steps: 5}]"])
    resumed = Analysis(longer, MPI.COMM_SELF)
    about = json.loads(str(np.load(tmp_path / "checkpoint" / "state.npz")["about"]))
    assert about["position"]["stage"] == 2
    with pytest.raises(InputError, match="loading"):  # both phases of the old program are behind
        resumed.resume(Checkpoint(tmp_path, longer).load(resumed.comm))
    more = case.model_copy(update={"loading": [*case.loading, longer.loading[1]]})
    resumed = Analysis(more, MPI.COMM_SELF)
    resumed.resume(Checkpoint(tmp_path, more).load(resumed.comm))
    assert resumed.run().steps[-1].travel_mm == pytest.approx(6.0, abs=1e-12)
    thicker = read_case(example, [*SETTINGS, "loading.0.to={travel: 8}", "spring.wire_diameter=5.1"])
    with pytest.raises(InputError, match="spring"):
        Checkpoint(tmp_path, thicker).load(MPI.COMM_SELF)
    conducting = case.model_copy(update={"heat": HeatSpec(conductivity=50.0)})
    with pytest.raises(InputError, match="heat: differs from that of the checkpoint"):
        Checkpoint(tmp_path, conducting).load(MPI.COMM_SELF)


def test_a_run_goes_on_from_an_unstable_state_as_it_would_have(example, tmp_path):
    """Where no stable state was found, the next step may be as unstable; no other branch is looked for."""
    case = read_case(example, CLAMPED)
    run_until(Analysis(case, MPI.COMM_SELF), Checkpoint(tmp_path, case), 2)
    resumed = Analysis(case, MPI.COMM_SELF)
    saved = Checkpoint(tmp_path, case).load(resumed.comm)
    first, last = saved.result.steps
    resumed.resume(replace(saved, result=replace(saved.result, steps=(first, replace(last, negative_pivots=2)))))
    assert resumed.continuation.negative_pivots == 2


def test_a_snapshot_behind_the_last_state_is_written_anew(example, tmp_path):
    """A run was killed between the snapshot at the end of a phase and its state, and the target is another one now."""
    case = read_case(example, CLAMPED)
    checkpoint = Checkpoint(tmp_path, case)
    run_until(Analysis(case, MPI.COMM_SELF), checkpoint, 2)
    shutil.copy(checkpoint.folder / "snapshot-00.npz", checkpoint.folder / "snapshot-01.npz")
    resumed, checkpoint = Analysis(case, MPI.COMM_SELF), Checkpoint(tmp_path, case)
    resumed.resume(checkpoint.load(resumed.comm))
    resumed.run(save=checkpoint.save)
    saved = Checkpoint(tmp_path, case).load(resumed.comm)
    assert [shot.name for shot in saved.result.snapshots] == ["start", "travel 12 mm", "force 0 N"]


def test_no_checkpoint_and_a_broken_one_are_said(example, tmp_path):
    case = read_case(example, SETTINGS)
    analysis = Analysis(case, MPI.COMM_SELF)
    with pytest.raises(InputError, match="no checkpoint"):
        analysis.resume(Checkpoint(tmp_path, case).load(analysis.comm))
    (tmp_path / "checkpoint").mkdir()
    (tmp_path / "checkpoint" / "state.npz").write_bytes(b"nothing of the kind")
    with pytest.raises(InputError, match="not readable"):
        analysis.resume(Checkpoint(tmp_path, case).load(analysis.comm))
