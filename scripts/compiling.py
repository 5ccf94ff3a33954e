"""A separate process compiles forms and kernels before a command starts; a notice is printed, since it takes a while.

A process that compiles a kernel and one that loads it do not compute with the same machine code: what kernels share is
assembled in the order in which they come. The results would differ in their last digits, and a resumed run
would not equal an uninterrupted one.
"""

import contextlib
import fcntl
import logging
import os
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from coilset.model.core.runtime.caches import folder, load_without_compiler, toolchain, version
from coilset.model.core.runtime.processes import end_with_parent, first_rank

STAGES = ("rod", "creep", "uniform", "point")  # see precompile.py; the first run of a spring needs only the first
NOTICE = "coilset: compiling forms and kernels, once after an installation or a change; this takes a minute or two ..."
NOTICE_OF_PART = "coilset: compiling what this command needs, once ..."
COMPILE = [sys.executable, "-m", "coilset.scripts", "compile"]
OF_A_RANK = ("OMPI_", "PMI", "PRTE_")  # variables by which mpirun marks a process as a rank, but for
ALLOWED = "OMPI_ALLOW_"  # those without which it starts none as root


class Announcement(logging.Handler):
    """Prints a notice at the first sign of a compiler: a log record of FFCx, or an event of numba.

    Args:
        say: prints a line.
        notice: the line.
    """

    def __init__(self, say: Callable[[str], None], notice: str):
        super().__init__(logging.INFO)
        self.say, self.notice, self.said = say, notice, False

    def emit(self, record: logging.LogRecord) -> None:
        """FFCx reports its stages, for forms that are not in its cache; its warnings are the user's."""
        if record.levelno > logging.INFO:
            self.say(record.getMessage())
        elif record.getMessage().startswith("Compiler stage"):
            self.show()

    def show(self) -> None:
        """Once."""
        if not self.said:
            self.said = True
            self.say(self.notice)


def _to_stderr(line: str) -> None:
    if first_rank():
        print(line, file=sys.stderr, flush=True)


def show(line: str) -> None:
    """A line of progress: on a terminal the next one takes its place."""
    if first_rank():
        print(
            f"\r\033[K{line}" if sys.stderr.isatty() else line,
            end="" if sys.stderr.isatty() else "\n",
            file=sys.stderr,
            flush=True,
        )


def compile_first(
    check: Callable[[], object] = bool, say: Callable[[str], None] = _to_stderr, stages: Sequence[str] = STAGES
) -> None:
    """Have another process compile the kernels of some stages, if that has not been done; others that need them wait.

    Args:
        check: checks the command's input first, so that errors in it are reported immediately.
        say: prints a line.
        stages: of STAGES.

    Raises:
        InputError: by `check`.
    """
    if not (missing := _missing(stages)):
        return
    check()
    say(NOTICE)
    begun = time.monotonic()
    environment = {
        name: value for name, value in os.environ.items() if name.startswith(ALLOWED) or not name.startswith(OF_A_RANK)
    }
    with contextlib.suppress(OSError):  # if nothing can be stored, each process compiles for itself
        marker = compiled(STAGES[0])
        marker.parent.mkdir(parents=True, exist_ok=True)
        with open(marker.with_suffix(".lock"), "w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if missing := _missing(stages):
                with subprocess.Popen(
                    [*COMPILE, *missing],
                    env=environment,
                    stdin=subprocess.DEVNULL,
                    stdout=subprocess.PIPE,
                    stderr=subprocess.DEVNULL,
                    text=True,
                    preexec_fn=end_with_parent,
                ) as process:
                    assert process.stdout is not None
                    for line in process.stdout:  # its stages
                        show(line.rstrip())
    if not _missing(stages):
        if sys.stderr.isatty():
            show("")
        say(f"coilset: compiled in {time.monotonic() - begun:.0f} s")


def _missing(stages: Sequence[str]) -> list[str]:
    return [stage for stage in stages if not compiled(stage).exists()]


def compiled(stage: str) -> Path:
    """The file that marks a stage as compiled for this version and environment; see `runtime/caches.py`."""
    return folder() / f"compiled-{version()}-{toolchain()}-{stage}"


def announce_compiling(say: Callable[[str], None] = _to_stderr, notice: str = NOTICE_OF_PART) -> Announcement:
    """Announce the first compilation of this process by a line."""
    load_without_compiler()
    from numba.core import event

    announcement = Announcement(say, notice)

    class Compiling(event.Listener):
        """Functions that numba loads from its cache cause no such event."""

        def on_start(self, event: object) -> None:
            announcement.show()

        def on_end(self, event: object) -> None:
            pass

    event.register("numba:compile", Compiling())
    logger = logging.getLogger("ffcx")
    logger.addHandler(announcement)
    logger.setLevel(logging.INFO)
    logger.setLevel = lambda level: None  # type: ignore[method-assign]  # FFCx sets it again for each form
    logger.propagate = False
    return announcement
