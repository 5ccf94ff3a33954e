"""`coilset report`: one page of a run, to read and to hand on."""

from pathlib import Path

from rich.console import Console

from coilset.model.report.page import write_report
from coilset.model.results.opened import open_run


def report(folder: str | Path) -> None:
    """Write report.html into a results folder; see `coilset report --help`.

    Raises:
        InputError: if there is no run in the folder. CoilsetError: if the page cannot be written.
    """
    path = write_report(open_run(folder))
    size = path.stat().st_size / 1e6
    Console(highlight=False).print(f"{path}: {size:.1f} MB; open it in a browser")
