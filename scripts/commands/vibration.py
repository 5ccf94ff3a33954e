"""`coilset modes` and `coilset surge`: the spring of a run in small vibrations, and with its head driven over time."""

import os
from pathlib import Path

import numpy as np
from mpi4py import MPI
from rich.table import Table

from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.agreement import on_first_rank
from coilset.model.core.base.errors import InputError
from coilset.model.core.base.version import __version__
from coilset.model.core.results.records.labels import plain
from coilset.model.physics.vibration.driven import Driven, driven
from coilset.model.physics.vibration.lift import Lift, read_lift, valve_lift
from coilset.model.physics.vibration.modes import Modes, loaded_modes
from coilset.model.tools.studies.loaded_spring import after_results
from coilset.model.tools.studies.surge_output import draw_surge, summarise, write_surge
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
    from coilset.model.tools.studies.modes_output import draw_modes, write_modes

    write_modes(folder, found, analysis.setup.turns, x, analysis.setup.wire_radius)
    if title:
        draw_modes(folder / "modes.png", found, x, title, f"{analysis.setup.material}; coilset {__version__}")


def _table(found: Modes) -> Table:
    table = Table("mode", "Hz", "along axis", "across", "twist", box=None, padding=(0, 2))
    for number, (frequency, parts) in enumerate(zip(found.frequencies, found.masses / found.total, strict=True), 1):
        shares = (parts[2], 0.5 * (parts[0] + parts[1]), parts[3])
        table.add_row(str(number), f"{frequency:.2f}", *(f"{100.0 * share:.1f} %" for share in shares))
    return table


def motion(lift: float | None, speed: float | None, opening: float, file: str | None) -> Lift:
    """The lift that the options describe.

    Raises:
        InputError: they describe none, or two.
    """
    if file is not None:
        if lift is not None or speed is not None:
            raise InputError("is another motion than that of the file; give one of them", "--lift, --speed")
        return read_lift(file)
    if lift is None or speed is None:
        raise InputError("are needed, or --motion FILE.csv", "--lift, --speed")
    return valve_lift(lift, speed, opening)


def surge(results: str, at: str, lift: Lift, step: float | None, seconds: float | None, pictures: bool) -> None:
    """Drive the spring and write what happens; see `coilset surge --help`.

    Raises:
        InputError, SolveError: nothing is written then.
    """
    console, folder = Console(), Path(results) / "surge"
    analysis = after_results(results, at)
    height, force = analysis.control.height, analysis.control.force
    title = f"{Path(results).name} from {plain(height, 4)} mm, {plain(force, 4)} N: {lift.words}"
    console.say(title)
    found = driven(lambda: after_results(results, at), lift, step, seconds, lambda line: console.say(f"  {line}"))
    write_surge(folder, found, analysis.setup.turns)
    if pictures:
        source = f"{analysis.setup.material}; generalised-α, {1e3 * found.step:.3g} ms; coilset {__version__}"
        draw_surge(folder / "surge.png", found, analysis.setup.turns, title, source)
    _say_driven(console, found)
    console.say(f"  results in {folder}{os.sep}", whole=True)


def _say_driven(console: Console, found: Driven) -> None:
    numbers = summarise(found)
    table = Table("", "most, N", "slowly, N", "least, N", box=None, padding=(0, 2))
    for end in ("driven", "fixed"):
        values = (numbers[f"{end}_force_{name}_N"] for name in ("max", "max_slowly", "min"))
        table.add_row(f"force, {end} end", *(f"{value:.1f}" for value in values))
    console.print(table)
    most = float(np.abs(found.fine.supplied).max())  # of a head that only draws back from a free spring nothing
    share = 100.0 * numbers["lost_in_steps_Nmm"] / most if most else 0.0
    console.say(
        f"error of the forces by the steps of time about {numbers['force_error_N']:.2g} N; these lost {share:.2g} % of "
        f"the energy supplied"
    )
    closed = f"{numbers['contacts_at_rest']} at rest, up to {numbers['contacts_max']}"
    console.say(f"first axial mode {found.axial:.0f} Hz; closed contacts {closed}")
