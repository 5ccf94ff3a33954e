"""The command `coilset`: its sub-commands, and how errors leave it."""

import os
import signal
import sys

import typer

from coilset.model.errors import CoilsetError
from coilset.scripts.material import app as material

app = typer.Typer(
    name="coilset",
    help="How far does a coil spring set, and what stress stays in it?",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


app.add_typer(material, name="material")


@app.command()
def solve(
    case: str = typer.Argument(help="case file (YAML)"),
    out: str = typer.Option(None, help="results folder; default results/NAME-OF-CASE"),
    force: bool = typer.Option(False, "--force", help="replace results that are there"),
    settings: list[str] = typer.Option([], "--set", metavar="KEY=VALUE", help="replace any entry of the case file"),
    pictures: bool = typer.Option(True, help="draw the figures"),
    resume: bool = typer.Option(False, "--resume", help="go on from the last converged step in the results folder"),
    interactive: bool = typer.Option(False, "--interactive", help="ask after each step; Enter goes on, ? helps"),
    method: str = typer.Option(None, help="iteration method; newton, modified-newton, bfgs, broyden, arc-length, ..."),
):
    """Run a spring through its load program and write what it found."""
    from coilset.scripts.solve import solve as run_case

    settings = [*settings, f"solver.method={method}"] if method else settings
    run_case(case, out, force, settings, pictures, resume, interactive)


@app.command()
def mesh(
    case: str = typer.Argument(help="case file (YAML)"),
    out: str = typer.Option(None, help="folder of the pictures; default results/NAME-OF-CASE"),
    force: bool = typer.Option(False, "--force", help="replace files that are there"),
    settings: list[str] = typer.Option([], "--set", metavar="KEY=VALUE", help="replace any entry of the case file"),
    write: list[str] = typer.Option([], metavar="FILE", help="write the mesh: .msh, .vtu, .vtk, .inp, .xdmf, ..."),
    pictures: bool = typer.Option(True, help="draw the spring"),
):
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
    out: str = typer.Option(None, help="folder of the Goodman diagram; default results/NAME-OF-CASE"),
    force: bool = typer.Option(False, "--force", help="replace a figure that is there"),
    settings: list[str] = typer.Option([], "--set", metavar="KEY=VALUE", help="replace any entry of the case file"),
    wires: bool = typer.Option(False, "--wires", help="list the wires that are known"),
    pictures: bool = typer.Option(True, help="draw the Goodman diagram"),
):
    """Print rate, stresses, lengths and tolerances of the standards, beside what a run found."""
    from coilset.scripts import sheet as sheets

    if wires:
        sheets.list_wires()
    else:
        sheets.sheet(case, results, wire, length, grade, surface, dynamic, out, force, settings, pictures)


@app.command()
def sweep(
    sweep_file: str = typer.Argument(metavar="SWEEP", help="sweep file (YAML)"),
    out: str = typer.Option(None, help="results folder; default results/NAME-OF-SWEEP"),
    force: bool = typer.Option(False, "--force", help="throw away the cases that are there"),
    resume: bool = typer.Option(False, "--resume", help="run only the cases that are missing"),
    retry: bool = typer.Option(False, "--retry", help="like --resume, and run the cases that failed again"),
    jobs: int = typer.Option(None, min=1, help="processes on this machine; default: one a core"),
    ranks_per_case: int = typer.Option(1, min=1, help="under mpirun: ranks that share a case"),
    pictures: bool = typer.Option(True, help="draw the figures"),
):
    """Run a case many times with some of its entries varied."""
    from coilset.scripts.sweep import sweep as run_sweep

    run_sweep(sweep_file, out, force, resume, retry, jobs, ranks_per_case, pictures)


@app.command()
def verify(
    names: list[str] = typer.Argument(None, metavar="[NAME]...", help="cases; all if none is named"),
    out: str = typer.Option("results/verify", help="folder of the records and figures; what is there is replaced"),
    fast: bool = typer.Option(False, "--fast", help="only cases that take seconds"),
    show: bool = typer.Option(False, "--list", help="list the cases"),
):
    """Compare with tables, closed solutions and finer models; exits 1 if a value is off."""
    from coilset.scripts import verify as verification

    if show:
        verification.show()
    else:
        raise typer.Exit(verification.verify(names, out, fast))


@app.command()
def bench(
    out: str = typer.Option("results/bench", help="folder of the record and the figure; what is there is replaced"),
    full: bool = typer.Option(False, "--full", help="up to 400,000 elements: 10 GiB, a quarter of an hour"),
    cold: bool = typer.Option(False, "--cold", help="also time the compilers, from nothing"),
):
    """Measure time by stage, over elements and ranks, and cases per hour."""
    from coilset.scripts.bench import bench as run_benchmarks

    run_benchmarks(out, full, cold)


@app.command(context_settings={"allow_extra_args": True, "ignore_unknown_options": True})
def test(context: typer.Context):
    """Run the tests, in serial and under MPI; further arguments go to pytest."""
    from coilset.scripts.test import test as run_tests

    raise typer.Exit(run_tests(context.args))


@app.command(context_settings={"allow_extra_args": True, "ignore_unknown_options": True})
def python(context: typer.Context):
    """Run a Python script, or Python itself, in the environment that the commands use."""
    os.execv(sys.executable, [sys.executable, *context.args])


def run():
    """Entry of the command: one line and an exit code for every error that can be foreseen."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    status = 1
    try:
        status = app(prog_name="coilset", standalone_mode=False) or 0
    except CoilsetError as error:
        status = error.exit_code
        _complain(str(error))
    except typer.Exit as error:
        status = error.exit_code
    except (typer.Abort, KeyboardInterrupt):
        status = 128 + signal.SIGINT
        _complain("interrupted")
    except Exception as error:
        from click import ClickException

        if not isinstance(error, ClickException):
            raise
        status = error.exit_code
        _complain(error.format_message())
    sys.stdout.flush()
    sys.exit(status)


def _complain(line):
    if int(os.environ.get("OMPI_COMM_WORLD_RANK", os.environ.get("PMI_RANK", "0"))) == 0:
        print(f"coilset: {line}", file=sys.stderr)
