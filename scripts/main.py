"""The command `coilset`: its sub-commands and their options; `running` runs it."""

import os
import sys
from enum import StrEnum
from pathlib import Path

from coilset.model.core.base.errors import InputError
from coilset.model.core.runtime.apart import OURS, SAFE_PATH
from coilset.model.core.runtime.processes import number_of_ranks, stay_on_this_machine, usable_cores
from coilset.scripts.commands.material import app as material
from coilset.scripts.compiling import NOTICE, STAGES, announce_compiling, compile_first
from coilset.scripts.startup import announce_begin, load_for_solve, typer
from coilset.scripts.terminal.target import OVERWRITE, file_targets, folder_target, page_target, sheet_targets

HELP = """How far does a coil spring set, and what stress remains in it?

It needs DOLFINx >= 0.9: without root from conda (environment.yml) or pip (wheels); as root from the packages of
Debian 13 or Ubuntu 25.04, or in a private Debian 13 on older releases (scripts/coilset installs both). See
docs/install.md."""

app = typer.Typer(
    name="coilset",
    help=HELP,
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
app.add_typer(material, name="material")


class Engine(StrEnum):
    """Where the cases of a sweep run."""

    processes = "processes"
    mpi = "mpi"
    dask = "dask"


class Language(StrEnum):
    """Of a data sheet."""

    en = "en"
    de = "de"


SETTINGS = typer.Option([], "--set", metavar="KEY=VALUE", help="override an entry of the case file")
RESULTS = typer.Argument(metavar="RESULTS", help="results folder of a run")
FORCE = typer.Option(False, *OVERWRITE, help="overwrite existing results")
FIGURE, FIGURES = (typer.Option(True, help=f"draw the {word}") for word in ("figure", "figures"))
THREADS = typer.Option(
    None, min=1, envvar="COILSET_THREADS", help="threads [default: as many as cores, on several ranks one for each]"
)


def _show_version(wanted: bool) -> None:
    if wanted:
        from coilset.model.core.base.version import versions

        print(versions())
        raise typer.Exit


@app.callback()
def options(
    context: typer.Context,
    ranks: int = typer.Option(
        1, "-n", min=1, metavar="RANKS", help="run solve, solid, sweep or python on several MPI ranks"
    ),
    version: bool = typer.Option(False, "--version", is_eager=True, callback=_show_version, help="print versions"),
) -> None:
    """Options before the command."""
    source, name = context.get_parameter_source("ranks"), context.invoked_subcommand
    if source is not None and source.name == "COMMANDLINE" and name is not None:
        from coilset.scripts.ranks import check, launch

        command = sys.argv[sys.argv.index(name) :]
        check(ranks, name)
        if ranks > 1 and not {"-h", "--help"} & set(command):
            raise SystemExit(launch(ranks, command))  # the ranks have reported why
    if name != "python":  # whose program may start MPI on other machines
        stay_on_this_machine()


@app.command()
def solve(
    case: str = typer.Argument(help="case file (YAML)"),
    out: str = typer.Option(None, callback=folder_target, help="results folder [default: results/NAME-OF-CASE]"),
    force: bool = FORCE,
    settings: list[str] = SETTINGS,
    pictures: bool = FIGURES,
    resume: bool = typer.Option(False, "--resume", help="continue from the last converged step in the results folder"),
    interactive: bool = typer.Option(
        False, "--interactive", help="pause after each step; Enter continues, ? shows help"
    ),
    quiet: bool = typer.Option(False, "--quiet", help="print the answer alone: checks and numbers"),
    steps: bool = typer.Option(False, "--steps", help="print a table of the steps, a line for each phase and more"),
    json: bool = typer.Option(False, "--json", help="print a line of JSON a step, for scripts"),
    verbose: bool = typer.Option(False, "--verbose", help="print each step and each iteration: norm, step length"),
    method: str = typer.Option(None, help="iteration method: newton, modified-newton, bfgs, broyden, arc-length, ..."),
    threads: int = THREADS,
) -> None:
    """Take a spring through its load program and write the results."""
    from coilset.scripts.terminal.drawing import Drawings

    ways = {"quiet": quiet, "steps": steps, "json": json, "verbose": verbose}
    given = [name for name, wanted in ways.items() if wanted]
    if len(given) > 1:
        raise InputError("are ways to print a run; give one of them", ", ".join(f"--{name}" for name in given))
    if not (quiet or json):
        announce_begin(case, out)
    settings = [*settings, f"solver.method={method}"] if method else settings
    compile_first(lambda: _check_case(case, settings), stages=("rod",))
    with Drawings(os.environ) as drawings:
        if pictures and os.path.isfile(case):
            drawings.start_if_free()
        announce_compiling()
        load_for_solve()
        from coilset.scripts.commands.solve import solve as run_case

        run_case(
            case,
            out,
            force,
            settings,
            drawings=drawings if pictures else None,
            resume=resume,
            interactive=interactive,
            voice=given[0] if given else "lines",
            threads=threads,
        )


def _check_case(case: str, settings: list[str]) -> None:
    from coilset.model.core.case import read_case

    read_case(case, settings)


@app.command(name="slice")
def slice_(
    case: str = typer.Argument(help="case file (YAML) of a cylindrical spring"),
    out: str = typer.Option(None, callback=folder_target, help="results folder [default: results/NAME-OF-CASE-slice]"),
    force: bool = FORCE,
    settings: list[str] = SETTINGS,
    section: str = typer.Option(None, help="oval:4:5, rectangle:4:5:0.5, trapezoid:4:5:6:0.4, FILE.csv"),
    across: float = typer.Option(None, help="number of triangles across the section [default: 5.75]"),
    pictures: bool = FIGURE,
) -> None:
    """Solve a cylindrical spring as a 3D body, through a single section of its wire, and write the results."""
    from coilset.scripts.commands.slice import slice_case

    slice_case(case, out, force, settings, section, across, pictures)


@app.command()
def solid(
    case: str = typer.Argument(help="case file (YAML) of a cylindrical spring of round wire"),
    out: str = typer.Option(None, callback=folder_target, help="results folder [default: results/NAME-OF-CASE-solid]"),
    force: bool = FORCE,
    settings: list[str] = SETTINGS,
    turns: float = typer.Option(1.0, help="turns of the solid, 1 to 5"),
    across: int = typer.Option(None, min=1, max=12, help="elements along a side of the wire's core [default: 2]"),
    layers: int = typer.Option(24, min=4, max=400, help="elements round a turn"),
    pictures: bool = FIGURES,
) -> None:
    """Solve some turns of a cylindrical spring as a 3D solid, and as a rod beside it, and write the results."""
    from coilset.scripts.commands.solid import solid_case

    solid_case(case, out, force, settings, turns, across, layers, pictures)


@app.command()
def nest(
    file: str = typer.Argument(help="nest file (YAML): two case files, and the heights of their common seats"),
    out: str = typer.Option(None, callback=folder_target, help="results folder [default: results/NAME-OF-FILE]"),
    force: bool = FORCE,
    pictures: bool = typer.Option(True, help="draw the characteristic"),
    threads: int = THREADS,
) -> None:
    """Press two nested springs together between the same seats: summed force, set and stress of each, their room."""
    from coilset.scripts.commands.nest import nest as press

    announce_compiling()
    press(file, out, force, pictures, threads)


@app.command()
def mesh(
    case: str = typer.Argument(help="case file (YAML)"),
    out: str = typer.Option(
        None, callback=folder_target, help="folder for the pictures [default: results/NAME-OF-CASE]"
    ),
    force: bool = typer.Option(False, *OVERWRITE, help="overwrite existing files"),
    settings: list[str] = SETTINGS,
    write: list[str] = typer.Option(
        [],
        callback=file_targets,
        metavar="FILE",
        help="write the mesh: .msh, .vtu, .vtk, .inp, .xdmf, ..., or a solid body: .step",
    ),
    height: float = typer.Option(None, help="between the seats, mm [default: unloaded]"),
    pictures: bool = typer.Option(True, help="draw the spring"),
) -> None:
    """Print the data of a spring, draw it, and write its mesh."""
    from coilset.scripts.commands.mesh import mesh as mesh_case

    mesh_case(case, out, force, settings, write, pictures, height)


@app.command()
def sheet(
    case: str = typer.Argument(None, help="case file (YAML)"),
    results: str = typer.Option(None, help="results folder of the case, to compare with the formulas"),
    wire: str = typer.Option(None, help='standard wire, such as "EN 10270-1 SH" [default: the material of the case]'),
    length: list[float] = typer.Option([], help="working length, mm; twice for a load cycle [default: from the case]"),
    grade: int = typer.Option(2, min=1, max=3, help="quality grade of EN 15800"),
    surface: str = typer.Option("as coiled", help='"as coiled" or "shot peened", for the fatigue limits'),
    dynamic: bool = typer.Option(False, "--dynamic", help="cyclic load: larger minimum gaps between the coils"),
    out: list[str] = typer.Option(
        [],
        callback=sheet_targets,
        help="sheet.html, .pdf, .csv, .dxf or .step, or the folder of the Goodman diagram; may be given several times "
        "[default: results/NAME-OF-CASE]",
    ),
    language: Language = typer.Option("en", help="of the files: en or de"),
    height: float = typer.Option(None, help="of the spring in the .step file, mm [default: that of the drawing]"),
    force: bool = typer.Option(False, *OVERWRITE, help="overwrite an existing figure"),
    settings: list[str] = SETTINGS,
    wires: bool = typer.Option(False, "--wires", help="list the standard wires, or all numbers of --wire"),
    pictures: bool = typer.Option(True, help="draw the Goodman diagram"),
) -> None:
    """Print rate, stresses, lengths and tolerances by the standards, beside the results of a run."""
    from coilset.scripts.commands import sheet as sheets

    if wires:
        sheets.list_wires(wire)
    else:
        options = sheets.Options(
            results, wire, length, grade, surface, dynamic, out, language.value, force, settings, pictures, height
        )
        sheets.sheet(case, options)


@app.command()
def report(
    results: str = typer.Argument(metavar="RESULTS", help="results folder of a run, a design, a nest or a sweep"),
) -> None:
    """Write a page of a run, a design, a nest or a sweep; it opens from disk without a network."""
    compile_first(stages=("point",))
    announce_compiling()
    from coilset.scripts.commands.report import report as write_page

    write_page(results)


@app.command()
def fields(results: str = RESULTS) -> None:
    """Write time series of a run for ParaView: centre line, wire as a tube, section points."""
    from coilset.model.core.results.files.opened import open_run
    from coilset.model.tools.figures.series import write_series

    for path in write_series(open_run(results)):
        print(path)


@app.command()
def animate(results: str = RESULTS) -> None:
    """Write an animation of a run: the spring through its load program, coloured by stress."""
    from coilset.model.core.results.files.opened import open_run
    from coilset.model.tools.figures.animation import animate as draw

    path = draw(open_run(results))
    print(f"{path}: {path.stat().st_size / 1e6:.1f} MB")


@app.command()
def modes(
    results: str = RESULTS,
    at: str = typer.Option(
        "end", metavar="STATE", help="end, or from there: block, block-3mm, height=30, travel=5, force=100"
    ),
    count: int = typer.Option(10, min=1, max=1000, help="number of modes"),
    glued: bool = typer.Option(False, "--glued", help="coils that touch cannot slide on each other"),
    pictures: bool = FIGURE,
) -> None:
    """Find natural frequencies and modes of the spring of a run, at its end or under another load, and write them."""
    compile_first(stages=("rod",))
    from coilset.scripts.commands.vibration import modes as find

    find(results, at, count, glued, pictures)


@app.command()
def surge(
    results: str = RESULTS,
    at: str = typer.Option(
        "end", metavar="STATE", help="where it starts: end, or from there height=46, travel=5, force=100, block-3mm"
    ),
    lift: float = typer.Option(None, metavar="MM", help="of a valve"),
    speed: float = typer.Option(None, metavar="1/MIN", help="of the engine, twice that of the camshaft"),
    opening: float = typer.Option(110.0, metavar="DEGREES", help="turn of the camshaft while the valve is open"),
    motion: str = typer.Option(None, metavar="FILE", help="CSV with time_s and travel_mm, in place of a valve's lift"),
    step: float = typer.Option(None, metavar="S", help="of time [default: a 20th of the first axial mode's period]"),
    seconds: float = typer.Option(None, help="duration [default: the lift and five periods of the first axial mode]"),
    pictures: bool = FIGURE,
) -> None:
    """Drive the head of the spring of a run over time, with the mass of its wire, and write forces and energies."""
    compile_first(stages=("rod",))
    from coilset.scripts.commands.vibration import motion as motion_of
    from coilset.scripts.commands.vibration import surge as drive

    drive(results, at, motion_of(lift, speed, opening, motion), step, seconds, pictures)


@app.command()
def sweep(
    sweep_file: str = typer.Argument(metavar="SWEEP", help="sweep file (YAML)"),
    out: str = typer.Option(None, callback=folder_target, help="results folder [default: results/NAME-OF-SWEEP]"),
    force: bool = typer.Option(False, *OVERWRITE, help="discard existing cases"),
    resume: bool = typer.Option(False, "--resume", help="run only the missing cases"),
    retry: bool = typer.Option(False, "--retry", help="like --resume, but also rerun failed cases"),
    collect: bool = typer.Option(False, "--collect", help="run nothing; join the journals of all shards"),
    shard: str = typer.Option(
        None, metavar="K/N", help="run only every N-th case, from the K-th, into a journal of its own"
    ),
    until: str = typer.Option(
        None, metavar="H:MM:SS", help="start no case that would end later than this after the start"
    ),
    budget: str = typer.Option(None, metavar="H:MM:SS", help="start no case once all have taken this time together"),
    engine: Engine = typer.Option(None, help="where cases run [default: processes, under mpirun its ranks]"),
    scheduler: str = typer.Option(None, metavar="ADDRESS", help="of a running Dask cluster, such as tls://host:8786"),
    jobs: int = typer.Option(None, min=1, help="processes on this machine [default: one per core]"),
    ranks_per_case: int = typer.Option(1, min=1, help="under mpirun: number of ranks that share a case"),
    pictures: bool = FIGURES,
) -> None:
    """Solve many variants of a case."""
    from coilset.model.tools.sweep.engines.processes import Workers
    from coilset.model.tools.sweep.shards import Shard, duration

    share = Shard.parse(shard)
    limits = duration(until, "--until"), duration(budget, "--budget")
    _check_engine(engine, scheduler)
    announce_begin(sweep_file, out)
    compile_first(lambda: _check_sweep(sweep_file))
    jobs, own = jobs or usable_cores(), number_of_ranks() == 1 and engine != Engine.dask and not collect
    with Workers(jobs if own else 0, dict(os.environ)) as workers:
        from coilset.scripts.commands.sweep import Options
        from coilset.scripts.commands.sweep import sweep as run_sweep

        kept = force, resume, retry, collect
        options = Options(*kept, share, *limits, scheduler, ranks_per_case, pictures)
        run_sweep(sweep_file, out, workers, options)


def _check_engine(engine: Engine | None, scheduler: str | None) -> None:
    ranks = number_of_ranks()
    if engine == Engine.mpi and ranks == 1:
        raise InputError("mpi needs ranks; start them by scripts/coilset -n 3 sweep ... or mpirun", "--engine")
    if ranks > 1 and engine in (Engine.dask, Engine.processes):
        raise InputError(f"is {engine.value}, but {ranks} ranks are running; leave one of both out", "--engine")
    if scheduler is not None and engine != Engine.dask:
        raise InputError("belongs to --engine dask", "--scheduler")
    if engine == Engine.dask and scheduler is None:
        raise InputError("give that of a running cluster; on one machine, --engine processes", "--scheduler")


def _check_sweep(sweep_file: str) -> None:
    from coilset.model.tools.sweep.plan import Plan

    Plan(sweep_file)


@app.command()
def design(
    file: str = typer.Argument(help="design file (YAML): a case, unknowns in it (find:), and conditions (such_that:)"),
    out: str = typer.Option(None, callback=folder_target, help="results folder; default results/NAME-OF-FILE"),
    force: bool = typer.Option(False, *OVERWRITE, help="replace an existing design"),
    resume: bool = typer.Option(False, "--resume", help="continue an unfinished search"),
    threads: int = THREADS,
) -> None:
    """Find entries of a case, such as pitch and preset height, for which its run meets conditions."""
    from coilset.model.tools.design.file import read_design_file

    compile_first(lambda: read_design_file(file))
    announce_compiling()
    from coilset.scripts.commands.design import design as run_design

    run_design(file, out, force, resume, threads)


@app.command()
def compare(
    folder: str = typer.Argument(help="folder of a measured spring or nest: case.yaml or nest.yaml, and measured.csv"),
    out: str = typer.Option(None, callback=folder_target, help="results folder [default: results/compare/NAME]"),
    force: bool = FORCE,
) -> None:
    """Compare measured numbers of a spring with the run of its case."""
    announce_compiling()
    from coilset.scripts.commands.fitting.compare import compare as beside

    beside(folder, out, force)


@app.command()
def verify(
    names: list[str] = typer.Argument(None, metavar="[NAME]...", help="cases to run; all by default"),
    out: str = typer.Option(
        "results/verify", callback=folder_target, help="folder for records and figures, overwritten"
    ),
    fast: bool = typer.Option(False, "--fast", help="only the cases that take seconds"),
    show: bool = typer.Option(False, "--list", help="list the cases"),
    page: str = typer.Option(
        None, "--page", callback=page_target, help="also write a page of all records, such as docs/verification.md"
    ),
) -> None:
    """Compare with tables, closed-form solutions and finer models; exit 1 on any deviation."""
    from coilset.scripts.commands import verify as verification

    if show:
        verification.show()
    else:
        announce_compiling()
        raise typer.Exit(verification.verify(names, out, fast, page))


@app.command()
def bench(
    out: str = typer.Option("results/bench", callback=folder_target, help="folder for the record, overwritten"),
    full: bool = typer.Option(False, "--full", help="up to 100,000 elements: 3 GiB, some minutes"),
    cold: bool = typer.Option(False, "--cold", help="also time compilation from scratch"),
    springs: bool = typer.Option(False, "--springs", help="run random springs instead; their costs by family"),
    count: int = typer.Option(70, min=1, max=100_000, help="number of random springs"),
    against: str = typer.Option(None, metavar="CHECKOUT", help="also time the commands or springs of another checkout"),
    million: float = typer.Option(
        None, min=1e-4, max=1.0, metavar="FRACTION", help="only a sweep of this part of a million cases, killed thrice"
    ),
) -> None:
    """Measure run time of commands, by stage, by number of elements and on two ranks."""
    compile_first()
    from coilset.scripts.commands import bench as benchmarks

    if springs:
        benchmarks.bench_springs(out, count, against)
    elif million is not None:
        benchmarks.bench_million(out, million)
    else:
        benchmarks.bench(out, full, cold, against)


@app.command(name="compile")
def compile_(
    stages: list[str] = typer.Argument(None, metavar="[STAGE]...", help=f"{', '.join(STAGES)} [default: all]"),
) -> None:
    """Compile forms and kernels now, which takes a minute or two, so that the first run need not wait."""
    if unknown := set(stages or ()).difference(STAGES):
        raise InputError(f"'{min(unknown)}' is no stage; give {', '.join(STAGES)}", "coilset compile")
    announce_compiling(notice=NOTICE)
    from coilset.scripts.precompile import warm

    warm(stages or STAGES, lambda line: print(line, flush=True))


@app.command()
def examples(
    name: str = typer.Argument(None, help="example to copy; without a name, list all"),
    out: str = typer.Option(".", callback=folder_target, help="folder to copy it to"),
    force: bool = typer.Option(False, *OVERWRITE, help="overwrite existing files"),
) -> None:
    """List the examples, or copy one as a starting point."""
    from coilset.model.compose import examples as shipped

    if name is not None:
        for path in shipped.copy(shipped.find(name), Path(out), force):
            print(path)
        return
    names = shipped.names()
    for one in names:
        print(f"{one:{max(map(len, names)) + 2}}{shipped.title(one)}")
    print("\ncopy one with: coilset examples NAME")


@app.command(context_settings={"allow_extra_args": True, "ignore_unknown_options": True})
def test(context: typer.Context) -> None:
    """Run the tests, in serial and under MPI: about ten minutes on two cores. Arguments are passed to pytest."""
    from coilset.scripts.commands.test import test as run_tests

    raise typer.Exit(run_tests(context.args))


@app.command(context_settings={"allow_extra_args": True, "ignore_unknown_options": True})
def python(context: typer.Context) -> None:
    """Run a Python script, or Python itself, in the environment of the commands."""
    if os.environ.get(SAFE_PATH) == OURS:  # a script imports from its own folder
        del os.environ[SAFE_PATH]
    os.execv(sys.executable, [sys.executable, *context.args])
