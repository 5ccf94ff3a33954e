"""Threads of one process, among which the sections of its rods are divided.

The law takes most of the time, and sections are independent of each other. No number depends on how many threads there
are: one of them computes all of a section, by the same compiled function, which runs without Python's lock.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from typing import Any

import numpy as np

from coilset.model.core.runtime.processes import usable_cores

LEAST = 1024  # section points of a thread: the law takes some 100 µs for them, as long as a thread takes to begin


NOTHING = np.zeros(2, dtype=np.int64)  # ends of a part without sections


def usual(ranks: int) -> int:
    """Default number of threads per rank: as many as there are cores on one rank, else one."""
    return usable_cores() if ranks == 1 else 1


class Threads:
    """The calling thread and those that help it.

    Args:
        number: of all of them.
    """

    def __init__(self, number: int = 1) -> None:
        self.number = number

    def ends(self, count: int, points: int) -> np.ndarray:
        """Where equal parts of `count` things begin and end, one for each thread, shape (parts + 1,).

        Args:
            points: of the sections in each of them; a part has at least LEAST, or there is only one part.
        """
        return _ends(max(1, min(self.number, count, count * points // LEAST)), count)

    def run(self, part: Callable[..., bool | None], count: int, points: int, *arguments: Any) -> bool:
        """Have a compiled function do some work, its parts side by side.

        Args:
            part: called with the `ends`, the number of a part, and `arguments`; without Python's lock (`nogil`).
            count, points: as in `ends`.

        Returns:
            False if a part returned False.
        """
        ends = self.ends(count, points)
        if len(ends) > 2:
            part(NOTHING, 0, *arguments)  # loads the function: LLVM must not load it in several threads at a time
        others = [_pool().submit(part, ends, k, *arguments) for k in range(1, len(ends) - 1)]
        found = [part(ends, 0, *arguments), *(other.result() for other in others)]
        return False not in found


@lru_cache
def _ends(parts: int, count: int) -> np.ndarray:
    """Where equal parts begin and end; the same few are requested at every evaluation."""
    return np.arange(parts + 1, dtype=np.int64) * count // parts


@lru_cache
def _pool() -> ThreadPoolExecutor:
    """The threads that help, started when they are first needed."""
    return ThreadPoolExecutor(max(usable_cores() - 1, 1), "coilset")
