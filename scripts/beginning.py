"""The first line of a command that takes a while, printed before its libraries are loaded."""

import os
from pathlib import Path

from coilset.model.base.version import __version__
from coilset.model.runtime.processes import first_rank
from coilset.scripts.terminal.target import results_folder


def announce_begin(file: str, out: str | None) -> None:
    """Announce the file that is read, if it exists; if not, the function that reads it reports the error.

    Raises:
        InputError: if the results folder cannot be made or written to.
    """
    if os.path.isfile(file) and first_rank():
        results_folder(out, Path(file).stem)
        print(f"coilset {__version__} reads {Path(file).name}", flush=True)
