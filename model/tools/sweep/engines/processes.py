"""Cases in processes of this machine, which are started before the sweep is read and load their libraries meanwhile."""

import json
import subprocess
import sys
from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import Self

from coilset.model.tools.sweep.engines.pool import Pool, Record, Task

WORKER = [sys.executable, "-m", "coilset.model.tools.sweep.engines.worker"]


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

    def run(self, tasks: list[Task], log: str) -> list[Record]:
        """The records of tasks; if the process dies, each is run on its own, and the case that it dies of fails.

        Args:
            tasks: arguments of `evaluate`.
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
            process.stdin.write(json.dumps(tasks) + "\n")
            process.stdin.flush()
            answer = process.stdout.readline()
        except BrokenPipeError:
            pass
        if answer.endswith("\n"):
            return json.loads(answer)
        status = process.wait()
        self.close()
        if len(tasks) > 1:
            return [record for task in tasks for record in self.run([task], log)]
        how = f"signal {-status}" if status < 0 else f"exit code {status}"
        return [failed(tasks[0], f"the process of this case ended with {how}")]

    def close(self) -> None:
        """Kill the process."""
        process, self.process = self.process, None
        if process is not None:
            process.kill()
            process.wait()
            for pipe in (process.stdin, process.stdout):
                if pipe is not None:
                    pipe.close()


def failed(task: Task, reason: str) -> Record:
    """The record of a case without results."""
    return {"key": task.get("key"), "status": "failed", "reason": reason, "summary": {}, "steps": {}, "seconds": None}


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
    def pool(self, log: Path) -> Iterator[Pool]:
        """Pool of these processes, whose output goes to the end of a file; once."""
        free, executor = list(self._processes), ThreadPoolExecutor(self.jobs)

        def run(tasks: list[Task]) -> list[Record]:
            process = free.pop()  # there are as many as threads
            try:
                return process.run(tasks, str(log))
            finally:
                free.append(process)

        try:
            yield Pool(lambda tasks: executor.submit(run, tasks), self.jobs)
        finally:
            executor.shutdown(wait=False, cancel_futures=True)
