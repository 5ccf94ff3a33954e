"""`coilset modes`: natural frequencies and modes of the spring of a run."""

import os
from pathlib import Path

import numpy as np
from mpi4py import MPI
from rich.table import Table

from coilset.model.base.agreement import on_first_rank
from coilset.model.results.records.labels import plain
from coilset.model.run.analysis import Analysis
from coilset.model.vibration.loaded import after_results
from coilset.model.vibration.modes import Modes, loaded_modes
from coilset.scripts.terminal.console import Console

NOTE = (
    "contacts are as they are at that height: closed ones stay closed and open ones open, so amplitudes are small "
    "(docs/vibration.md)"
)


def modes(results: str, at: str, count: int, glued: bool, pictures: bool) -> None:
    """Find the modes and write them; see `coilset modes --help`.

    Raises:
        InputError, SolveError: nothing is written then.
    """
    analysis = after_results(results, at)
    found = loaded_modes(analysis, count, glued)
    x = analysis.layout.gather(analysis.rod.x)
    if MPI.COMM_WORLD.rank:
        return
    console, folder = Console(), Path(results) / "modes"
    height, force = analysis.control.height, analysis.control.force
    title = f"{Path(results).name} at {plain(height, 4)} mm, {plain(force, 4)} N" + (", coils glued" if glued else "")
    console.say(title)
    console.print(_table(found))
    console.say(NOTE)
    on_first_rank(MPI.COMM_SELF, lambda: _write(folder, found, analysis, x, title if pictures else ""))
    console.say(f"  modes in {folder}{os.sep}", whole=True)
    if (found.eigenvalues < 0.0).any():
        console.warn("the equilibrium is unstable: a negative frequency is a rate of growth over 2π")


def _write(folder: Path, found: Modes, analysis: Analysis, x: np.ndarray, title: str) -> None:
    from coilset.model.vibration.output import draw_modes, write_modes

    write_modes(folder, found, analysis.setup.turns, x, analysis.setup.wire_radius)
    if title:
        from coilset.model.base.version import __version__

        draw_modes(folder / "modes.png", found, x, title, f"{analysis.setup.material}; coilset {__version__}")


def _table(found: Modes) -> Table:
    table = Table("mode", "Hz", "along axis", "across", "twist", box=None, padding=(0, 2))
    for number, (frequency, parts) in enumerate(zip(found.frequencies, found.masses / found.total, strict=True), 1):
        shares = (parts[2], 0.5 * (parts[0] + parts[1]), parts[3])
        table.add_row(str(number), f"{frequency:.2f}", *(f"{100.0 * share:.1f} %" for share in shares))
    return table
