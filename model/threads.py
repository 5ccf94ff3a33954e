"""Threads of one process, among which the sections of its rods are divided.

The law takes most of the time, and sections know nothing of each other. Its compiled loops let go of Python's lock, so
that threads run side by side on as many cores. No number depends on how many there are: one of them computes all of a
section.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from itertools import pairwise
from typing import TypeVar

from coilset.model.processes import usable_cores

T = TypeVar("T")
R = TypeVar("R")


def usual(ranks: int) -> int:
    """Threads of each of so many ranks unless the user says: of one alone as many as it may use cores, else one."""
    return usable_cores() if ranks == 1 else 1


class Threads:
    """The calling thread and those that help it.

    Args:
        number: of all of them.
    """

    def __init__(self, number: int = 1) -> None:
        self.number = number
        self._helpers = ThreadPoolExecutor(number - 1, "sections") if number > 1 else None

    def shares(self, count: int, least: int) -> list[slice]:
        """As many equal parts of `count` things as there are threads, but each of `least` of them or all."""
        parts = max(1, min(self.number, count // max(least, 1)))
        ends = [count * part // parts for part in range(parts + 1)]
        return [slice(*pair) for pair in pairwise(ends)]

    def map(self, work: Callable[[T], R], shares: Sequence[T]) -> list[R]:
        """What `work` makes of each share; it raises what one of them raises, when none is at work any more."""
        if self._helpers is None or len(shares) == 1:
            return [work(share) for share in shares]
        others = [self._helpers.submit(work, share) for share in shares[1:]]
        try:
            mine = work(shares[0])
        finally:
            wait(others)
        return [mine, *(other.result() for other in others)]
