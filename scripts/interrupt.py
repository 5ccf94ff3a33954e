"""Graceful early ends of a run: Ctrl-C, a batch system's SIGTERM, and a reader that closes our output.

During a solve the step in progress is finished, then the run ends; a second Ctrl-C ends it at once. SIGTERM, after
which a batch system leaves some 30 s, leaves the step on one rank: what was found before it is kept.
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
AGAIN = 0.02  # seconds after which SIGTERM is considered again, where no step was being solved
ITERATION = "coilset.model.core.equilibrium.newton.snes"  # module whose function `solve` calls PETSc
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

    Between steps the state is consistent. SIGTERM raises it on a single rank as soon as PETSc iterates: of several, the
    others would wait for this one, see scripts/ranks.py.

    Attributes:
        hurries: whether there is no time for more than writing results.
    """

    def __init__(self, comm: "MPI.Comm", say: Callable[[str], Any]):
        self.comm, self.say, self.noted, self.hurries = comm, say, 0.0, False

    def _note(self, number: int, frame: FrameType | None) -> None:
        now, self.hurries = time.monotonic(), self.hurries or number == signal.SIGTERM
        if self.noted and now - self.noted > ONE_SIGNAL:
            os._exit(INTERRUPTED)  # the last checkpoint is complete in any case
        if not self.noted:
            self.noted = now
            self.say("leaving this step" if self.hurries else "finishing this step; once more ends at once")
        if self.hurries and self.comm.size == 1:
            self._leave_step(number, frame)

    def _leave_step(self, number: int, frame: FrameType | None) -> None:
        if _iterates(frame):
            raise KeyboardInterrupt
        signal.setitimer(signal.ITIMER_REAL, AGAIN)

    def __enter__(self) -> "Interrupt":
        postponed = signal.setitimer(signal.ITIMER_REAL, 0.0)[0] > 0.0  # one that came during an import
        self.before = {number: signal.signal(number, self._note) for number in STOPS}
        self.before[signal.SIGALRM] = signal.signal(signal.SIGALRM, self._leave_step)
        if postponed:
            self._note(signal.SIGINT, None)
        return self

    def __exit__(self, *_: object) -> None:
        self.over()

    def over(self) -> None:
        """Restore the previous handlers of STOPS."""
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        for number, handler in self.before.items():
            signal.signal(number, handler)

    def stopped(self) -> bool:
        """Whether any rank was interrupted or has lost its output; collective."""
        noted = bool(self.noted) or output_closed()
        return self.comm.allreduce(int(noted)) > 0 if self.comm.size > 1 else noted

    def check(self) -> None:
        """Raise KeyboardInterrupt if any rank was interrupted or has lost its output; collective."""
        if self.stopped():
            raise KeyboardInterrupt


def _iterates(frame: FrameType | None) -> bool:
    """Is PETSc solving for a step there? An exception in its callbacks does no harm to what was found before."""
    while frame is not None:
        if frame.f_code.co_name == "solve" and frame.f_globals.get("__name__") == ITERATION:
            return True
        frame = frame.f_back
    return False
