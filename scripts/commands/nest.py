"""`coilset nest`: two coaxial springs between the same seats."""

import os
from pathlib import Path
from typing import Any

from mpi4py import MPI
from rich.table import Table

from coilset.model.core.results.files.folder import refuse_results
from coilset.model.core.results.quantities import greatest_force, quantity
from coilset.model.core.results.records.labels import plain
from coilset.model.core.results.records.record import Step
from coilset.model.core.runtime.threads import usual
from coilset.model.tools.checks.nested import nested
from coilset.model.tools.nest import output
from coilset.model.tools.nest.file import read_nest
from coilset.model.tools.nest.nest import Pressed, press
from coilset.model.tools.sheet.from_results import of_steps
from coilset.scripts.terminal.checks import check_lines
from coilset.scripts.terminal.console import Console
from coilset.scripts.terminal.progress import Lines, step_words
from coilset.scripts.terminal.target import results_folder

SHOWN = (
    "set_mm",
    "free_length_before_mm",
    "free_length_after_mm",
    "block_height_mm",
    "force_max_N",
    "shear_inside_max_MPa",
    "residual_shear_inside_MPa",
)


def nest(file: str | Path, out: str | Path | None, force: bool, pictures: bool, threads: int | None = None) -> None:
    """Press a nest; see `coilset nest --help`.

    Raises:
        InputError, SolveError: nothing is written then.
    """
    if MPI.COMM_WORLD.rank:
        return  # both springs are run by one process
    lines, wanted = Lines(), read_nest(file)
    folder = results_folder(out, Path(file).stem)
    refuse_results(folder, force)

    def report(name: str, step: Step) -> None:
        lines.progress(f"{name}, {step_words(step)}")

    lines.say(f"{Path(file).name}: the outer spring, then the inner one")
    pressed = press(wanted, report, threads or usual(1))
    found = output.write(folder, pressed, force, pictures)
    lines.progress_ends()
    _conclude(lines.console, pressed, found, folder)


def _conclude(console: Console, pressed: Pressed, found: dict[str, Any], folder: Path) -> None:
    apart = (0, 2, 0, 0)  # its rows fit in 80 columns
    springs = {
        one.name: (one.case, one.spring, of_steps(found[one.name], one.result.steps))
        for one in pressed.members
        if one.result is not None
    }
    check_lines(console, nested(found, springs))
    table = Table("", "nest", *(member.name for member in pressed.members), box=None, padding=apart)
    shown = tuple(greatest_force(found) if name == "force_max_N" else name for name in SHOWN)
    columns = [found, *(found[member.name] or {} for member in pressed.members)]
    for name in shown:
        words = quantity(found, name).words
        # of one spring the force where both close is not stated
        cells = (one for one in columns if one is found or name != "closing_force_N")
        table.add_row(words, *(quantity(one, name).text if name in one else "" for one in cells))
    table.add_row("minimum clearance", f"{plain(found['clearance_min_mm'])} mm", "", "")
    console.print(table)
    for warning in pressed.warnings:
        console.warn(warning.message)
    for member in pressed.members:
        for warning in (found[member.name] or {"warnings": []})["warnings"]:
            console.warn(f"{member.name}: {warning['message']}")
    console.say(f"results in {folder}{os.sep}")
