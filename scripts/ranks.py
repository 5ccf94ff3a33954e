"""`coilset -n RANKS COMMAND`: the same command on several ranks.

This process remains the parent of mpirun. Open MPI's mpirun ends the ranks on SIGINT and SIGTERM, but passes SIGUSR1 on
to them. Signals are therefore converted to SIGUSR1, on which a solve ends after its step and keeps its results, as on
one rank. SIGTERM leaves them HURRY seconds for that; then they are ended, and the checkpoint has the steps before.
mpirun drops a signal that comes before it has started the ranks, so a file is left for them as well. A reader that
closes our output (`| head`) counts as a signal too. Messages of mpirun about ranks that ended with one of our exit
codes are suppressed, because the ranks have reported the reason in one line.
"""

import contextlib
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import IO, Protocol

from coilset.model.core.base.errors import InputError
from coilset.model.core.runtime.processes import (
    end_with_parent,
    folder_of_mpirun,
    mpi_environment,
    mpirun,
    usable_cores,
)
from coilset.scripts.interrupt import INTERRUPTED, STOPPED

PARALLEL = ("solve", "solid", "sweep", "python")
RANKS_A_CORE = 4
HURRY = 15  # seconds; batch systems leave some 30
OUTPUT_CLOSED = 128 + signal.SIGPIPE
OWN = (0, 2, 3, INTERRUPTED, OUTPUT_CLOSED)  # exit codes with a message of ours
RULER = b"-" * 74  # rulers around mpirun's messages


def check(ranks: int, command: str) -> None:
    """Reject an unreasonable number of ranks.

    Raises:
        InputError: a command that works on one rank, or more ranks than RANKS_A_CORE a core; the environment variable
            COILSET_MAX_RANKS allows more.
    """
    if ranks > 1 and command not in PARALLEL:
        raise InputError(f"'{command}' works on one rank only; omit -n", "-n")
    cores = usable_cores()
    given = os.environ.get("COILSET_MAX_RANKS", "")
    most = int(given) if given.isdigit() else RANKS_A_CORE * cores
    if ranks > most:
        raise InputError(
            f"{ranks} ranks on {cores} cores; give at most {most}, or set COILSET_MAX_RANKS to allow more", "-n"
        )


def launch(ranks: int, arguments: Sequence[str]) -> int:
    """Run `coilset ARGUMENTS` on some ranks; returns the exit code of the first that failed."""
    with folder_of_mpirun() as folder:
        command = [*mpirun(ranks), sys.executable, "-m", "coilset.scripts", *arguments]
        stopped = Path(*folder.values()) / "stopped"
        environment = mpi_environment() | folder | {"COILSET_RANKS": str(ranks), STOPPED: str(stopped)}
        return _run(command, environment, stopped)


def _run(command: list[str], environment: dict[str, str], stopped: Path) -> int:
    """Run mpirun, pass on its output and incoming signals, of which the file is left; returns its exit code."""
    process = subprocess.Popen(
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        bufsize=0,
        env=environment,
        process_group=0,
        preexec_fn=end_with_parent,
    )
    stops: list[int] = []  # exit codes for what stopped it

    def stop(code: int) -> None:
        stops.append(code)
        stopped.touch()
        with contextlib.suppress(ProcessLookupError):
            process.send_signal(signal.SIGUSR1)

    def hurry(*_: object) -> None:
        stop(INTERRUPTED)
        signal.alarm(HURRY)

    signal.signal(signal.SIGINT, lambda *_: stop(INTERRUPTED))
    signal.signal(signal.SIGTERM, hurry)
    signal.signal(signal.SIGALRM, lambda *_: process.terminate())
    messages = MpirunMessages(sys.stderr.buffer)
    pumps = [
        _pump(process.stdout, sys.stdout.buffer, lambda: stop(OUTPUT_CLOSED)),
        _pump(process.stderr, messages, lambda: None),
    ]
    code = process.wait()
    signal.alarm(0)
    for pump in pumps:
        pump.join()
    if stops and code:
        if not messages.interrupted:  # the signal came too early for the ranks to handle it
            print("coilset: interrupted", file=sys.stderr)
        code = INTERRUPTED
    elif code not in OWN:
        messages.show()
    if code == INTERRUPTED and OUTPUT_CLOSED in stops:
        return OUTPUT_CLOSED
    return code if code >= 0 else 128 - code  # ended by a signal


class Sink(Protocol):
    """A sink for bytes."""

    def write(self, data: bytes, /) -> object:
        """Take bytes."""

    def flush(self) -> object:
        """Pass them on."""


def _pump(source: IO[bytes] | None, target: Sink, closed: Callable[[], None]) -> threading.Thread:
    """Copy until the source ends; discard the data once the target's reader is gone."""

    def copy() -> None:
        broken = False
        while source and (data := os.read(source.fileno(), 65536)):
            try:
                if not broken:
                    target.write(data)
                    target.flush()
            except BrokenPipeError:
                broken = True
                closed()

    thread = threading.Thread(target=copy, daemon=True)
    thread.start()
    return thread


class MpirunMessages:
    """Passes lines on, but holds back mpirun's messages between rulers, and those about lost connections.

    Attributes:
        interrupted: whether a rank has reported an interruption.
    """

    def __init__(self, target: Sink):
        self.target, self.rest, self.kept, self.inside, self.interrupted = target, b"", b"", False, False

    def write(self, data: bytes) -> None:
        """Sort complete lines; an incomplete last line waits for its end."""
        *lines, self.rest = (self.rest + data).split(b"\n")
        for line in lines:
            ruler = line.startswith(RULER)
            if ruler or self.inside or b"PMIX ERROR" in line:
                self.kept += line + b"\n"
            else:
                self.target.write(line + b"\n")
            self.inside ^= ruler
            self.interrupted |= line == b"coilset: interrupted"

    def flush(self) -> None:
        """Flush the target."""
        self.target.flush()

    def show(self) -> None:
        """Write the lines that were held back."""
        self.target.write(self.kept + self.rest)
        self.flush()
