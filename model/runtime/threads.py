"""Threads of one process, among which the sections of its rods are divided: numba's, of OpenMP or TBB.

The law takes most of the time, and sections know nothing of each other. No number depends on how many threads there
are: one of them computes all of a section, by the same compiled function.
"""

from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numba
import numpy as np

from coilset.model.runtime.processes import usable_cores

LEAST = 512  # section points of a thread: they take the law some 50 µs, ten times as long as it takes to share them out


def usual(ranks: int) -> int:
    """Threads of each of so many ranks unless the user says: of one alone as many as it may use cores, else one."""
    return usable_cores() if ranks == 1 else 1


class Threads:
    """The calling thread and those that help it.

    Args:
        number: of all of them. There are no more than cores, and the calling one alone where numba finds neither
            OpenMP nor TBB: its own threads take longer than they save.
    """

    def __init__(self, number: int = 1) -> None:
        self.number = number
        if number > 1:
            if numba.config.THREADING_LAYER == "default":  # which may be threads of numba's own
                numba.config.THREADING_LAYER = "threadsafe"
            try:
                numba.get_num_threads()
            except ValueError:
                self.number = 1

    def ends(self, count: int, points: int) -> np.ndarray:
        """Where as many equal parts of `count` things begin and end as there are threads, shape (parts + 1,).

        Args:
            points: of the sections in each of them, of which a part has LEAST, or it is all.
        """
        return _ends(max(1, min(self.number, count, count * points // LEAST)), count)

    def run(self, part: Callable[..., Any], parts: Callable[..., Any], count: int, points: int, *arguments: Any) -> Any:
        """Have compiled functions do some work: all of it by `part`, or its parts side by side by `parts`.

        Args:
            part: called with the `ends`, the number of a part, and `arguments`.
            parts: called with the `ends` and `arguments`.
            count, points: as in `ends`.
        """
        ends = self.ends(count, points)
        if len(ends) == 2:
            return part(ends, 0, *arguments)
        numba.set_num_threads(min(len(ends) - 1, numba.config.NUMBA_NUM_THREADS))
        return parts(ends, *arguments)


@lru_cache
def _ends(parts: int, count: int) -> np.ndarray:
    """Where equal parts begin and end; the same few are asked for at every evaluation."""
    return np.arange(parts + 1) * count // parts
