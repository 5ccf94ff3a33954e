"""One case of a sweep, from raw data to the record that is kept of it."""

import gc
import math
import signal
import sys
import threading
import time
import traceback
from contextlib import contextmanager
from dataclasses import asdict, fields

from coilset.model.analysis import Analysis
from coilset.model.case import check
from coilset.model.errors import CoilsetError
from coilset.model.loading.stepper import Step
from coilset.model.results.summary import summarise


class TimeOver(CoilsetError):
    """A case took longer than its time limit."""


def evaluate(data, comm, time_limit=None):
    """Run a case; nothing that goes wrong in it gets out, but is recorded.

    Args:
        data: raw data of the case, as a case file holds it.
        comm: communicator of the ranks that solve it.
        time_limit: seconds after which it is given up, for a case on one rank.

    Returns:
        The record, plain data: `status` ("done" or "failed"), `reason`, `seconds`, `summary`, `steps` (columns of the
        history). A case that fails on its way keeps what it found up to there.
    """
    began = time.perf_counter()
    reason, analysis = "", None
    try:
        with limited(time_limit):
            analysis = Analysis(check(data), comm)
            result = analysis.run()
    except TimeOver as error:
        reason = str(error)
        if hasattr(analysis, "result"):
            analysis.system.restore()
            analysis.result.snapshots.append(analysis.snapshot("given up"))
    except CoilsetError as error:
        reason = str(error)
    except Exception as error:
        traceback.print_exc(file=sys.stderr)
        if comm.size > 1:  # perhaps on this rank only: the others would wait for it for ever
            comm.Abort(1)
        reason = f"{type(error).__name__}: {error}"
    result = getattr(analysis, "result", None)
    record = {"status": "failed" if reason else "done", "reason": reason, "summary": {}, "steps": {}}
    if result is not None and result.snapshots and comm.rank == 0:
        record["summary"] = {key: plain(value) for key, value in summarise(analysis, result).items()}
        rows = [asdict(step) for step in result.steps]
        record["steps"] = {column.name: [plain(row[column.name]) for row in rows] for column in fields(Step)}
    del analysis, result
    gc.collect()  # solver and system hold each other
    return {**record, "seconds": time.perf_counter() - began}


def plain(value):
    """A value that JSON can hold: what is not a number becomes None."""
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


@contextmanager
def limited(seconds):
    """Raise TimeOver inside when `seconds` are over (None: never)."""
    if seconds is None or threading.current_thread() is not threading.main_thread():
        yield
        return

    def over(*_):
        raise TimeOver(f"given up after the time limit of {seconds:g} s")

    before = signal.signal(signal.SIGALRM, over)
    signal.setitimer(signal.ITIMER_REAL, seconds, 1.0)  # again every second, should one be lost in a callback
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
