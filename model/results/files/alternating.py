"""Two files, written one after the other: one is complete and has the name, the next is written over the other."""

import contextlib
import ctypes
import os
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from coilset.model.base.errors import CoilsetError

AT_FDCWD, RENAME_EXCHANGE = -100, 2  # of Linux's renameat2, which other systems do not have
RENAME = getattr(ctypes.CDLL(None), "renameat2", None)


class TwoFiles:
    """A file that is written again and again, and complete at any moment.

    A new file each time, renamed once it is written, would do as well, but its room in memory and on the disk has to be
    found anew each time. That takes longer than to write 1 MB into room that is there.

    Args:
        path: of the complete file.
    """

    def __init__(self, path: Path) -> None:
        self.path, self.spare = path, path.with_name(f".{path.stem}.spare{path.suffix}")

    @contextlib.contextmanager
    def next(self) -> Iterator[BinaryIO]:
        """The file to be written, which takes the place of `path` when the context ends without an error.

        Raises:
            CoilsetError: if it cannot be written.
        """
        try:
            with open(self.spare, "r+b" if self.spare.exists() else "w+b") as file:
                yield file
                file.truncate()
            if not self.path.exists() or not _exchange(self.spare, self.path):
                os.replace(self.spare, self.path)
        except OSError as error:
            self.over()
            raise CoilsetError(f"{self.path}: cannot be written: {error.strerror or error}") from None

    def over(self) -> None:
        """Give the room of the other file back."""
        with contextlib.suppress(OSError):
            self.spare.unlink()


def _exchange(one: Path, other: Path) -> bool:
    """Let two files change names in one step; False where the system or the file system cannot."""
    return RENAME is not None and not RENAME(AT_FDCWD, os.fsencode(one), AT_FDCWD, os.fsencode(other), RENAME_EXCHANGE)
