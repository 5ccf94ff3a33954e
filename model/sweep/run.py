"""Run the missing cases of a plan, and record each as it ends."""

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, wait
from pathlib import Path
from typing import Any

from coilset.model.sweep.design import Row
from coilset.model.sweep.journal import Journal, read_records
from coilset.model.sweep.plan import Plan
from coilset.model.sweep.pools import Pool

AHEAD = 2  # tasks submitted per worker, so that none is idle


def finished(path: str | Path, retry: bool) -> set[str]:
    """Keys of the cases in a journal, without the failed ones if they are to be rerun."""
    return {record["key"] for record in read_records(path) if not (retry and record["status"] == "failed")}


def missing(plan: Plan, done: Iterable[str]) -> Iterator[tuple[Row, str]]:
    """Rows and keys of the cases not in `done`, each once."""
    seen = set(done)
    for row, key in zip(plan.rows, plan.keys, strict=True):
        if key not in seen:
            seen.add(key)
            yield row, key


def run(
    plan: Plan,
    todo: Iterable[tuple[Row, str]],
    pool: Pool,
    journal: Journal,
    report: Callable[[dict[str, Any]], object] = lambda record: None,
) -> None:
    """Run the cases of `todo`.

    Args:
        plan: Plan.
        todo: rows and keys, see `missing`.
        pool: where they run.
        journal: Journal.
        report: called with each record after it is written.
    """
    waiting: dict[Future[dict[str, Any]], str] = {}
    try:
        _keep_busy(plan, iter(todo), pool, journal, report, waiting)
    finally:
        for future in waiting:
            future.cancel()


def _keep_busy(
    plan: Plan,
    todo: Iterator[tuple[Row, str]],
    pool: Pool,
    journal: Journal,
    report: Callable[[dict[str, Any]], object],
    waiting: dict[Future[dict[str, Any]], str],
) -> None:
    while True:
        while len(waiting) < AHEAD * pool.workers and (case := next(todo, None)) is not None:
            row, key = case
            waiting[pool.submit(plan.task(row) | {"key": key})] = key
        if not waiting:
            return
        for future in wait(waiting, return_when=FIRST_COMPLETED).done:
            record = {"key": waiting.pop(future), **future.result()}
            journal.append(record)
            report(record)
