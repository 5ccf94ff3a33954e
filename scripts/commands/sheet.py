"""`coilset sheet`: the formulas of the standards for a case's spring, beside the results of a run."""

import itertools
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, get_args

from mpi4py import MPI
from rich.text import Text

from coilset.meshes.springs.spring import Spring
from coilset.model.core.base.errors import InputError, naming
from coilset.model.core.base.warning import Warning
from coilset.model.core.case import Case, UnloadedCase, read_case
from coilset.model.core.case.material import case_law
from coilset.model.core.results.files.folder import make, refuse_to_replace
from coilset.model.tools.checks.check import Check
from coilset.model.tools.checks.table import checks
from coilset.model.tools.document.words import Language, Words
from coilset.model.tools.figures.panels.goodman import goodman as diagram_of
from coilset.model.tools.figures.png import write_png
from coilset.model.tools.limits.case_warnings import warm_warnings
from coilset.model.tools.limits.presetting import presetting_warning
from coilset.model.tools.limits.spring_warnings import spring_warnings
from coilset.model.tools.sheet import from_results
from coilset.model.tools.sheet.case_sheet import case_sheet
from coilset.model.tools.sheet.rows import Row, sections
from coilset.model.tools.sheet.sheet import Sheet
from coilset.model.tools.standards import goodman
from coilset.model.tools.standards.en15800 import GRADES
from coilset.model.tools.wires import names, wire
from coilset.model.tools.wires.library import files, own_folder
from coilset.model.tools.wires.wire_file import Surface
from coilset.model.tools.wires.words import WIRE_COLUMNS, described, table_row
from coilset.scripts.terminal.checks import check_lines
from coilset.scripts.terminal.console import Console, styled
from coilset.scripts.terminal.target import SHEETS, results_folder

FIGURE = "goodman.png"
MOST_DIFFERENCES = 4  # between a run and the case that a message lists


@dataclass(frozen=True)
class Options:
    """What is printed and written; see `coilset sheet --help`."""

    results: str | Path | None = None
    wire: str | None = None
    lengths: Sequence[float] = ()
    grade: int = 2
    surface: str = "as coiled"
    dynamic: bool = False
    out: Sequence[str | Path] = ()
    language: Language = "en"
    force: bool = False
    settings: Sequence[str] = ()
    pictures: bool = True
    height: float | None = None


def sheet(case_file: str | Path | None, options: Options) -> None:
    """Print the sheet of a spring, write it to files, or draw its Goodman diagram; see `coilset sheet --help`.

    Raises:
        InputError: wrong input, a spring that is not cylindrical, results of another spring, or a file that already
            exists.
    """
    if MPI.COMM_WORLD.rank:
        return  # too little work to be worth distributing
    surface = options.surface
    if surface not in get_args(Surface):
        raise InputError(f"'{surface}' is no surface; give {' or '.join(get_args(Surface))}", "--surface")
    if case_file is None:
        raise InputError("name a case file, or give --wires to list the wires", "coilset sheet")
    case = read_case(case_file, options.settings, UnloadedCase)
    files = [Path(one) for one in options.out if Path(one).suffix.lower() in SHEETS]
    folders = [one for one in options.out if Path(one) not in files]
    folder = results_folder(folders[-1] if folders else None, Path(case_file).stem)
    run = from_results.read(options.results) if options.results else None
    if run and options.results:
        _refuse_another_spring(run, case, options.results)
    with naming(case_file):
        spring = case.spring.build()
        grade = GRADES[options.grade]
        made = case_sheet(case, spring, run, options.wire, options.lengths, grade, surface, options.dynamic)
    body = None if options.height is None else _pressed(spring, options.height, files)
    diagram = _diagram(made) if options.pictures and (folders or not files) else None
    refuse_to_replace([*files, *([folder / FIGURE] if diagram is not None else [])], options.force)
    console = Console()
    table = checks(case, spring, run, made)
    warnings = _print(console, case, spring, made, table, options.results)
    if files:
        from coilset.model.tools.document.content import document
        from coilset.model.tools.document.output import write

        name = Path(options.results).resolve().name if options.results else ""
        content = document(case, spring, made, table, name, warnings, Words(options.language))
        if body is not None:
            content = replace(content, body=body)
        for file in files:
            write(content, file)
            console.say(f"sheet in {file}")
    if diagram is not None:
        make(folder)
        write_png(folder / FIGURE, [diagram_of(*diagram, made.residual)])
        console.say(f"Goodman diagram in {folder}{os.sep}{FIGURE}")


def _print(
    console: Console, case: Case, spring: Spring, made: Sheet, table: Sequence[Check], results: str | Path | None
) -> list[str]:
    """The checks, the rows, and warnings; returns these."""
    run, parts = made.found, sections(made)
    width = max(len(row.label) for _, rows in parts for row in rows)
    before = []
    if run and (other := _other_program(run, case)):  # before the rows, which it makes hard to compare
        before = [f"the run {results} is of another load program: {_listed(other)}"]
        console.warn(before[0])
    check_lines(console, table)
    beside = f"{'run':>9}  " if run else ""
    head = f"  {'':{width}} {'formula':>9} {'':5} {beside}"
    console.print(styled("dim", "how it is computed; check", before=head), soft_wrap=True)
    for title, rows in parts:
        console.print(styled("bold", title))
        for line in _lines(rows, run is not None, width):
            console.print(line, soft_wrap=True)
    if run and made.wire and not str(run.summary.get("material")).startswith(made.wire.name):
        console.print(f"the run was made with the material {run.summary.get('material')}, not with {made.wire.name}")
    warnings = [warning.message for warning in _warnings(case, spring, made)]
    for message in warnings:
        console.warn(message)
    return [*before, *warnings]


def _pressed(spring: Spring, height: float, files: Sequence[Path]) -> Spring:
    """The spring at `--height`; raises InputError if it cannot have it, or no solid body is written."""
    if not any(file.suffix.lower() == ".step" for file in files):
        raise InputError("is that of a solid body; add --out spring.step", "--height")
    try:
        return spring.at_height(height)
    except InputError as error:
        raise InputError(error.problem, "--height") from None


def _other_program(run: from_results.Found, case: Case) -> list[str]:
    """Entries of the load program that a run had otherwise than the case; into how many steps it is divided is none."""
    then, now = run.summary.get("origin", {}).get("case", {}).get("loading"), case.model_dump(mode="json")["loading"]
    if not now:
        return []
    old, new = ([{k: phase[k] for k in phase if k != "steps"} for phase in one] for one in (then or now, now))
    return list(_differences(old, new, "loading"))


def _refuse_another_spring(run: from_results.Found, case: Case, results: str | Path) -> None:
    """Raise InputError if the run was of another spring: its numbers beside these formulas would mean nothing."""
    then, now = run.summary.get("origin", {}).get("case", {}).get("spring"), case.spring.model_dump(mode="json")
    if other := list(_differences(then or now, now, "spring")):
        raise InputError(f"the run is of another spring: {_listed(other)}; give its own case", "--results", results)


def _differences(then: Any, now: Any, place: str) -> Iterator[str]:
    """Entries of which a run had other values, with both; entries that its version did not have are no difference."""
    if isinstance(then, list) and isinstance(now, list):
        for number, (old, new) in enumerate(itertools.zip_longest(then, now)):
            yield from _differences(old, new, f"{place}.{number}")
    elif isinstance(then, dict) and isinstance(now, dict):
        for name in then:
            yield from _differences(then.get(name), now.get(name), f"{place}.{name}")
    elif then != now:
        yield f"{place} was {_value(then)}, is {_value(now)} in the case"


def _value(value: Any) -> str:
    """Of an entry; one with entries of its own is named by those that are given."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{name}: {_value(one)}" for name, one in value.items() if one is not None) + "}"
    return "not given" if value is None else f"{value:.10g}" if isinstance(value, float) else str(value)


def _listed(differences: Sequence[str]) -> str:
    """The first few of them, in one line."""
    more = len(differences) - MOST_DIFFERENCES
    return "; ".join(differences[:MOST_DIFFERENCES]) + (f"; and {more} more" if more > 0 else "")


def list_wires(name: str | None = None) -> None:
    """Print the known wires, their diameters and how certain their strength is, or all numbers of one of them.

    Raises:
        InputError: if there is no wire of this name.
    """
    console = Console()
    if name is not None:
        known = wire(name)
        console.print(styled("bold", known.name, ", d in mm"))
        for label, number, citation in described(known):
            console.print(styled("dim", citation, before=f"  {label:29} {number}\n  {'':29} "), soft_wrap=True)
        for missing in files()[known.standard].missing:
            console.print(f"  not found: {missing}", soft_wrap=True)
        return
    rows = [list(WIRE_COLUMNS), *(table_row(wire(name)) for name in names())]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        console.print("  ".join(map(str.ljust, row, widths)).rstrip(), soft_wrap=True)
    console.print("no mark: checked against a second source; ': one source; ~: estimate; –: no data", soft_wrap=True)
    console.print(f"your own wires: files of the same form in {own_folder()}", soft_wrap=True)


def _diagram(made: Sheet) -> tuple[str, goodman.Line, goodman.Cycle] | None:
    """Wire, line and cycle of the Goodman diagram; None without endurance data or a cycle."""
    known, endured, cycle = made.wire, made.endured, made.cycle
    if known is None or endured is None or cycle is None:
        return None
    return f"{known.name}, {made.spring.d:g} mm", endured, cycle


def _warnings(case: Case, spring: Spring, made: Sheet) -> list[Warning]:
    cylinder = made.spring
    warm = warm_warnings(case, case_law(case, spring), made.wire.name if made.wire else None)
    warnings = [*warm, *spring_warnings(spring)]
    set_mm = made.at_run("set_mm")
    if set_mm and made.was_at_block and not (made.pulled or made.turned):  # any other run is no presetting
        warnings += filter(None, [presetting_warning(set_mm, cylinder.length - cylinder.solid)])
    return warnings


def _lines(rows: Sequence[Row], beside: bool, width: int) -> Iterator[Text]:
    """Text of a section: label, value, unit, result, formula and how it was checked; reasons on lines below."""
    units = max([4, *(len(row.unit) for row in rows)]) + 1
    for row in rows:
        found = _number(row.found) if row.found is not None else ""
        parts = [
            f"  {row.label:{width}} {_number(row.value):>9} {row.unit:{units}}",
            f"{found:>9}  " if beside else "",
            f"{row.formula}  " if row.formula else "",
        ]
        line = styled("dim", row.sure, before="".join(parts))
        line.rstrip()
        yield line
        if row.why and (row.found is not None or row.value is None):
            yield styled("dim", row.why, before=f"  {'':{width}} ")


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.5g}"
