"""What an engine is to a sweep: somewhere that turns lists of tasks into lists of records."""

from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass
from typing import Any

Task = dict[str, Any]  # arguments of `evaluate`
Record = dict[str, Any]


@dataclass(frozen=True)
class Pool:
    """The workers of a sweep, for the process that leads it.

    Attributes:
        submit: sends tasks to one worker in one message; the future's result is their records, in the same order.
        workers: number of messages that are worked on at a time.
    """

    submit: Callable[[list[Task]], Future[list[Record]]]
    workers: int
