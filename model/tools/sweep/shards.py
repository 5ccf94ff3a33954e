"""Shares of a sweep, and limits of time, for allocations that run independently of each other.

Case i of the plan belongs to shard i modulo their number, so that no two shards run the same case; each has a journal
of its own. Which process runs a shard is written in a small file beside its journal, made by O_EXCL, since locks are
unreliable on the shared file systems of clusters.
"""

import math
import os
import re
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Self

from coilset.model.core.base.errors import InputError
from coilset.model.core.results.files.folder import not_linked

SILENT_SECONDS = 600.0  # after which a run on another machine that has written nothing is taken for dead


@dataclass(frozen=True)
class Shard:
    """Share `number` of `count`; the whole sweep is 1 of 1."""

    number: int = 1
    count: int = 1

    @classmethod
    def parse(cls, text: str | None) -> Self:
        """From `3/100`; None is the whole sweep.

        Raises:
            InputError: it is not of this form, or its number is not among 1 … count.
        """
        if text is None:
            return cls()
        found = re.fullmatch(r"(\d+)/(\d+)", text)
        if not found or not 1 <= int(found[1]) <= int(found[2]):
            raise InputError(
                f"is '{text}'; give a number and a count, such as 3/100, with the number from 1 to 100", "--shard"
            )
        return cls(int(found[1]), int(found[2]))

    def cases(self, total: int) -> range:
        """Which cases of a plan of so many, counted from 0, belong to it."""
        return range(self.number - 1, total, self.count)

    @property
    def journal(self) -> str:
        """File name of its journal."""
        return "journal.jsonl" if self.count == 1 else f"journal-{self.number}-of-{self.count}.jsonl"

    @contextmanager
    def claimed(self, folder: Path) -> Iterator[None]:
        """Run it here and nowhere else; the claim of a run that was killed is taken over.

        Raises:
            InputError: another process runs it.
        """
        path = (folder / self.journal).with_suffix(".running")
        owner = f"{socket.gethostname()} {os.getpid()}"
        try:
            claim = not_linked(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY)
        except FileExistsError:
            self._refuse_if_alive(path, folder / self.journal)
            claim = not_linked(path, os.O_WRONLY | os.O_TRUNC)
        except OSError as error:
            raise InputError(f"cannot be written: {error.strerror}", "", path) from None
        with os.fdopen(claim, "w", encoding="utf-8") as file:
            file.write(owner)
        try:
            yield
        finally:
            path.unlink(missing_ok=True)

    def _refuse_if_alive(self, claim: Path, journal: Path) -> None:
        host, _, process = claim.read_text(encoding="utf-8").partition(" ")
        if host == socket.gethostname():
            alive = process.isdigit() and Path(f"/proc/{process}").exists()
        else:
            last = max(path.stat().st_mtime for path in (claim, journal) if path.exists())
            alive = time.time() - last < SILENT_SECONDS
        if alive:
            raise InputError(
                f"shard {self.number}/{self.count} is being run by process {process} on {host}; if that has been "
                "killed, remove this file",
                "",
                claim,
            )


WHOLE = Shard()


def duration(text: str | None, option: str) -> float:
    """Seconds from `3:50:00`, hours, minutes and seconds; without a text, infinitely many.

    Raises:
        InputError: it is not of this form.
    """
    if text is None:
        return math.inf
    found = re.fullmatch(r"(\d+):([0-5]\d):([0-5]\d)", text)
    if not found:
        raise InputError(f"is '{text}'; give hours, minutes and seconds, such as 3:50:00", option)
    return 3600.0 * int(found[1]) + 60.0 * int(found[2]) + int(found[3])
