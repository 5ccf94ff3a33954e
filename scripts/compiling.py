"""A word when something is compiled, which happens once and takes its time."""

import logging
import os
import sys
from collections.abc import Callable
from pathlib import Path

from coilset.model.caches import load_without_compiler
from coilset.model.processes import first_rank

NOTICE = "coilset: compiling forms and kernels, once, about 20 s ..."


class Announcement(logging.Handler):
    """Says NOTICE at the first sign of a compiler: a record of FFCx, or an event of numba.

    Args:
        say: prints a line.
    """

    def __init__(self, say: Callable[[str], None]):
        super().__init__(logging.INFO)
        self.say, self.said = say, False

    def emit(self, record: logging.LogRecord) -> None:
        """FFCx reports its stages, for forms that are not in its cache; its warnings are the user's."""
        if record.levelno > logging.INFO:
            self.say(record.getMessage())
        elif record.getMessage().startswith("Compiler stage"):
            self.tell()

    def tell(self) -> None:
        """Once."""
        if not self.said:
            self.said = True
            self.say(NOTICE)


def _to_stderr(line: str) -> None:
    if first_rank():
        print(line, file=sys.stderr, flush=True)


def announce_if_cold(say: Callable[[str], None] = _to_stderr) -> None:
    """For commands whose work is done by other processes: say NOTICE if there are no kernels of this version yet."""
    folder = Path(os.environ["NUMBA_CACHE_DIR"])  # see coilset.model.caches
    if not any(folder.rglob("*.nbi")):
        say(NOTICE)


def announce_compiling(say: Callable[[str], None] = _to_stderr) -> Announcement:
    """Have the first compilation of this process announced."""
    load_without_compiler()
    from numba.core import event

    announcement = Announcement(say)

    class Compiling(event.Listener):
        """What numba loads from its cache makes no such event."""

        def on_start(self, event: object) -> None:
            announcement.tell()

        def on_end(self, event: object) -> None:
            pass

    event.register("numba:compile", Compiling())
    logger = logging.getLogger("ffcx")
    logger.addHandler(announcement)
    logger.setLevel(logging.INFO)
    logger.setLevel = lambda level: None  # type: ignore[method-assign]  # FFCx sets it again for each form
    logger.propagate = False
    return announcement
