"""log.txt of a run: every decision of the step control. While it is open, no other run can use its folder."""

import contextlib
import fcntl
import logging
import os
from collections.abc import Iterator
from io import TextIOWrapper
from pathlib import Path

from coilset.model.core.base.errors import CoilsetError, InputError
from coilset.model.core.results.files.folder import not_linked

# Without one, Python would print warnings of ranks that keep no log.
logging.getLogger("coilset").addHandler(logging.NullHandler())


class _Handler(logging.FileHandler):
    def _open(self) -> TextIOWrapper:
        return TextIOWrapper(open(self.baseFilename, f"{self.mode}b", opener=not_linked), encoding=self.encoding)

    def handleError(self, record: logging.LogRecord) -> None:
        """A full disk is reported where results are written; the log merely loses lines."""

    def close(self) -> None:
        with contextlib.suppress(OSError):
            super().close()


@contextlib.contextmanager
def run_log(folder: Path, goes_on: bool) -> Iterator[None]:
    """Log to the folder's log.txt, at its end if the run `goes_on`, and hold a lock on it, which the kernel releases
    however the run ends.

    Raises:
        InputError: if another run uses the folder.
        CoilsetError: if the log cannot be written.
    """
    path = folder / "log.txt"
    try:
        handler = _Handler(path, mode="a", encoding="utf-8")
    except OSError as error:
        raise CoilsetError(f"{path}: cannot be written: {error.strerror}") from None
    logger = logging.getLogger("coilset")
    try:
        assert handler.stream is not None  # it is opened in advance
        _lock(handler.stream.fileno(), folder)
        if not goes_on:
            handler.stream.truncate(0)
        handler.setFormatter(logging.Formatter("%(asctime)s %(message)s"))
        logger.setLevel(logging.INFO)
        logger.addHandler(handler)
        yield
    finally:
        logger.removeHandler(handler)
        handler.close()


@contextlib.contextmanager
def only_run(folder: Path) -> Iterator[None]:
    """Hold a lock on a folder that has no log.txt.

    Raises:
        InputError: if another run uses the folder.
    """
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        _lock(descriptor, folder)
        yield
    finally:
        os.close(descriptor)


def _lock(descriptor: int, folder: Path) -> None:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise InputError(
            "another run is using this folder; wait for it, or use another --out", "--out", folder
        ) from None
    except OSError:
        pass  # a file system without locks
