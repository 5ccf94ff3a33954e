"""Standard output whose reader may go away, as in `coilset solve … | head -3`."""

import os
import sys
from typing import Any, TextIO


class Output:
    """A text stream that drops what is written once nobody reads it, in place of BrokenPipeError.

    Attributes:
        closed_by_reader: whether that has happened.
    """

    def __init__(self, stream: TextIO):
        self.stream, self.closed_by_reader = stream, False

    def write(self, text: str) -> int:
        """Write, or drop; the number of characters."""
        try:
            return self.stream.write(text)
        except BrokenPipeError:
            self._drop()
            return len(text)

    def flush(self) -> None:
        """Flush, or drop."""
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
    """Whether whoever read standard output has closed it."""
    return getattr(sys.stdout, "closed_by_reader", False)
