"""The journals of a sweep: one JSON line for each finished case, written as soon as it ends."""

import fcntl
import json
import os
import time
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from coilset.model.core.base.errors import CoilsetError, InputError
from coilset.model.core.results.files.folder import not_linked
from coilset.model.tools.sweep.packed import Strings

SYNC_SECONDS = 1.0


class Journal:
    """Appends records and reads them back; only the last line can be incomplete, and is then ignored.

    Args:
        path: the file, created if necessary.
        locked: refuse a second writer by a lock, which file systems of clusters may not have.

    Raises:
        InputError: if it cannot be opened, or another process writes to it.
    """

    def __init__(self, path: str | Path, locked: bool = True) -> None:
        self.path, self._synced = Path(path), time.monotonic()
        try:
            self._file = open(path, "ab", buffering=0, opener=not_linked)  # noqa: SIM115 (held open, and locked, until close)
        except OSError as error:
            raise InputError(f"cannot be written: {error.strerror}", "", path) from None
        try:
            if locked:
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
    return (record for _start, record in _lines(Path(path)))


def _lines(path: Path) -> Iterator[tuple[int, dict[str, Any]]]:
    """Where each record of a journal begins, in bytes, and the record."""
    if not path.exists():
        return
    start, length = 0, whole_length(path)
    with open(path, "rb") as file:
        for number, line in enumerate(file, 1):
            if start + len(line) > length:
                return
            try:
                record = json.loads(line)
                record["key"], record["status"]
            except (ValueError, KeyError, TypeError, RecursionError):
                raise InputError(
                    "is not a record of a case; remove this line, and --resume runs its case again",
                    f"line {number}",
                    path,
                ) from None
            yield start, record
            start += len(line)


class Records:
    """The finished cases of a folder: of several records of a case, in one journal or another, the last that is done.

    Their places are kept, not the records, so that millions of them can be read one after the other.

    Args:
        folder: of the sweep.
        keys: of the tasks that count, in any order; or the array of them.

    Attributes:
        keys: the distinct keys in ascending order, an array of bytes, shape (m,).
        found, done: for each of them, whether there is a record, and one of a case that is done, shape (m,).

    Raises:
        InputError: for a line that is not a record, with its number.
    """

    def __init__(self, folder: str | Path, keys: Iterable[str] | np.ndarray) -> None:
        self.keys = np.unique(Strings(keys).array)
        self.paths = journals(folder)
        self._file = np.full(len(self.keys), -1, np.int32)
        self._start = np.zeros(len(self.keys), np.int64)
        self.done = done = np.zeros(len(self.keys), bool)
        for number, path in enumerate(self.paths):
            for start, record in _lines(path):
                at = self._at(record["key"])
                if at is not None and not (done[at] and record["status"] != "done"):
                    self._file[at], self._start[at] = number, start
                    done[at] = record["status"] == "done"
        self.found = self._file >= 0

    @property
    def counts(self) -> dict[str, int]:
        """Number of the keys that are done, failed and missing."""
        done, found = int(self.done.sum()), int(self.found.sum())
        return {"done": done, "failed": found - done, "missing": len(self.keys) - found}

    def _at(self, key: str) -> int | None:
        at = int(np.searchsorted(self.keys, key.encode()))
        return at if at < len(self.keys) and self.keys[at] == key.encode() else None

    def __iter__(self) -> Iterator[dict[str, Any]]:
        """The records, journal by journal in the order in which they were written."""
        for number, path in enumerate(self.paths):
            starts = np.sort(self._start[self._file == number])
            with open(path, "rb") as file:
                for start in starts:
                    file.seek(start)
                    yield json.loads(file.readline())


def journals(folder: str | Path) -> list[Path]:
    """All journals of a folder: of the whole sweep, of its shards."""
    return sorted(Path(folder).glob("journal*.jsonl"))
