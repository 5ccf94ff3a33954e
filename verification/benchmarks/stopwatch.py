"""Seconds by stage, of the clock and of the processor."""

import time
from collections import defaultdict
from contextlib import contextmanager


class Stopwatch:
    """Charges time to the innermost open stage, so that stages do not count each other's time.

    Attributes:
        wall, cpu: stage → seconds of the clock, and of this process on the processor.
    """

    def __init__(self):
        self.wall, self.cpu = defaultdict(float), defaultdict(float)
        self._open, self._last = [], (0.0, 0.0)

    @contextmanager
    def stage(self, name):
        """What happens inside belongs to the stage `name`."""
        self._charge()
        self._open.append(name)
        try:
            yield
        finally:
            self._charge()
            self._open.pop()

    def _charge(self):
        now = time.perf_counter(), time.process_time()
        if self._open:
            self.wall[self._open[-1]] += now[0] - self._last[0]
            self.cpu[self._open[-1]] += now[1] - self._last[1]
        self._last = now

    def watch(self, owner, function, name):
        """Make calls of a function of `owner`, an object or a module, count as the stage `name`."""
        inner = getattr(owner, function)

        def watched(*arguments, **named):
            with self.stage(name):
                return inner(*arguments, **named)

        setattr(owner, function, watched)

    def split(self, name, shares):
        """Divide a stage: `shares` maps new stages to wall seconds measured elsewhere; what is left keeps the name.

        Seconds of the processor are divided in the same ratio.
        """
        ratio = self.cpu[name] / self.wall[name] if self.wall[name] else 0.0
        for part, seconds in shares.items():
            for kind, amount in ((self.wall, seconds), (self.cpu, seconds * ratio)):
                kind[part] += amount
                kind[name] -= amount
