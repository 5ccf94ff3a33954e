"""`coilset report`: one page of a run, a design, a nest or a sweep, to read and to pass on."""

import contextlib
import os
from pathlib import Path

from mpi4py import MPI

from coilset.model.core.base.errors import InputError, SolveError, reading
from coilset.model.core.results.files.folder import subfolder
from coilset.model.core.results.files.opened import open_run
from coilset.model.tools.design.opened import read_design
from coilset.model.tools.report import design_page, nest_page, sweep_page
from coilset.model.tools.report.render import NAME
from coilset.model.tools.report.run_page import write_report
from coilset.scripts.commands.solve import solve
from coilset.scripts.terminal.console import Console


def report(folder: str | Path) -> None:
    """Write report.html into a results folder; see `coilset report --help`.

    Raises:
        InputError: if the folder has no results, or a page cannot be put there. CoilsetError: if writing fails.
    """
    folder = Path(folder)
    _check(folder)
    if (folder / design_page.FILE).is_file() and not (folder / sweep_page.FILE).is_file():
        _solve_found(folder)
    with reading(folder):
        path = _write(folder)
    size = path.stat().st_size / 1e6
    Console().say(f"{path}: {size:.1f} MB; open it in a browser")


def _write(folder: Path) -> Path:
    """The page of whatever results there are; its figures meet what is damaged in them."""
    if (folder / sweep_page.FILE).is_file():
        return sweep_page.write_sweep_report(folder)
    if (folder / design_page.FILE).is_file():
        return design_page.write_design_report(folder)
    if (folder / nest_page.FILE).is_file():
        return nest_page.write_nest_report(folder)
    return write_report(open_run(folder))


def _solve_found(folder: Path) -> None:
    """Solve the case that a design has found, for its characteristic and the spring in 3D, unless its results exist."""
    design, _ = read_design(folder)
    with reading(folder / design_page.FILE):
        if design_page.found_run(folder, design) is not None:
            return
    Console().say(f"solving {folder / 'found.yaml'} for its characteristic")
    found = subfolder(folder, design_page.FOUND)
    with contextlib.suppress(SolveError):  # the page shows it
        solve(folder / "found.yaml", found, True, [], comm=MPI.COMM_SELF, voice="silent")


def _check(folder: Path) -> None:
    """Check whether a page can be written to an existing folder."""
    if (folder / NAME).is_dir():
        raise InputError("cannot be written: there is a folder of this name; move it away", "", folder / NAME)
    if folder.is_dir() and not os.access(folder, os.W_OK | os.X_OK):
        raise InputError("cannot be written: its folder is read-only", "", folder / NAME)
