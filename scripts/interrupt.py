"""Graceful early ends of a run: Ctrl-C, a batch system's SIGTERM, and a reader that closes our output.

During a solve the step in progress is finished, then the run ends; a second Ctrl-C ends it at once.
"""

import os
import signal
import time
from collections.abc import Callable
from types import FrameType
from typing import TYPE_CHECKING, Any

from coilset.scripts.terminal.output import output_closed

if TYPE_CHECKING:  # the command asks for the numbers below before MPI is started
    from mpi4py import MPI

INTERRUPTED = 128 + signal.SIGINT  # exit code
STOPS = (signal.SIGINT, signal.SIGTERM, signal.SIGUSR1)  # SIGUSR1: how mpirun passes them on, see scripts/ranks.py
ONE_SIGNAL = 0.5  # seconds within which several signals count as one: `timeout` signals a process and its group


class Interrupt:
    """Context in which STOPS are noted; `check` raises KeyboardInterrupt on all ranks.

    An exception inside PETSc's callbacks would be unsafe; between steps the state is consistent.
    """

    def __init__(self, comm: "MPI.Comm", say: Callable[[str], Any]):
        self.comm, self.say, self.noted = comm, say, 0.0

    def _note(self, number: int, frame: FrameType | None) -> None:
        now = time.monotonic()
        if self.noted and now - self.noted > ONE_SIGNAL:
            os._exit(INTERRUPTED)  # the last checkpoint is complete in any case
        if not self.noted:
            self.noted = now
            self.say("finishing this step; once more ends at once")

    def __enter__(self) -> "Interrupt":
        self.before = {number: signal.signal(number, self._note) for number in STOPS}
        return self

    def __exit__(self, *_: object) -> None:
        self.over()

    def over(self) -> None:
        """Restore the previous handlers of STOPS."""
        for number, handler in self.before.items():
            signal.signal(number, handler)

    def check(self) -> None:
        """Raise KeyboardInterrupt if any rank was interrupted or has lost its output; collective."""
        noted = bool(self.noted) or output_closed()
        if self.comm.size > 1:
            noted = self.comm.allreduce(int(noted)) > 0
        if noted:
            raise KeyboardInterrupt
