"""Where the cases of a sweep run: processes of this machine, or the ranks of an MPI job.

Both provide `submit(task)`, which returns a future of the record, and `workers`, the number of cases run at a time.
The processes are started before the sweep is read and checked, and load their libraries meanwhile.
"""

import json
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Self

WORKER = [sys.executable, "-m", "coilset.model.sweep.worker"]


class Process:
    """One worker process, which loads its libraries from now on; it is restarted if a case crashes it.

    Args:
        environment: of the process, saved before MPI starts, which changes it.
    """

    def __init__(self, environment: Mapping[str, str]) -> None:
        self.environment, self.log = environment, ""
        self.process: subprocess.Popen[str] | None = self._started()

    def _started(self) -> "subprocess.Popen[str]":
        return subprocess.Popen(
            WORKER,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=self.environment,
            text=True,
            encoding="utf-8",
            start_new_session=True,
        )

    def run(self, task: dict[str, Any], log: str) -> dict[str, Any]:
        """The record of a task; the case fails if the process dies.

        Args:
            task: arguments of `evaluate`.
            log: file for the process's output from the first task on.
        """
        if self.process is None:
            self.process, self.log = self._started(), ""
        process, answer = self.process, ""
        assert process.stdin is not None
        assert process.stdout is not None
        try:
            if not self.log:
                self.log = log
                process.stdin.write(json.dumps(log) + "\n")
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
        return {
            "status": "failed",
            "reason": f"the process of this case ended with {how}",
            "summary": {},
            "steps": {},
            "seconds": None,
        }

    def close(self) -> None:
        """Kill the process."""
        process, self.process = self.process, None
        if process is not None:
            process.kill()
            process.wait()
            for pipe in (process.stdin, process.stdout):
                if pipe is not None:
                    pipe.close()


class Workers:
    """Processes of this machine; leaving this context ends them.

    Args:
        jobs: their number.
        environment: as in Process.
    """

    def __init__(self, jobs: int, environment: Mapping[str, str]) -> None:
        self.jobs, self.environment = jobs, environment
        self._processes: list[Process] = []

    def __enter__(self) -> Self:
        for _job in range(self.jobs):
            self._processes.append(Process(self.environment))
        return self

    def __exit__(self, *problem: object) -> None:
        for process in self._processes:
            process.close()

    @contextmanager
    def pool(self, log: Path) -> Iterator["Pool"]:
        """Pool of these processes, whose output goes to the end of a file; once."""
        own, free = threading.local(), list(self._processes)

        def begin() -> None:
            own.process = free.pop()

        executor = ThreadPoolExecutor(self.jobs, initializer=begin)

        def submit(task: dict[str, Any]) -> Future[dict[str, Any]]:
            return executor.submit(lambda: own.process.run(task, str(log)))

        try:
            yield Pool(submit, self.jobs)
        finally:
            executor.shutdown(wait=False, cancel_futures=True)


class Pool:
    """The workers of a sweep, for the process that leads it."""

    def __init__(self, submit: Callable[[dict[str, Any]], Future[dict[str, Any]]], workers: int) -> None:
        self.submit, self.workers = submit, workers
