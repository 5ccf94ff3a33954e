"""The journal of a sweep: one JSON line for each finished case, written as soon as it ends."""

import fcntl
import json
import os
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from coilset.model.base.errors import CoilsetError, InputError

SYNC_SECONDS = 1.0


class Journal:
    """Appends records and reads them back; only the last line can be incomplete, and is then ignored.

    Args:
        path: the file, created if necessary.

    Raises:
        InputError: if it cannot be opened, or another process writes to it.
    """

    def __init__(self, path: str | Path) -> None:
        self.path, self._synced = Path(path), time.monotonic()
        try:
            self._file = open(path, "ab", buffering=0)  # noqa: SIM115 (held open, and locked, until close)
        except OSError as error:
            raise InputError(f"cannot be written: {error.strerror}", "", path) from None
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            self._file.close()
            raise InputError("another sweep is writing to this folder", "", path) from None
        self._file.truncate(whole_length(self.path))

    def append(self, record: dict[str, Any]) -> None:
        """Write a record; it survives a crash of the process at once, and of the machine after a second.

        Raises:
            CoilsetError: if it cannot be written; then nothing of it remains.
        """
        length, line = os.fstat(self._file.fileno()).st_size, json.dumps(record, allow_nan=False).encode() + b"\n"
        try:
            while line:
                line = line[self._file.write(line) or 0 :]
        except OSError as error:
            self._file.truncate(length)
            raise CoilsetError(f"{self.path}: cannot be written: {error.strerror}") from None
        if time.monotonic() - self._synced > SYNC_SECONDS:
            self._sync()

    def _sync(self) -> None:
        try:
            os.fsync(self._file.fileno())
        except OSError as error:
            raise CoilsetError(f"{self.path}: cannot be written: {error.strerror}") from None
        self._synced = time.monotonic()

    def close(self) -> None:
        """Flush to disk and release the lock."""
        self._sync()
        self._file.close()


def whole_length(path: str | Path) -> int:
    """Length of the file up to the end of its last complete line, in bytes."""
    with open(path, "rb") as file:
        end = file.seek(0, os.SEEK_END)
        while end > 0:
            start = max(end - 65536, 0)
            file.seek(start)
            found = file.read(end - start).rfind(b"\n")
            if found >= 0:
                return start + found + 1
            end = start
    return 0


def read_records(path: str | Path) -> Iterator[dict[str, Any]]:
    """The records of a journal, one after the other; none if there is no file.

    Raises:
        InputError: for a line that is not a record, with its number.
    """
    path = Path(path)
    if not path.exists():
        return
    left = whole_length(path)
    with open(path, "rb") as file:
        for number, line in enumerate(file, 1):
            left -= len(line)
            if left < 0:
                return
            try:
                record = json.loads(line)
                record["key"], record["status"]
            except (ValueError, KeyError, TypeError):
                raise InputError(
                    "is not a record of a case; remove this line, and --resume runs its case again",
                    f"line {number}",
                    path,
                ) from None
            yield record
