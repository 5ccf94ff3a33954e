"""Seconds by stage, elapsed and of processor time."""

import time
from collections import defaultdict
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any


class Stopwatch:
    """Charges time to the innermost open stage, so that stages do not count each other's time.

    Attributes:
        wall, cpu: stage → elapsed seconds, and processor seconds of this process.
    """

    def __init__(self) -> None:
        self.wall: defaultdict[str, float] = defaultdict(float)
        self.cpu: defaultdict[str, float] = defaultdict(float)
        self._open: list[str] = []
        self._last = (0.0, 0.0)

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """What happens inside belongs to the stage `name`."""
        self._charge()
        self._open.append(name)
        try:
            yield
        finally:
            self._charge()
            self._open.pop()

    def _charge(self) -> None:
        now = time.perf_counter(), time.process_time()
        if self._open:
            self.wall[self._open[-1]] += now[0] - self._last[0]
            self.cpu[self._open[-1]] += now[1] - self._last[1]
        self._last = now

    def watch(self, owner: object, function: str, name: str) -> None:
        """Make calls of a function of `owner`, an object or a module, count as the stage `name`."""
        inner = getattr(owner, function)

        def watched(*arguments: Any, **named: Any) -> Any:
            with self.stage(name):
                return inner(*arguments, **named)

        setattr(owner, function, watched)

    def split(self, name: str, shares: Mapping[str, float]) -> None:
        """Divide a stage: `shares` maps new stages to wall seconds measured elsewhere; the remainder keeps the name.

        Processor seconds are divided in the same ratio.
        """
        ratio = self.cpu[name] / self.wall[name] if self.wall[name] else 0.0
        for part, seconds in shares.items():
            for kind, amount in ((self.wall, seconds), (self.cpu, seconds * ratio)):
                kind[part] += amount
                kind[name] -= amount
