"""`coilset solid`: some turns of a cylindrical spring as a 3D solid, beside the rod."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from mpi4py import MPI

from coilset.meshes.solids.grid import SectionGrid
from coilset.model.core.base.agreement import on_first_rank
from coilset.model.core.base.errors import InputError, SolveError
from coilset.model.core.case import read_case
from coilset.model.core.results.files.folder import clear, prepare, write_history, write_summary
from coilset.model.core.results.records.provenance import origin
from coilset.model.tools.studies import turn_output as output
from coilset.model.tools.studies.turn import GRID, LAYERS, TurnAnalysis, TurnStep
from coilset.scripts.interrupt import Interrupt
from coilset.scripts.terminal.console import Console, table
from coilset.scripts.terminal.progress import duration, with_decimals
from coilset.scripts.terminal.target import results_folder

NOTE = "both are turns between heads that do not rotate, without coils that touch or seats (docs/solid.md)"
COLUMNS = (  # name, entry of the summary, unit, digits
    ("set", "set_mm", "mm", 4),
    ("initial rate", "rate_N_per_mm", "N/mm", 4),
    ("maximum force", "force_max_N", "N", 3),
    ("shear stress, inside of coil, loaded", "shear_inside_max_MPa", "MPa", 2),
    ("residual shear stress, inside of coil", "residual_shear_inside_MPa", "MPa", 2),
    ("loss of force while held", "load_loss_percent", "%", 3),
)


def solid_case(
    case_file: str | Path,
    out: str | Path | None = None,
    force: bool = False,
    settings: Sequence[str] = (),
    turns: float = 1.0,
    across: int | None = None,
    layers: int = LAYERS,
    pictures: bool = True,
) -> None:
    """Run some turns of a case as a solid; see `coilset solid --help`; collective.

    Raises:
        InputError, SolveError, KeyboardInterrupt: the latter two after the results so far are written.
    """
    comm, console = MPI.COMM_WORLD, Console(quiet=MPI.COMM_WORLD.rank > 0)
    case = read_case(case_file, settings)
    folder = results_folder(out, f"{Path(case_file).stem}-solid")
    on_first_rank(comm, lambda: prepare(folder, force))
    try:
        analysis = TurnAnalysis(case, turns, GRID if across is None else SectionGrid(across, across), layers, comm)
    except InputError as error:
        placed = error.file or error.place.startswith("-")
        raise error if placed else InputError(error.problem, error.place, case_file) from None
    cost = analysis.cost()
    console.say(
        f"{Path(case_file).name}: {turns:g} of {analysis.spring.turns:g} turns as a solid, {cost.unknowns:,} unknowns, "
        f"{cost.steps} steps: about {duration(cost.seconds)}"
    )
    console.print(" step travel, mm    force, N  rod's, N  iter.")
    failure: BaseException | None = None
    with Interrupt(comm, console.say) as interrupt:

        def report(step: TurnStep) -> None:
            forces = "".join(f"{force:z11.3f}" for force in (step.force_N, step.rod_force_N))
            console.print(f"{step.number:5d}{step.travel_mm:11.4f} {forces}{step.iterations:6d}")
            interrupt.check()

        try:
            analysis.run(report)
        except (SolveError, KeyboardInterrupt) as error:
            failure = error if isinstance(error, KeyboardInterrupt) or not interrupt.stopped() else KeyboardInterrupt()
    summary = output.summarise(analysis)
    on_first_rank(comm, lambda: _write(folder, analysis, summary, pictures and not interrupt.hurries))
    _conclude(console, summary, folder)
    if failure is not None:
        raise failure


def _write(out: Path, analysis: TurnAnalysis, summary: dict[str, Any], pictures: bool) -> None:
    clear(out)
    write_history(out, analysis.result.steps, TurnStep)
    output.write_fields(out, analysis)
    write_summary(out, {**summary, "origin": origin(analysis.case)})  # before the pictures, which take longest
    if pictures and analysis.result.moments:
        output.write_pictures(out, analysis)


def _conclude(console: Console, summary: dict[str, Any], out: Path) -> None:
    made = table(["", "solid", "rod", "rod − solid"])
    for name, entry, unit, digits in COLUMNS:
        here, there = summary[entry], summary["rod"][entry]
        if here is not None and there is not None:
            share = "" if not here else f"{100.0 * (there / here - 1.0):+.2f} %"
            made.add_row(name, with_decimals(here, unit, digits), with_decimals(there, unit, digits), share)
    console.print(made)
    console.say(NOTE)
    console.say(f"  results in {out}{os.sep}", whole=True)
