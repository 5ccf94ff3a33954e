"""`coilset surge`: a spring whose head is driven over time, with the mass of its wire and the clash of its coils."""

import os
from pathlib import Path

from rich.table import Table

from coilset.model.base.errors import InputError
from coilset.model.base.version import __version__
from coilset.model.results.records.labels import plain
from coilset.model.vibration.driven import Driven, driven
from coilset.model.vibration.lift import Lift, read_lift, valve_lift
from coilset.model.vibration.loaded import after_results
from coilset.model.vibration.surge_output import draw_surge, summarise, write_surge
from coilset.scripts.terminal.console import Console


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
    _conclude(console, found)
    console.say(f"  results in {folder}{os.sep}", whole=True)


def _conclude(console: Console, found: Driven) -> None:
    numbers = summarise(found)
    table = Table("", "most, N", "slowly, N", "least, N", box=None, padding=(0, 2))
    for end in ("driven", "fixed"):
        values = (numbers[f"{end}_force_{name}_N"] for name in ("max", "max_slowly", "min"))
        table.add_row(f"force, {end} end", *(f"{value:.1f}" for value in values))
    console.print(table)
    share = 100.0 * numbers["lost_in_steps_Nmm"] / numbers["supplied_max_Nmm"]
    console.say(
        f"error of the forces by the steps of time about {numbers['force_error_N']:.2g} N; these lost {share:.2g} % of "
        f"the energy supplied"
    )
    closed = f"{numbers['contacts_at_rest']} at rest, up to {numbers['contacts_max']}"
    console.say(f"first axial mode {found.axial:.0f} Hz; closed contacts {closed}")
