"""The first line of a command that takes a while, printed before its libraries are loaded."""

import os
from pathlib import Path

from coilset.model.base.version import __version__
from coilset.model.runtime.processes import first_rank
from coilset.scripts.terminal.target import results_folder


def announce_begin(does: str, file: str, out: str | None) -> None:
    """Announce what is done with a file, if it exists; if not, the function that reads it reports the error.

    Raises:
        InputError: if the results folder cannot be made or written to.
    """
    if os.path.isfile(file) and first_rank():
        folder = results_folder(out, Path(file).stem)
        print(f"coilset {__version__} {does} {Path(file).name} into {folder}{os.sep}", flush=True)
