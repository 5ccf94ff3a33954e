"""The command `coilset`: its sub-commands, and how errors leave it."""

import errno
import os
import re
import signal
import sys
import time
from difflib import get_close_matches
from types import FrameType
from typing import TYPE_CHECKING, Any

from coilset.meshes.errors import CoilsetError, printable
from coilset.model.processes import first_rank
from coilset.scripts.beginning import announce_begin
from coilset.scripts.compiling import announce_compiling, announce_if_cold
from coilset.scripts.material import app as material
from coilset.scripts.output import Output, output_closed
from coilset.scripts.plain import typer
from coilset.scripts.target import file_targets, folder_target

if TYPE_CHECKING:  # commands load what they need
    from mpi4py import MPI

HELP = """How far does a coil spring set, and what stress stays in it?

It needs DOLFINx >= 0.9: without root from conda (environment.yml) or pip (wheels), as root from the packages of
Debian 13 or Ubuntu 25.04, or in a private Debian 13 on older ones (scripts/coilset does both). See docs/install.md."""
NO_ROOM = (errno.ENOSPC, errno.EFBIG, errno.EDQUOT, errno.EROFS)
TOGETHER = 10.0  # seconds in which all ranks meet an error that is all ranks' error
LONGEST_MESSAGE = 400  # letters that are said of a wrong command line
INTERRUPTED = 128 + signal.SIGINT
ONE_SIGNAL = 0.5  # seconds in which several count as one: `timeout` sends to a process and to its group

SOON = 0.02  # seconds after which an interrupt that came during an import is tried again

app = typer.Typer(
    name="coilset",
    help=HELP,
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
app.add_typer(material, name="material")


def _show_version(wanted: bool) -> None:
    if wanted:
        from coilset.model.version import versions

        print(versions())
        raise typer.Exit


@app.callback()
def options(
    context: typer.Context,
    ranks: int = typer.Option(1, "-n", min=1, metavar="RANKS", help="run solve, sweep or python on several MPI ranks"),
    version: bool = typer.Option(False, "--version", is_eager=True, callback=_show_version, help="print versions"),
) -> None:
    """Options before the command."""
    source, name = context.get_parameter_source("ranks"), context.invoked_subcommand
    if source is not None and source.name == "COMMANDLINE" and name is not None:
        from coilset.scripts.ranks import check, launch

        command = sys.argv[sys.argv.index(name) :]
        check(ranks, name)
        if ranks > 1 and not {"-h", "--help"} & set(command):
            raise SystemExit(launch(ranks, command))  # the ranks have said why


@app.command()
def solve(
    case: str = typer.Argument(help="case file (YAML)"),
    out: str = typer.Option(None, callback=folder_target, help="results folder; default results/NAME-OF-CASE"),
    force: bool = typer.Option(False, "--force", help="replace results that are there"),
    settings: list[str] = typer.Option([], "--set", metavar="KEY=VALUE", help="replace any entry of the case file"),
    pictures: bool = typer.Option(True, help="draw the figures"),
    resume: bool = typer.Option(False, "--resume", help="go on from the last converged step in the results folder"),
    interactive: bool = typer.Option(False, "--interactive", help="ask after each step; Enter goes on, ? helps"),
    method: str = typer.Option(None, help="iteration method; newton, modified-newton, bfgs, broyden, arc-length, ..."),
) -> None:
    """Run a spring through its load program and write what it found."""
    from coilset.scripts.drawing import Drawings

    announce_begin("solves", case, out)
    with Drawings(os.environ) as drawings:
        if pictures:
            drawings.start_if_free()
        announce_compiling()
        from coilset.scripts.solve import solve as run_case

        settings = [*settings, f"solver.method={method}"] if method else settings
        run_case(case, out, force, settings, pictures, resume, interactive, drawings=drawings)


@app.command(name="slice")
def slice_(
    case: str = typer.Argument(help="case file (YAML) of a cylindrical spring"),
    out: str = typer.Option(None, callback=folder_target, help="results folder; default results/NAME-OF-CASE-slice"),
    force: bool = typer.Option(False, "--force", help="replace results that are there"),
    settings: list[str] = typer.Option([], "--set", metavar="KEY=VALUE", help="replace any entry of the case file"),
    section: str = typer.Option(None, help="oval:4:5, rectangle:4:5:0.5, trapezoid:4:5:6:0.4, FILE.csv"),
    across: float = typer.Option(None, help="triangles across the section; default 5.75"),
    pictures: bool = typer.Option(True, help="draw the figure"),
) -> None:
    """Press and release a cylindrical spring as a 3D body, by one section of its wire, and write what it found."""
    from coilset.scripts.slice import slice_case

    slice_case(case, out, force, settings, section, across, pictures)


@app.command()
def mesh(
    case: str = typer.Argument(help="case file (YAML)"),
    out: str = typer.Option(None, callback=folder_target, help="folder of the pictures; default results/NAME-OF-CASE"),
    force: bool = typer.Option(False, "--force", help="replace files that are there"),
    settings: list[str] = typer.Option([], "--set", metavar="KEY=VALUE", help="replace any entry of the case file"),
    write: list[str] = typer.Option(
        [], callback=file_targets, metavar="FILE", help="write the mesh: .msh, .vtu, .vtk, .inp, .xdmf, ..."
    ),
    pictures: bool = typer.Option(True, help="draw the spring"),
) -> None:
    """Print the data of a spring, draw it, and write its mesh."""
    from coilset.scripts.mesh import mesh as mesh_case

    mesh_case(case, out, force, settings, write, pictures)


@app.command()
def sheet(
    case: str = typer.Argument(None, help="case file (YAML)"),
    results: str = typer.Option(None, help="results folder of the case, to show what was found beside the formulas"),
    wire: str = typer.Option(None, help='wire of a standard, such as "EN 10270-1 SH"; default: the case\'s material'),
    length: list[float] = typer.Option([], help="working length, mm; give it twice for a cycle; default: the case's"),
    grade: int = typer.Option(2, min=1, max=3, help="of EN 15800"),
    surface: str = typer.Option("as coiled", help='"as coiled" or "shot peened", for the endurance'),
    dynamic: bool = typer.Option(False, "--dynamic", help="the load alternates: larger gaps between the coils"),
    out: str = typer.Option(
        None, callback=folder_target, help="folder of the Goodman diagram; default results/NAME-OF-CASE"
    ),
    force: bool = typer.Option(False, "--force", help="replace a figure that is there"),
    settings: list[str] = typer.Option([], "--set", metavar="KEY=VALUE", help="replace any entry of the case file"),
    wires: bool = typer.Option(False, "--wires", help="list the wires that are known"),
    pictures: bool = typer.Option(True, help="draw the Goodman diagram"),
) -> None:
    """Print rate, stresses, lengths and tolerances of the standards, beside what a run found."""
    from coilset.scripts import sheet as sheets

    if wires:
        sheets.list_wires()
    else:
        sheets.sheet(case, results, wire, length, grade, surface, dynamic, out, force, settings, pictures)


@app.command()
def sweep(
    sweep_file: str = typer.Argument(metavar="SWEEP", help="sweep file (YAML)"),
    out: str = typer.Option(None, callback=folder_target, help="results folder; default results/NAME-OF-SWEEP"),
    force: bool = typer.Option(False, "--force", help="throw away the cases that are there"),
    resume: bool = typer.Option(False, "--resume", help="run only the cases that are missing"),
    retry: bool = typer.Option(False, "--retry", help="like --resume, and run the cases that failed again"),
    jobs: int = typer.Option(None, min=1, help="processes on this machine; default: one a core"),
    ranks_per_case: int = typer.Option(1, min=1, help="under mpirun: ranks that share a case"),
    pictures: bool = typer.Option(True, help="draw the figures"),
) -> None:
    """Run a case many times with some of its entries varied."""
    announce_begin("sweeps", sweep_file, out)
    announce_if_cold()
    from coilset.scripts.sweep import sweep as run_sweep

    run_sweep(sweep_file, out, force, resume, retry, jobs, ranks_per_case, pictures)


@app.command()
def design(
    wish: str = typer.Argument(help="wish (YAML): a case, what to find: in it, and such_that: conditions"),
    out: str = typer.Option(None, callback=folder_target, help="results folder; default results/NAME-OF-WISH"),
    force: bool = typer.Option(False, "--force", help="replace a design that is there"),
    resume: bool = typer.Option(False, "--resume", help="go on with a search that was not finished"),
) -> None:
    """Find entries of a case, such as pitch and preset height, for which its run meets conditions."""
    announce_compiling()
    from coilset.scripts.design import design as run_design

    run_design(wish, out, force, resume)


@app.command()
def verify(
    names: list[str] = typer.Argument(None, metavar="[NAME]...", help="cases; all if none is named"),
    out: str = typer.Option(
        "results/verify", callback=folder_target, help="folder of the records and figures; what is there is replaced"
    ),
    fast: bool = typer.Option(False, "--fast", help="only cases that take seconds"),
    show: bool = typer.Option(False, "--list", help="list the cases"),
    page: str = typer.Option(None, "--page", help="also write the page of all records here, as docs/verification.md"),
) -> None:
    """Compare with tables, closed solutions and finer models; exits 1 if a value is off."""
    from coilset.scripts import verify as verification

    if show:
        verification.show()
    else:
        announce_compiling()
        raise typer.Exit(verification.verify(names, out, fast, page))


@app.command()
def bench(
    out: str = typer.Option(
        "results/bench", callback=folder_target, help="folder of the record and the figure; what is there is replaced"
    ),
    full: bool = typer.Option(False, "--full", help="up to 400,000 elements: 10 GiB, a quarter of an hour"),
    cold: bool = typer.Option(False, "--cold", help="also time the compilers, from nothing"),
) -> None:
    """Measure time by stage, over elements and ranks, and cases per hour."""
    announce_if_cold()
    from coilset.scripts.bench import bench as run_benchmarks

    run_benchmarks(out, full, cold)


@app.command()
def examples(
    name: str = typer.Argument(None, help="example to copy; all are listed if none is named"),
    out: str = typer.Option(".", callback=folder_target, help="folder to copy it to"),
    force: bool = typer.Option(False, "--force", help="replace files that are there"),
) -> None:
    """List the examples, or copy one to start from."""
    from coilset.scripts import examples as shipped

    if name is None:
        shipped.show()
    else:
        shipped.copy(name, out, force)


@app.command(context_settings={"allow_extra_args": True, "ignore_unknown_options": True})
def test(context: typer.Context) -> None:
    """Run the tests, in serial and under MPI: some ten minutes on two cores; arguments go to pytest as they are."""
    from coilset.scripts.test import test as run_tests

    raise typer.Exit(run_tests(context.args))


@app.command(context_settings={"allow_extra_args": True, "ignore_unknown_options": True})
def python(context: typer.Context) -> None:
    """Run a Python script, or Python itself, in the environment that the commands use."""
    os.execv(sys.executable, [sys.executable, *context.args])


def command_line_message(error: Any) -> str:
    """What click says of a command line, with the user's words in it, in one line that is not too long."""
    said = printable(error.format_message())
    said += _hint(said)
    return said if len(said) <= LONGEST_MESSAGE else f"{said[: LONGEST_MESSAGE - 3]}..."


def _hint(said: str) -> str:
    """What may have been meant."""
    if said.startswith("No such option: -n"):
        return "; -n goes before the command, as in coilset -n 2 solve"
    if unknown := re.fullmatch(r"No such command '(.*)'\.", said):
        names = [str(command.name or getattr(command.callback, "__name__", "")) for command in app.registered_commands]
        near = get_close_matches(unknown[1], [*names, "material"], 1)
        return f" Is {near[0]} meant?" if near else " coilset --help lists the commands."
    return ""


def run() -> None:
    """Entry of the command: one line and an exit code for every error that can be foreseen."""
    sys.stdout = Output(sys.stdout)
    # PETSc would take a closed pipe, which Output answers, for a crash.
    os.environ["PETSC_OPTIONS"] = f"{os.environ.get('PETSC_OPTIONS', '')} -no_signal_handler"
    _listen()
    status = 1
    try:
        status = app(prog_name="coilset", standalone_mode=False) or 0
    except CoilsetError as error:
        status = error.exit_code
        _leave_together(error)
        _complain(str(error))
    except OSError as error:
        if error.errno not in NO_ROOM:
            _crash()
            raise
        status = 1
        _complain(f"{error.filename or 'a file'}: cannot be written: {error.strerror}")
    except typer.Exit as error:
        status = error.exit_code
    except (typer.Abort, KeyboardInterrupt):
        status = INTERRUPTED
    except Exception as error:
        if not hasattr(error, "format_message"):  # of click, which newer typers bring along under a name of their own
            _crash()
            raise
        status = getattr(error, "exit_code", 1)
        _complain(command_line_message(error))
    if status == INTERRUPTED and output_closed():
        status = 128 + signal.SIGPIPE  # as every program whose reader has gone
    elif status == INTERRUPTED:  # typer may have made an exit code of the exception
        _complain("interrupted")
    sys.stdout.flush()
    sys.exit(status)


def _listen() -> None:
    """Ctrl-C raises KeyboardInterrupt; on ranks started by `-n` it comes as SIGUSR1, and they end with mpirun."""
    last = -ONE_SIGNAL

    def interrupt(number: int, frame: FrameType | None) -> None:
        nonlocal last
        if _imports(frame):  # where libraries make an error of their own, or a crash, of an exception out of nowhere
            signal.setitimer(signal.ITIMER_REAL, SOON)
            return
        before, last = last, time.monotonic()
        if last - before > ONE_SIGNAL:
            raise KeyboardInterrupt

    signal.signal(signal.SIGALRM, interrupt)
    if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:
        signal.signal(signal.SIGINT, interrupt)
    if "COILSET_RANKS" in os.environ:
        from coilset.model.processes import end_with_parent

        end_with_parent()
        signal.signal(signal.SIGUSR1, interrupt)


def _imports(frame: FrameType | None) -> bool:
    """Is a module being imported there?"""
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            return True
        frame = frame.f_back
    return False


def _crash() -> None:
    """What nobody foresaw, on one of several ranks: the others would wait for it without end."""
    if world := _several_ranks():
        import traceback

        traceback.print_exc()
        world.Abort(1)


def _leave_together(error: CoilsetError) -> None:
    """An error that all ranks have met is said by the first; one that came to some of them only ends them all."""
    if (world := _several_ranks()) is None:
        return
    arrived, until = world.Ibarrier(), time.monotonic() + TOGETHER
    while not arrived.Test():
        if time.monotonic() > until:
            print(f"coilset: {error}", file=sys.stderr, flush=True)
            world.Abort(error.exit_code)
        time.sleep(0.01)


def _several_ranks() -> "MPI.Comm | None":
    """The communicator of all ranks, if MPI runs on several."""
    if "mpi4py.MPI" not in sys.modules:
        return None
    from mpi4py import MPI

    alive = MPI.Is_initialized() and not MPI.Is_finalized()
    return MPI.COMM_WORLD if alive and MPI.COMM_WORLD.size > 1 else None


def _complain(line: str) -> None:
    if first_rank():
        print(f"coilset: {printable(line)}", file=sys.stderr)
