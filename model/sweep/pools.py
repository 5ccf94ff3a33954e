"""Where the cases of a sweep run: processes of this machine, or the ranks of an MPI job.

Both provide `submit(task)`, which returns a future of the record, and `workers`, the number of cases run at a time.
"""

import json
import os
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from typing import IO, Any

WORKER = [sys.executable, "-m", "coilset.model.sweep.worker"]


class Process:
    """One worker process; it is restarted if a case crashes it.

    Args:
        environment: of the process, saved before MPI starts, which changes it.
        log: file for its output.
    """

    def __init__(self, environment: Mapping[str, str], log: IO[str]) -> None:
        self.environment, self.log = environment, log
        self.process: subprocess.Popen[str] | None = None

    def run(self, task: dict[str, Any]) -> dict[str, Any]:
        """The record of a task; the case fails if the process dies."""
        if self.process is None:
            self.process = subprocess.Popen(
                WORKER, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self.log, env=self.environment, text=True,
                encoding="utf-8", start_new_session=True,
            )  # fmt: skip
        process, answer = self.process, ""
        assert process.stdin is not None
        assert process.stdout is not None
        try:
            process.stdin.write(json.dumps(task) + "\n")
            process.stdin.flush()
            answer = process.stdout.readline()
        except BrokenPipeError:
            pass
        if answer.endswith("\n"):
            return json.loads(answer)
        status = process.wait()
        self.close()
        how = f"signal {-status}" if status < 0 else f"exit code {status}"
        return {"status": "failed", "reason": f"the process of this case ended with {how}", "summary": {}, "steps": {},
                "seconds": None}  # fmt: skip

    def close(self) -> None:
        """Kill the process."""
        process, self.process = self.process, None
        if process is not None:
            process.kill()
            process.wait()
            for pipe in (process.stdin, process.stdout):
                if pipe is not None:
                    pipe.close()


@contextmanager
def local_pool(jobs: int, environment: Mapping[str, str], log: IO[str]) -> Iterator["Pool"]:
    """A pool of `jobs` processes on this machine; leaving the context ends them."""
    own = threading.local()
    started, lock = [], threading.Lock()

    def begin() -> None:
        own.process = Process(environment, log)
        with lock:
            started.append(own.process)

    executor = ThreadPoolExecutor(jobs, initializer=begin)

    def submit(task: dict[str, Any]) -> Future[dict[str, Any]]:
        return executor.submit(lambda: own.process.run(task))

    try:
        yield Pool(submit, jobs)
    finally:
        executor.shutdown(wait=False, cancel_futures=True)
        for process in list(started):
            process.close()


class Pool:
    """The workers of a sweep, for the process that leads it."""

    def __init__(self, submit: Callable[[dict[str, Any]], Future[dict[str, Any]]], workers: int) -> None:
        self.submit, self.workers = submit, workers


def usable_cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0))
