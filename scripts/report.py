"""`coilset report`: one page of a run, a design, a nest or a sweep, to read and to pass on."""

import os
from pathlib import Path

from coilset.meshes.errors import InputError
from coilset.model.report import design_page, nest_page, sweep_page
from coilset.model.report.page import write_report
from coilset.model.report.render import NAME
from coilset.model.results.opened import open_run
from coilset.scripts.console import Console


def report(folder: str | Path) -> None:
    """Write report.html into a results folder; see `coilset report --help`.

    Raises:
        InputError: if the folder has no results, or a page cannot be put there. CoilsetError: if writing fails.
    """
    folder = Path(folder)
    _check(folder)
    if (folder / sweep_page.FILE).is_file():
        path = sweep_page.write_sweep_report(folder)
    elif (folder / design_page.FILE).is_file():
        path = design_page.write_design_report(folder)
    elif (folder / nest_page.FILE).is_file():
        path = nest_page.write_nest_report(folder)
    else:
        path = write_report(open_run(folder))
    size = path.stat().st_size / 1e6
    Console().say(f"{path}: {size:.1f} MB; open it in a browser")


def _check(folder: Path) -> None:
    """Check whether a page can be written to an existing folder."""
    if (folder / NAME).is_dir():
        raise InputError("cannot be written: there is a folder of this name; move it away", "", folder / NAME)
    if folder.is_dir() and not os.access(folder, os.W_OK | os.X_OK):
        raise InputError("cannot be written: its folder is read-only", "", folder / NAME)
