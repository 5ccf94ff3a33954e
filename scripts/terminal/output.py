"""Standard output whose reader may close it, as in `coilset solve … | head -3`, or may not know all letters."""

import io
import os
import sys
from typing import Any, TextIO


class Output:
    """A text stream that discards output once nobody reads it, instead of raising BrokenPipeError.

    A letter that its encoding lacks, such as the π of a formula in ASCII, becomes a question mark.

    Attributes:
        closed_by_reader: whether that has happened.
    """

    def __init__(self, stream: TextIO):
        self.stream, self.closed_by_reader = stream, False
        if isinstance(stream, io.TextIOWrapper) and stream.errors == "strict":
            stream.reconfigure(errors="replace")

    def write(self, text: str) -> int:
        """Write or discard; returns the number of characters."""
        try:
            return self.stream.write(text)
        except BrokenPipeError:
            self._drop()
            return len(text)

    def flush(self) -> None:
        """Flush or discard."""
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
    """Whether the reader of standard output has closed it."""
    return getattr(sys.stdout, "closed_by_reader", False)
