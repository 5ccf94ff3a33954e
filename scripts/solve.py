"""`coilset solve`: read, run, write, draw, and say what was found."""

import contextlib
import logging
import os
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from mpi4py import MPI
from rich.console import Console
from rich.table import Table

from coilset.meshes.errors import CoilsetError, InputError, SolveError
from coilset.model.agreement import on_first_rank
from coilset.model.analysis import Analysis
from coilset.model.case import Case, read_case
from coilset.model.results.checkpoint import Checkpoint
from coilset.model.results.folder import clear, prepare, write_history, write_seats, write_summary
from coilset.model.results.pictures import Run
from coilset.model.results.provenance import origin
from coilset.model.results.record import Result, Setup, Step
from coilset.model.results.summary import summarise
from coilset.scripts.drawing import Drawings
from coilset.scripts.interactive import Prompt
from coilset.scripts.interrupt import Interrupt
from coilset.scripts.log import run_log
from coilset.scripts.target import results_folder

log = logging.getLogger("coilset.steps")
STARTED = float(os.environ.get("COILSET_STARTED", time.time()))


def solve(
    case_file: str | Path,
    out: str | Path | None,
    force: bool,
    settings: Sequence[str],
    pictures: bool,
    resume: bool = False,
    interactive: bool = False,
    comm: MPI.Comm = MPI.COMM_WORLD,
    drawings: Drawings | None = None,
) -> None:
    """Run one case; see `coilset solve --help`, and Drawings for who draws the pictures.

    Raises:
        InputError, SolveError: after the results up to there are written.
    """
    console = Console(quiet=comm.rank != 0, highlight=False)
    if interactive and comm.size > 1:
        raise InputError("works on one rank only; omit -n", "--interactive")
    case = read_case(case_file, settings)
    folder = results_folder(out, Path(case_file).stem)
    with contextlib.ExitStack() as stack:
        interrupt = stack.enter_context(Interrupt(comm, console.print))
        try:
            analysis = Analysis(case, comm)
        except InputError as error:
            raise InputError(error.problem, error.place, error.file or case_file) from None
        on_first_rank(comm, lambda: _prepare(folder, analysis.case, force, resume))
        on_first_rank(comm, lambda: _begin(stack.enter_context(run_log(folder)), folder, resume))
        drawings = (drawings or stack.enter_context(Drawings(os.environ))) if pictures else None
        _solve(console, analysis, case_file, folder, drawings, resume, interactive, interrupt)


def _prepare(folder: Path, case: Case, force: bool, resume: bool) -> None:
    if resume:
        if force:
            raise InputError("goes on with a run, and --force throws it away; give one of the two", "--resume")
        Checkpoint(folder, case).require()
    prepare(folder, force or resume)


def _begin(log: logging.FileHandler, out: Path, resume: bool) -> None:
    """Nothing of an earlier run is left in the folder that is now ours, but what is to be gone on from."""
    if not resume:
        assert log.stream is not None  # it is open from the start
        log.stream.truncate(0)
        clear(out)


def _solve(
    console: Console,
    analysis: Analysis,
    case_file: str | Path,
    out: Path,
    drawings: Drawings | None,
    resume: bool,
    interactive: bool,
    interrupt: Interrupt,
) -> None:
    comm, checkpoint = analysis.comm, Checkpoint(out, analysis.case)
    if resume:
        analysis.resume(checkpoint.load(comm))
    _announce(console, analysis, case_file, resume)
    began = time.perf_counter()
    failure = _run(console, analysis, checkpoint, interactive, interrupt)
    interrupt.over()
    analysed = time.perf_counter() - began
    summary = comm.bcast(summarise(analysis.setup, analysis.result) if comm.rank == 0 else None)
    on_first_rank(comm, lambda: _write(out, analysis.setup, analysis.result, summary, origin(analysis.case)))
    _conclude(console, summary, out)
    if drawings:
        run = Run(analysis.setup, analysis.result, summary)
        try:
            on_first_rank(comm, lambda: _draw(drawings, out, run, console))
        except CoilsetError as error:
            if failure is None:
                raise
            console.print(f"[yellow]warning:[/] {error}")
    console.print(f"analysis {analysed:.2f} s, all {time.time() - STARTED:.2f} s")
    if failure is not None:
        if analysis.result.steps:
            console.print("continue from the last step with --resume")
        raise failure


def _announce(console: Console, analysis: Analysis, case_file: str | Path, resume: bool) -> None:
    for warning in analysis.setup.warnings:
        console.print(f"[yellow]warning:[/] {warning.message}")
    targets = ", ".join(phase.label for phase in analysis.case.loading)
    elements, ranks = len(analysis.setup.turns) - 1, analysis.comm.size
    console.print(f"{Path(case_file).name}: {elements} elements, to {targets}, {ranks} rank(s)")
    if resume:
        console.print(f"going on after step {analysis.continuation.number}")
    console.print("   step   seat height/mm      force/N   iterations   contacts")


def _run(
    console: Console, analysis: Analysis, checkpoint: Checkpoint, interactive: bool, interrupt: Interrupt
) -> SolveError | KeyboardInterrupt | None:
    """Go through the program; what ended it early is returned, for the results up to there are written first."""
    ask = Prompt(analysis, console.print) if interactive else None

    def report(step: Step) -> None:
        console.print(_row(step))
        interrupt.check()
        if ask:
            ask(step)

    try:
        analysis.run(report, checkpoint.save, interrupt.check)
    except (SolveError, KeyboardInterrupt) as error:
        return error
    return None


def _row(step: Step) -> str:
    cuts = f"   cut {step.cuts} times" if step.cuts else ""
    cuts += "   snapped" if step.left_branch else ""
    force = round(step.force_N, 3) + 0.0  # no -0.000
    return f"{step.number:7d}{step.seat_height_mm:17.4f}{force:13.3f}{step.iterations:13d}{step.contacts:11d}{cuts}"


def _write(out: Path, setup: Setup, result: Result, summary: dict[str, Any], made_with: dict[str, Any]) -> None:
    from coilset.model.results import dataset

    write_history(out, result.steps)
    write_seats(out, result.seats)
    points = dataset.point_state(setup, result)
    dataset.write_points(out, dataset.with_origin(points, setup, result, made_with))
    dataset.write_fields(out, setup, result.snapshots)
    write_summary(out, {**summary, "origin": made_with})


def _draw(drawings: Drawings, out: Path, run: Run, console: Console) -> None:
    for warning in drawings.draw(out, run):
        console.print(f"[yellow]warning:[/] {warning}")


def _conclude(console: Console, summary: dict[str, Any], out: Path) -> None:
    def number(value: float | None, unit: str, digits: int = 4) -> str:
        return "not reached" if value is None else f"{round(value, digits) + 0.0:.{digits}f} {unit}"  # no -0.0

    table = Table(show_header=False, box=None, padding=(0, 2))
    table.add_row("free length before", number(summary["free_length_before_mm"], "mm"))
    table.add_row("free length after", number(summary["free_length_after_mm"], "mm"))
    table.add_row("[bold]set[/]", f"[bold]{number(summary['set_mm'], 'mm')}[/]")
    table.add_row("initial rate", number(summary["rate_N_per_mm"], "N/mm"))
    table.add_row("rate between 30 and 70 % of the travel", number(summary["rate_30_70_N_per_mm"], "N/mm"))
    for rate in summary["rates"]:
        table.add_row(f"rate at {rate['travel_mm']:g} mm", number(rate["rate_N_per_mm"], "N/mm"))
    table.add_row("maximum force", number(summary["force_max_N"], "N", 2))
    if summary["load_loss_percent"] is not None:
        table.add_row("load lost in time", number(summary["load_loss_percent"], "%", 2))
    table.add_row("block height", number(summary["block_height_mm"], "mm"))
    table.add_row("maximum residual shear stress", number(summary["residual_shear_max_MPa"], "MPa", 2))
    table.add_row("residual shear stress, coil's inside", number(summary["residual_shear_inside_MPa"], "MPa", 2))
    table.add_row("results in", f"{out}{os.sep}")
    console.print(table)
    for warning in summary["warnings"]:
        console.print(f"[yellow]warning:[/] {warning['message']}")
        log.warning("warning: %s: %s", warning["name"], warning["message"])
