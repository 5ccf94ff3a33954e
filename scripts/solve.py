"""`coilset solve`: read, run, write, draw, and say what was found."""

import logging
import os
import time
from pathlib import Path

from mpi4py import MPI
from rich.console import Console
from rich.table import Table

from coilset.meshes.errors import CoilsetError, InputError, SolveError
from coilset.model.analysis import Analysis
from coilset.model.case import read_case
from coilset.model.results.checkpoint import Checkpoint
from coilset.model.results.folder import prepare, write_history, write_seats, write_summary
from coilset.model.results.summary import summarise
from coilset.model.standards.warnings import spring_warnings
from coilset.scripts.interactive import Prompt
from coilset.scripts.interrupt import Interrupt

STARTED = float(os.environ.get("COILSET_STARTED", time.time()))


def solve(case_file, out, force, settings, pictures, resume=False, interactive=False, comm=MPI.COMM_WORLD):
    """Run one case; see `coilset solve --help`.

    Raises:
        InputError, SolveError: after the results up to there are written.
    """
    console = Console(quiet=comm.rank != 0, highlight=False)
    if interactive and comm.size > 1:
        raise InputError("works on one rank; leave -n out", "--interactive")
    case = read_case(case_file, settings)
    out = Path(out or Path("results") / Path(case_file).stem)
    try:
        analysis = Analysis(case, comm)
    except InputError as error:
        raise InputError(error.problem, error.place, error.file or case_file) from None
    _prepare(out, force or resume, comm)
    checkpoint = _begin(analysis, out, resume)
    _announce(console, analysis, case_file, resume)
    began = time.perf_counter()
    failure = _run(console, analysis, checkpoint, interactive)
    analysed = time.perf_counter() - began
    summary = comm.bcast(summarise(analysis.setup, analysis.result) if comm.rank == 0 else None)
    if comm.rank == 0:
        _write(out, analysis.setup, analysis.result, summary)
        if pictures:
            _draw(out, analysis.setup, analysis.result, summary, console)
    _conclude(console, summary, out, analysed)
    if failure is not None:
        console.print("go on from the last step with --resume")
        raise failure


def _begin(analysis, out, resume):
    """The checkpoint, resumed from or cleared, and the log."""
    checkpoint = Checkpoint(out, analysis.case)
    if resume:
        analysis.resume(checkpoint.load(analysis.comm))
    if analysis.comm.rank == 0:
        if not resume:
            checkpoint.clear()
        _log_to(out / "log.txt", resume)
    return checkpoint


def _announce(console, analysis, case_file, resume):
    about_spring = [warning.text for warning in spring_warnings(analysis.spring)]
    for warning in [*analysis.case.notices(), *about_spring]:
        console.print(f"[yellow]warning:[/] {warning}")
    targets = ", ".join(phase.label for phase in analysis.case.loading)
    elements, ranks = len(analysis.setup.turns) - 1, analysis.comm.size
    console.print(f"{Path(case_file).name}: {elements} elements, to {targets}, {ranks} rank(s)")
    if resume:
        console.print(f"going on after step {analysis.continuation.number}")
    console.print("   step   seat height/mm      force/N   iterations   contacts")


def _run(console, analysis, checkpoint, interactive):
    """Walk through the program; what ended it early is returned, for the results up to there are written first."""
    ask = Prompt(analysis, console.print) if interactive else None

    def report(step):
        console.print(_row(step))
        interrupt.check()
        if ask:
            ask(step)

    try:
        with Interrupt(analysis.comm, console.print) as interrupt:
            analysis.run(report, checkpoint.save)
    except (SolveError, KeyboardInterrupt) as error:
        return error
    return None


def _prepare(out, force, comm):
    problem = None
    if comm.rank == 0:
        try:
            prepare(out, force)
        except InputError as error:
            problem = error
    problem = comm.bcast(problem and (problem.problem, problem.place, str(problem.file)))
    if problem:
        raise InputError(*problem)


def _log_to(path, append):
    """Every decision of the step control goes to a file in the results folder."""
    try:
        handler = logging.FileHandler(path, mode="a" if append else "w", encoding="utf-8")
    except OSError as error:
        raise CoilsetError(f"{path}: cannot be written: {error.strerror}") from None
    handler.setFormatter(logging.Formatter("%(asctime)s %(message)s"))
    logger = logging.getLogger("coilset")
    logger.setLevel(logging.INFO)
    logger.addHandler(handler)


def _row(step):
    cuts = f"   cut {step.cuts} times" if step.cuts else ""
    force = round(step.force_N, 3) + 0.0  # no -0.000
    return f"{step.number:7d}{step.seat_height_mm:17.4f}{force:13.3f}{step.iterations:13d}{step.contacts:11d}{cuts}"


def _write(out, setup, result, summary):
    from coilset.model.results import dataset

    write_history(out, result.steps)
    write_seats(out, result.seats)
    dataset.write_points(out, dataset.point_state(setup, result))
    dataset.write_fields(out, setup, result.snapshots)
    write_summary(out, summary)


def _draw(out, setup, result, summary, console):
    from coilset.model.results import display, figures, scene, seat_figures

    last = result.snapshots[-1]
    figures.characteristic(out / "characteristic.png", setup, result, summary)
    figures.cross_section(out / "cross_section.png", setup, last)
    if result.steps:
        seat_figures.force_centre(out / "force_centre.png", setup, result)
        seat_figures.seat_pressure(out / "seat_pressure.png", setup, result)
    if display.ensure():
        shots = result.snapshots if len(result.snapshots) <= 4 else [result.snapshots[0], *result.snapshots[-3:]]
        scene.springs(out / "springs.png", shots, setup.wire_radius)
    else:
        console.print("[yellow]warning:[/] springs.png is not drawn: there is no display and no Xvfb")


def _conclude(console, summary, out, analysed):
    def number(value, unit, digits=4):
        return "not reached" if value is None else f"{round(value, digits) + 0.0:.{digits}f} {unit}"  # no -0.0

    table = Table(show_header=False, box=None, padding=(0, 2))
    table.add_row("free length before", number(summary["free_length_before_mm"], "mm"))
    table.add_row("free length after", number(summary["free_length_after_mm"], "mm"))
    table.add_row("[bold]set[/]", f"[bold]{number(summary['set_mm'], 'mm')}[/]")
    table.add_row("initial rate", number(summary["rate_N_per_mm"], "N/mm"))
    table.add_row("greatest force", number(summary["force_max_N"], "N", 2))
    table.add_row("block height", number(summary["block_height_mm"], "mm"))
    table.add_row("greatest residual shear stress", number(summary["residual_shear_max_MPa"], "MPa", 2))
    table.add_row("residual shear stress, coil's inside", number(summary["residual_shear_inside_MPa"], "MPa", 2))
    table.add_row("results in", f"{out}{os.sep}")
    console.print(table)
    for warning in summary["warnings"]:
        console.print(f"[yellow]warning:[/] {warning}")
    if summary["buckled"]:
        standard = summary["buckling_travel_EN_13906_1_mm"]
        beside = "never" if standard is None else f"at {standard:.4g} mm"
        where = f"{summary['buckling_travel_mm']:.4g} mm and {summary['buckling_force_N']:.4g} N"
        console.print(f"[yellow]warning:[/] the spring buckled at a travel of {where} (EN 13906-1: {beside}); "
                      "what follows is of the buckled shape")  # fmt: skip
    if summary["unstable_steps"]:
        console.print(f"[yellow]warning:[/] {summary['unstable_steps']} steps are unstable equilibria, no stable one "
                      "was found beside them: several branches exist, smaller steps may find another")  # fmt: skip
    console.print(f"analysis {analysed:.2f} s, all {time.time() - STARTED:.2f} s")
