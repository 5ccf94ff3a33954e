"""Graceful early ends of a run: Ctrl-C, a batch system's SIGTERM, and a reader that closes our output.

During a solve the step in progress is finished, then the run ends; a second Ctrl-C ends it at once.
"""

import io
import os
import signal
import sys
import time
from collections.abc import Callable
from types import FrameType
from typing import TYPE_CHECKING, Any, TextIO

if TYPE_CHECKING:  # the command needs the numbers below before MPI is started
    from mpi4py import MPI

INTERRUPTED = 128 + signal.SIGINT  # exit code
STOPS = (signal.SIGINT, signal.SIGTERM, signal.SIGUSR1)  # SIGUSR1: how mpirun passes them on, see scripts/ranks.py
STOPPED = "COILSET_STOPPED"  # variable with the file by which ranks learn of a signal that came before them
ONE_SIGNAL = 0.5  # seconds within which several signals count as one: `timeout` signals a process and its group


class Output:
    """A text stream that discards output once nobody reads it, instead of raising BrokenPipeError.

    A letter that its encoding lacks, such as the π of a formula in ASCII, becomes a question mark.

    Attributes:
        closed_by_reader: whether that has happened.
    """

    def __init__(self, stream: TextIO):
        self.stream, self.closed_by_reader = stream, False
        if isinstance(stream, io.TextIOWrapper) and stream.errors == "strict":
            stream.reconfigure(errors="replace")

    def write(self, text: str) -> int:
        """Write or discard; returns the number of characters."""
        try:
            return self.stream.write(text)
        except BrokenPipeError:
            self._drop()
            return len(text)

    def flush(self) -> None:
        """Flush or discard."""
        try:
            self.stream.flush()
        except BrokenPipeError:
            self._drop()

    def _drop(self) -> None:
        self.closed_by_reader = True
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, self.stream.fileno())  # also for what is still in buffers
        os.close(nowhere)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.stream, name)


def output_closed() -> bool:
    """Whether the reader of standard output has closed it."""
    return getattr(sys.stdout, "closed_by_reader", False)


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
