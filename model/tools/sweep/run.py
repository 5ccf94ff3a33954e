"""Run the missing cases of a plan, and record each as it ends."""

import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, wait
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np

from coilset.model.tools.sweep.engines.pool import Pool, Record, Task
from coilset.model.tools.sweep.journal import Journal, journals, read_records
from coilset.model.tools.sweep.packed import Strings
from coilset.model.tools.sweep.plan import Plan, Work
from coilset.model.tools.sweep.shards import WHOLE, Shard

AHEAD = 2  # messages submitted per worker, so that none is idle
MESSAGE_SECONDS = 0.5  # of work in one message: short cases share one, which costs about 0.4 ms
MOST_TASKS = 500  # of one message


def finished(folder: str | Path, retry: bool) -> Strings:
    """Keys of the cases in the journals of a folder, without the failed ones if they are to be rerun."""
    done = (record for path in journals(folder) for record in read_records(path))
    return Strings(record["key"] for record in done if not (retry and record["status"] == "failed"))


def missing(plan: Plan, done: Iterable[str], shard: Shard = WHOLE) -> np.ndarray:
    """Numbers for `Plan.work` of what is not in `done`, each once; of a shard, its cases by each model."""
    keys, numbers = plan.task_keys, np.array(shard.cases(len(plan)), dtype=int)
    numbers = np.concatenate([numbers, len(plan) + numbers[numbers < plan.spec.rods]])
    _, first = np.unique(keys[numbers], return_index=True)
    numbers = numbers[np.sort(first)]
    there = np.sort(done.array if isinstance(done, Strings) else Strings(done).array)
    if len(there):
        numbers = numbers[there[np.searchsorted(there[:-1], keys[numbers])] != keys[numbers]]
    return numbers


@dataclass
class Limits:
    """When a sweep ends although cases are missing.

    Attributes:
        until: seconds from `began` by which it ends, as far as the cases so far allow a prediction.
        budget: seconds of all cases together, on one core each, after which no case is started.
        began: time.monotonic() of the start.
    """

    until: float = float("inf")
    budget: float = float("inf")
    began: float = 0.0

    def reached(self, used: float, longest: float) -> bool:
        """Whether to start no further message, from the seconds used by all cases and by the longest message."""
        return used >= self.budget or time.monotonic() - self.began + AHEAD * longest >= self.until


def run(
    plan: Plan,
    todo: Iterable[Work],
    pool: Pool,
    journal: Journal,
    report: Callable[[Record], object] = lambda record: None,
    limits: Limits | None = None,
) -> None:
    """Run the cases of `todo`.

    Args:
        todo: see `Plan.work`.
        pool: where they run.
        report: called with each record after it is written.
        limits: when it ends although cases are missing.
    """
    tasks = (plan.task(*case) for case in todo)
    waiting: set[Future[list[Record]]] = set()
    try:
        _keep_busy(tasks, pool, journal, report, limits or Limits(), waiting)
    finally:
        for future in waiting:
            future.cancel()


def _keep_busy(
    tasks: Iterator[Task],
    pool: Pool,
    journal: Journal,
    report: Callable[[Record], object],
    limits: Limits,
    waiting: set[Future[list[Record]]],
) -> None:
    used, count, longest = 0.0, 0, 0.0
    while True:
        size = 1 if not count else min(max(int(MESSAGE_SECONDS * count / max(used, 1e-9)), 1), MOST_TASKS)
        while len(waiting) < AHEAD * pool.workers and not limits.reached(used, longest):
            message = list(islice(tasks, size))
            if not message:
                break
            waiting.add(pool.submit(message))
        if not waiting:
            return
        for future in wait(waiting, return_when=FIRST_COMPLETED).done:
            waiting.remove(future)
            records = future.result()
            for record in records:
                journal.append(record)
                report(record)
            seconds = sum(record["seconds"] or 0.0 for record in records)
            used, count, longest = used + seconds, count + len(records), max(longest, seconds)
