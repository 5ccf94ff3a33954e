"""`coilset material`: draw a material's functions, drive one point through a program, fit constants to tests."""

import re
from pathlib import Path
from typing import TYPE_CHECKING

from coilset.model.core.base.errors import InputError, naming
from coilset.scripts.commands.fitting import relaxation, springs
from coilset.scripts.commands.fitting.files import files_to_write, write_material, write_picture
from coilset.scripts.compiling import announce_compiling
from coilset.scripts.startup import typer
from coilset.scripts.terminal.target import OVERWRITE, folder_target

if TYPE_CHECKING:  # commands load what they need
    from rich.table import Table

    from coilset.model.core.material.law.law import Law
    from coilset.model.tools.identification.programs import History, Program

app = typer.Typer(
    cls=springs.MaterialGroup,
    help="Show a material, test it at one point, or fit it to test data.",
    no_args_is_help=True,
)
app.command(springs.NAME)(springs.fit_springs)
MATERIAL = typer.Argument(help="name in the library, or path of a material file")
DATA = typer.Argument(help="tests (CSV): columns eps11, gamma12, sigma11, tau12; of tension strain, stress")
RELAXATION = typer.Argument(
    help="relaxation tests (CSV): columns hours, temperature, loss, stress or shear_stress; or force of a spring, "
    "whose case file (YAML) follows"
)
KNOWN = typer.Option([], metavar="NAME=VALUE", help="offset or compliance of the tester that is given")
UNKNOWN = typer.Option(
    [], metavar="NAME", help="take offset (slack) or compliance of the tester off, by the straight part of each test"
)
POINT_ERROR = 0.5  # % of the load, with which a point is read off a printed diagram
OUT = typer.Option(None, callback=folder_target, help="results folder [default: results/material/NAME]")
FORCE = typer.Option(False, *OVERWRITE, help="overwrite existing files")


@app.command()
def show(material: str = MATERIAL, out: str = OUT, force: bool = FORCE) -> None:
    """Print a material's constants and draw k², ζ and 2Gκ over the plastic work."""
    from coilset.model.core.material import library
    from coilset.model.tools.identification import figures
    from coilset.scripts.terminal.console import Console, styled

    law = library.load(material)
    picture = files_to_write(out, law.name, force, "functions.png")[0]
    console = Console()
    about = f": {law.data.description}\nsource: {law.data.source}\nvalid: {law.data.validity.remark}"
    console.print(styled("bold", law.name, about))
    console.print(_constants(law))
    write_picture(figures.material_functions(law), picture, console)


@app.command("test")
def run_program(
    material: str = MATERIAL,
    program: str = typer.Argument(help="program file (YAML): targets of strain and stress"),
    spin: bool = typer.Option(False, help="include the spin terms of the rod's form (5.2.33)"),
    out: str = OUT,
    force: bool = FORCE,
) -> None:
    """Drive one material point through a program of strain and stress, and draw the result."""
    from coilset.model.core.material import library
    from coilset.model.core.results.files.folder import make
    from coilset.model.tools.identification import figures, programs
    from coilset.scripts.terminal.console import Console

    announce_compiling()
    law, steps = library.load(material, spin=spin), programs.read(program)
    name = Path(program).stem
    table, picture = files_to_write(out, law.name, force, f"{name}.csv", f"{name}.png")
    console = Console()
    with naming(program):
        history = programs.run(law, steps)
    console.print(_ends(steps, history))
    make(table.parent)
    _write_csv(table, history)
    write_picture(figures.program(law, steps, history), picture, console)


@app.command()
def certificate(
    strength: float = typer.Option(..., "--rm", min=0.0, help="tensile strength Rm, MPa"),
    proof_stress: float = typer.Option(..., "--rp02", min=0.0, help="0.2 % proof stress Rp0.2, MPa"),
    elastic_limit: float = typer.Option(None, min=0.0, help="elastic limit, MPa [default: an estimate, 2 Rp0.2 - Rm]"),
    shear_modulus: float = typer.Option(81500.0, "--G", min=0.0, help="shear modulus, MPa"),
    poisson: float = typer.Option(0.26, "--nu", min=-1.0, max=0.5, help="Poisson's ratio"),
    name: str = typer.Option("wire", help="name of the material"),
    source: str = typer.Option("test certificate", help="where the numbers come from"),
    out: str = OUT,
    force: bool = FORCE,
) -> None:
    """Write a material file from what a wire's certificate states, and print what it assumes."""
    import yaml

    from coilset.model.core.results.files.folder import make, whole
    from coilset.model.tools.wires.certificate import Certificate
    from coilset.scripts.terminal.console import Console

    (file,) = files_to_write(out, name, force, f"{name}.yaml")
    stated = Certificate(strength, proof_stress, shear_modulus, poisson, elastic_limit)
    data = stated.material(name, source)
    make(file.parent)
    with whole(file) as path:
        head = f"# Made by coilset material certificate from Rm {strength:g} and Rp0.2 {proof_stress:g} MPa.\n"
        text = yaml.safe_dump(data, sort_keys=False, allow_unicode=True, width=120)
        path.write_text(head + text, encoding="utf-8")
    curve, console = stated.curve(), Console()
    console.print(f"yield begins at {curve.start:.5g} MPa in tension, {curve.start / 3**0.5:.5g} MPa in torsion")
    console.print(f"it saturates at {curve.saturation:.5g} MPa of true stress; a4 = {curve.rate:.4g} mm²/N")
    console.print(f"assumed: {stated.assumptions}", soft_wrap=True)
    console.say(f"material in {file}")


@app.command()
def fit(
    data: list[str] = DATA,
    shear_modulus: float = typer.Option(..., "--G", min=0.0, help="shear modulus, MPa"),
    poisson: float = typer.Option(..., "--nu", min=-1.0, max=0.5, help="Poisson's ratio"),
    temperature: float = typer.Option(293.15, min=0.0, help="temperature of the tests, K"),
    saturation: bool | None = typer.Option(
        None,
        "--saturation/--no-saturation",
        help="fit the second branch of k², which the tests must reach [default: not for tension tests alone]",
    ),
    back_stresses: int | None = typer.Option(
        None, "--back-stresses", help="number of back stresses (Chaboche), 1 to 4, to fit to cyclic tension or torsion"
    ),
    engineering: bool = typer.Option(False, "--engineering", help="tension tests have engineering strain and stress"),
    known: list[str] = KNOWN,
    tester: list[str] = UNKNOWN,
    name: str = typer.Option("fitted", help="name of the material"),
    out: str = OUT,
    force: bool = FORCE,
) -> None:
    """Identify material constants: k² from tension tests, with reversed torsion and tension-torsion also ζ and κ.

    With --spring: from presses of springs, see `fit-springs`. With --back-stresses: a yield stress, its rise, and
    several back stresses from cyclic tests in one direction.
    """
    from rich.table import Table

    from coilset.model.core.material.law.file import UNITS
    from coilset.model.tools.identification import cyclic, experiments, figures
    from coilset.model.tools.identification import fit as fitting
    from coilset.model.tools.identification.elastic_part import corrected
    from coilset.scripts.terminal.console import Console

    announce_compiling()
    file, picture = files_to_write(out, name, force, f"{name}.yaml", "fit.png")
    given = springs.known_values(known)
    tests = [corrected(experiments.read_test(path), shear_modulus, poisson, given, tester) for path in data]
    if engineering:
        tests = [experiments.true_test(test) for test in tests]
    if back_stresses is None:
        result = fitting.fit(tests, shear_modulus, poisson, saturation, temperature)
    else:
        result = cyclic.fit_back_stresses(tests, shear_modulus, poisson, back_stresses, temperature)
    console = Console()
    table = Table("constant", "value", "standard deviation", "± (95 %, all together)", "unit", box=None, padding=(0, 2))
    for key, value in result.constants.items():
        unit = UNITS[re.sub(r"_\d+$", "", key)]  # C_1, C_2, ...
        table.add_row(key, f"{value:.6g}", f"{result.standard[key]:.2g}", f"{result.uncertainty[key]:.2g}", unit)
    console.print(table)
    if isinstance(result, cyclic.CyclicFit) and result.enough < result.terms:
        many = f"{result.enough} back stress{'es' * (result.enough > 1)}"
        console.print(f"{many} would do: the others are within the scatter")
    for test, scatter in zip(result.tests, result.scatter, strict=True):
        console.print(f"{test.name} ({test.kind}): rms residual {scatter:.3g} MPa")
    for sentence in result.tester:
        console.print(sentence, soft_wrap=True)
    for misfit in result.misfits:
        console.warn(misfit)
    if result.doubtful:
        console.warn(f"the tests do not determine {', '.join(result.doubtful)}")
    write_material(file, result.material(name), console)
    write_picture(figures.fit(result, name), picture, console)


@app.command()
def creep(
    material: str = MATERIAL,
    data: list[str] = RELAXATION,
    points: bool = typer.Option(
        False, "--points", help="points of a catalogue: three are enough; 48 h if none are given"
    ),
    time_exponent: float = typer.Option(None, min=0.05, max=1.0, help="p, if all losses are after the same time"),
    loss_error: float = typer.Option(None, min=1e-3, help="error of a loss, % of the load [with --points: 0.5]"),
    form: str = typer.Option("norton_bailey", help="norton_bailey, or garofalo"),
    hardening: str = typer.Option("strain", help="strain, or time"),
    name: str = typer.Option("creeping", help="name of the material"),
    out: str = OUT,
    force: bool = FORCE,
) -> None:
    """Fit the constants of creep to relaxation tests, catalogue points or load losses of springs."""
    from rich.table import Table

    from coilset.model.core.material import library
    from coilset.model.physics.time.creep.forms import FORMS
    from coilset.model.tools.identification.creep_figure import creep_figure
    from coilset.model.tools.identification.creep_fit import UNITS, fit_creep
    from coilset.scripts.terminal.console import Console

    for value, known, option in (
        (form, tuple(FORMS), "--form"),
        (hardening, ("strain", "time"), "--hardening"),
    ):
        if value not in known:
            raise InputError(f"'{value}' is none of {', '.join(known)}", option)
    file, picture = files_to_write(out, name, force, f"{name}.yaml", f"{name}.png")
    error = POINT_ERROR if points and loss_error is None else loss_error
    tests = relaxation.read(data, points)
    result = fit_creep(library.load(material), tests, form, hardening, time_exponent, error)
    console = Console()
    table = Table("constant", "value", "from", "to (95 %)", "unit", "", box=None, padding=(0, 1))
    for key, (low, high) in result.interval.items():
        mark = "not determined" if key in result.undetermined else ""
        table.add_row(key, f"{result.constants[key]:.4g}", f"{low:.4g}", f"{high:.4g}", UNITS[key], mark)
    if time_exponent is not None:
        table.add_row("time_exponent", f"{time_exponent:g}", "given", "", "")
    console.print(table)
    console.print(f"at {result.constants['temperature']:g} K and, of strain, {result.constants['stress']:g} MPa")
    for line in relaxation.words(result, error):
        console.print(line, soft_wrap=True)
    source = "coilset material creep, " + ", ".join(Path(one).name for one in data)
    if time_exponent is not None:
        source += f", with p = {time_exponent:g} given"
    write_material(file, result.material(name, source), console)
    write_picture(creep_figure(result), picture, console)


def _write_csv(path: Path, history: "History") -> None:
    from coilset.model.core.results.files.folder import write_table

    names, values = zip(*history.columns(), strict=True)
    write_table(path, names, zip(*(column.tolist() for column in values), strict=True))


def _constants(law: "Law") -> "Table":
    from coilset.scripts.terminal.console import table

    made = table(["constant", *(f"{temperature:g} K" for temperature in law.temperatures)])
    made.add_column("unit")
    rows = [dict(law.constants(temperature)) for temperature in law.temperatures]
    for name, unit in {name: unit for row in rows for name, (_, unit) in row.items()}.items():
        made.add_row(name, *(f"{row[name][0]:.7g}" if name in row else "–" for row in rows), unit)
    if law.is_adiabatic:
        made.add_row("heating", f"{law.heating:.4g}", *[""] * (len(rows) - 1), "K mm²/N")
    return made


def _ends(program: "Program", history: "History") -> "Table":
    """Table of the state at the end of each step: the strains and stresses of the program, and b*."""
    import numpy as np

    from coilset.model.tools.identification.figures import SYMBOLS
    from coilset.scripts.terminal.console import table

    names = {**SYMBOLS, "plastic_work": "b*", "temperature": "T"}
    columns = [(names[name], values) for name, values in history.columns() if name in names and np.ptp(values) > 1e-9]
    made = table(["end of step", *(name for name, _ in columns)], padding=1)
    for index, step in enumerate(program.steps):
        row = (history.step == index).nonzero()[0][-1]
        values = (values[row] if abs(values[row]) > 1e-9 * abs(values).max() else 0.0 for _, values in columns)
        made.add_row(f"{index + 1} {step.name}", *(f"{value:.5g}" for value in values))
    return made
