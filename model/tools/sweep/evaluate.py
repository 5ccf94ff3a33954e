"""One case of a sweep, from raw data to its record."""

import math
import sys
import time
import traceback
from collections.abc import Callable
from dataclasses import fields
from typing import Any

from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.summary import summarise
from coilset.model.core.base.errors import CoilsetError, InputError, SolveError
from coilset.model.core.case import Case, check
from coilset.model.core.case.material import case_law
from coilset.model.core.results.records.record import Step
from coilset.model.core.results.records.summary_entries import NUMBERS
from coilset.model.physics.uniform_coil.estimate import estimate
from coilset.model.physics.working.working import is_working_number
from coilset.model.tools.sweep.engines.pool import Record, Task
from coilset.model.tools.sweep.keys import Keys, Model


def evaluate(
    data: dict[str, Any],
    comm: MPI.Comm,
    file: str = "",
    time_limit: float | None = None,
    key: str | None = None,
    model: Model = "rod",
    keys: Keys | None = None,
    estimates: bool = True,
) -> dict[str, Any]:
    """Run a case; errors are recorded instead of raised.

    Args:
        data: raw data of the case, as a case file holds it.
        comm: communicator of the ranks that solve it.
        file: the base case's file, from whose folder other files count.
        time_limit: seconds after which it is stopped at the end of its step.
        key: of the task when the sweep was read; it fails if it has another one now, since a file has changed.
        model: `rod`, or `uniform_rod` for the estimate by a coil whose state is the same all along the wire.
        keys: of cases evaluated together, for which a file is read once.
        estimates: whether rods estimate the errors of their mesh, section and contact, which takes a companion.

    Returns:
        The record, plain data: `key`, `status` ("done" or "failed"), `reason`, `seconds`, `summary`, `steps` (columns
        of the history; none of the uniform rod). A case that fails midway keeps its results so far.
    """
    began, keys = time.perf_counter(), keys or Keys()
    reason, analysis = "", None
    record: dict[str, Any] = {"key": key, "status": "failed", "reason": "", "summary": {}, "steps": {}}
    try:
        case = check(data, file)
        if model == "rod":
            analysis = Analysis(case, comm, detailed=False, estimates=estimates)
        else:
            record["summary"] = estimated(case, keys)
        if key is not None and keys(case, model) != key:  # as it is now that the files have been read
            raise InputError("a file that this case names has changed since the sweep was read; run the sweep again")
        if analysis is not None:
            analysis.run(watch(comm, began, time_limit))
    except CoilsetError as error:
        reason = str(error)
    except Exception as error:
        traceback.print_exc(file=sys.stderr)
        if comm.size > 1:  # perhaps on this rank only: the others would wait for it forever
            comm.Abort(1)
        reason = f"{type(error).__name__}: {error}"
    result = getattr(analysis, "result", None)
    record |= {"status": "failed" if reason else "done", "reason": reason}
    if analysis is not None and result is not None and result.snapshots and comm.rank == 0:
        record["summary"] = {key: plain(value) for key, value in summarise(analysis.setup, result).items()}
        record["steps"] = {
            column.name: [plain(getattr(step, column.name)) for step in result.steps] for column in fields(Step)
        }
    return {**record, "seconds": time.perf_counter() - began}


def estimated(case: Case, keys: Keys) -> dict[str, Any]:
    """Entries of the summary as the uniform rod estimates them."""
    spring = case.spring.build()
    law = keys.law(case.material) if isinstance(case.material, str) else case_law(case, spring)
    numbers = estimate(case, spring, law).numbers
    return {name: plain(value) for name, value in numbers.items() if name in NUMBERS or is_working_number(name)}


def evaluate_in_worker(tasks: list[Task], comm: MPI.Comm) -> list[Record]:
    """`evaluate` each task of a message in a process that does nothing else."""
    keys = Keys()
    return [evaluate(comm=comm, keys=keys, **task) for task in tasks]


def plain(value: Any) -> Any:
    """A value that JSON can hold: NaN becomes None."""
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def watch(comm: MPI.Comm, began: float, time_limit: float | None) -> Callable[[Step], None]:
    """A report for each step that stops the case at its time limit, by rank 0's clock."""

    def report(step: Step) -> None:
        if time_limit is not None and comm.bcast(time.perf_counter() - began > time_limit):
            raise SolveError(f"stopped at the time limit of {time_limit:g} s")

    return report
