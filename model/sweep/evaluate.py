"""One case of a sweep, from raw data to its record."""

import gc
import math
import sys
import time
import traceback
from collections.abc import Callable
from dataclasses import fields
from typing import Any

from mpi4py import MPI

from coilset.model.base.errors import CoilsetError, InputError, SolveError
from coilset.model.case import Case, check
from coilset.model.results.records.record import Step
from coilset.model.results.records.summary import summarise
from coilset.model.run.analysis import Analysis
from coilset.model.sweep.keys import Keys


def evaluate(
    data: dict[str, Any], comm: MPI.Comm, file: str = "", time_limit: float | None = None, key: str | None = None
) -> dict[str, Any]:
    """Run a case; errors are recorded instead of raised.

    Args:
        data: raw data of the case, as a case file holds it.
        comm: communicator of the ranks that solve it.
        file: the base case's file, from whose folder other files count.
        time_limit: seconds after which it is stopped at the end of its step.
        key: of the case when the sweep was read; it fails if it has another one now, since a file has changed.

    Returns:
        The record, plain data: `status` ("done" or "failed"), `reason`, `seconds`, `summary`, `steps` (columns of the
        history). A case that fails midway keeps its results so far.
    """
    began = time.perf_counter()
    reason, analysis = "", None
    try:
        case: Case = check(data, file)
        analysis = Analysis(case, comm, detailed=False)
        if key is not None and Keys()(case) != key:  # as it is now that the files have been read
            raise InputError("a file that this case names has changed since the sweep was read; run the sweep again")
        analysis.run(watch(comm, began, time_limit))
    except CoilsetError as error:
        reason = str(error)
    except Exception as error:
        traceback.print_exc(file=sys.stderr)
        if comm.size > 1:  # perhaps on this rank only: the others would wait for it forever
            comm.Abort(1)
        reason = f"{type(error).__name__}: {error}"
    result = getattr(analysis, "result", None)
    record: dict[str, Any] = {"status": "failed" if reason else "done", "reason": reason, "summary": {}, "steps": {}}
    if analysis is not None and result is not None and result.snapshots and comm.rank == 0:
        record["summary"] = {key: plain(value) for key, value in summarise(analysis.setup, result).items()}
        record["steps"] = {
            column.name: [plain(getattr(step, column.name)) for step in result.steps] for column in fields(Step)
        }
    del analysis, result
    gc.collect()  # solver and system refer to each other
    return {**record, "seconds": time.perf_counter() - began}


def evaluate_in_worker(**task: Any) -> dict[str, Any]:
    """`evaluate` in a process that does nothing else, the faster the more cases it has run.

    What is left after a case stays until the end: libraries, compiled functions. Later searches for garbage, which
    would take 12 ms longer each, skip it.
    """
    record = evaluate(**task)
    gc.freeze()
    return record


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
