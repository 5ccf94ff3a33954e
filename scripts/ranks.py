"""`coilset -n RANKS COMMAND`: the same command on several ranks.

This process stays above mpirun. Open MPI's answers SIGINT and SIGTERM by ending the ranks, but hands SIGUSR1 on to
them: so signals become SIGUSR1, on which a solve ends after its step with results kept, as it does on one rank. A
reader that closes our output (`| head`) counts as a signal too. What mpirun says of ranks that ended with an exit code
of ours is left out: they have said it themselves, in one line.
"""

import contextlib
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Sequence
from typing import IO, Protocol

from coilset.meshes.errors import InputError
from coilset.model.processes import end_with_parent, mpi_environment, mpirun

PARALLEL = ("solve", "sweep", "python")
RANKS_A_CORE = 4
INTERRUPTED = 128 + signal.SIGINT
OUTPUT_CLOSED = 128 + signal.SIGPIPE
OWN = (0, 2, 3, INTERRUPTED, OUTPUT_CLOSED)  # exit codes that come with a line of ours
RULER = b"-" * 74  # around mpirun's messages


def check(ranks: int, command: str) -> None:
    """Refuse ranks that make no sense.

    Raises:
        InputError: a command that works on one rank, or more ranks than RANKS_A_CORE a core; the environment variable
            COILSET_MAX_RANKS allows more.
    """
    if ranks > 1 and command not in PARALLEL:
        raise InputError(f"'{command}' works on one rank only; omit -n", "-n")
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    given = os.environ.get("COILSET_MAX_RANKS", "")
    most = int(given) if given.isdigit() else RANKS_A_CORE * cores
    if ranks > most:
        raise InputError(f"{ranks} ranks on {cores} cores; give at most {most}, or set COILSET_MAX_RANKS to allow more",
                         "-n")  # fmt: skip


def launch(ranks: int, arguments: Sequence[str]) -> int:
    """Run `coilset ARGUMENTS` on some ranks; returns the exit code of the first that failed."""
    command = [*mpirun(ranks), sys.executable, "-m", "coilset.scripts", *arguments]
    process = subprocess.Popen(
        command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, bufsize=0,
        env=mpi_environment() | {"COILSET_RANKS": str(ranks)}, process_group=0, preexec_fn=end_with_parent,
    )  # fmt: skip
    stops: list[int] = []  # exit codes that what stopped it asks for

    def stop(code: int) -> None:
        stops.append(code)
        with contextlib.suppress(ProcessLookupError):
            process.send_signal(signal.SIGUSR1)

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: stop(INTERRUPTED))
    messages = MpirunMessages(sys.stderr.buffer)
    pumps = [_pump(process.stdout, sys.stdout.buffer, lambda: stop(OUTPUT_CLOSED)),
             _pump(process.stderr, messages, lambda: None)]  # fmt: skip
    code = process.wait()
    for pump in pumps:
        pump.join()
    if stops and code:
        if not messages.interrupted:  # the signal came too early for the ranks to end by themselves
            print("coilset: interrupted", file=sys.stderr)
        code = INTERRUPTED
    elif code not in OWN:
        messages.tell()
    if code == INTERRUPTED and OUTPUT_CLOSED in stops:
        return OUTPUT_CLOSED
    return code if code >= 0 else 128 - code  # ended by a signal


class Sink(Protocol):
    """Where bytes can be written."""

    def write(self, data: bytes, /) -> object:
        """Take them."""

    def flush(self) -> object:
        """Hand them on."""


def _pump(source: IO[bytes] | None, target: Sink, closed: Callable[[], None]) -> threading.Thread:
    """Copy until the source ends, into nothing from when the target's reader is gone."""

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
    """Writes lines on, but keeps what mpirun says between two rulers, and its complaints of lost connections.

    Attributes:
        interrupted: whether a rank has said that it was.
    """

    def __init__(self, target: Sink):
        self.target, self.rest, self.kept, self.inside, self.interrupted = target, b"", b"", False, False

    def write(self, data: bytes) -> None:
        """Sort whole lines; the last one waits for its end."""
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
        """Hand on what is written."""
        self.target.flush()

    def tell(self) -> None:
        """Write what was kept."""
        self.target.write(self.kept + self.rest)
        self.flush()
