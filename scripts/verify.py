"""`coilset verify`: run cases of verification, print and keep what they found."""

import os
import sys
import time
from pathlib import Path

from mpi4py import MPI
from rich.console import Console
from rich.table import Table

from coilset.model.errors import CoilsetError, InputError
from coilset.verification import registry
from coilset.verification.study import Study

WIDTH = 140  # columns where the output goes to a file


def verify(names, out, fast):
    """Run the named cases, all if none is named; returns 1 if a value is off, else 0.

    Raises:
        InputError: for a name that is no case.
    """
    if MPI.COMM_WORLD.size > 1:
        raise InputError("works on one rank; leave -n out", "verify")
    cases = [registry.load(name) for name in names or registry.names()]
    if fast:
        cases = [case for case in cases if case.fast]
    console = Console(highlight=False, width=None if sys.stdout.isatty() else WIDTH)
    off = [case.name for case in cases if not _run(case, Path(out) / case.name, console)]
    console.print(f"[red]off: {', '.join(off)}[/]" if off else f"[green]{len(cases)} case(s), all within tolerance[/]")
    return 1 if off else 0


def show():
    """List the cases."""
    table = Table(box=None, padding=(0, 2))
    for column in ("case", "", "what is compared"):
        table.add_column(column)
    for case in map(registry.load, registry.names()):
        table.add_row(case.name, "" if case.fast else "slow", case.title)
    Console(highlight=False).print(table)


def _run(case, folder, console):
    console.rule(f"[bold]{case.name}[/]: {case.title}", align="left")
    study, began = Study(folder), time.perf_counter()
    try:
        case.run(study)
    except CoilsetError as error:
        console.print(f"[red]{error}[/]")
        return False
    study.write(case.name)
    for table in study.tables:
        console.print(_plain_table(table))
    console.print(_check_table(study.checks))
    for note in study.notes:
        console.print(note)
    files = ", ".join([*study.figures, "record.json"])
    console.print(f"{time.perf_counter() - began:.1f} s; {files} in {folder}{os.sep}\n")
    return study.passed


def _check_table(checks):
    table = Table(box=None, padding=(0, 2), header_style="bold")
    for column in ("quantity", "ours", "reference", "deviation", "tolerance", "source"):
        table.add_column(column, justify="left" if column in ("quantity", "source") else "right")
    for check in checks:
        if check.kind == "at_most":
            limits = ["", f"≤ {_number(check.reference + check.tolerance)}"]
        elif check.kind == "relative":
            limits = [f"{100 * check.deviation:+.3g} %", f"{100 * check.tolerance:.3g} %"]
        else:
            limits = [f"{check.deviation:+.3g}", f"{check.tolerance:.3g}"]
        style = "" if check.passed else "red"
        row = [check.quantity, _number(check.ours), _number(check.reference), *limits, check.source]
        table.add_row(*row, style=style)
    return table


def _plain_table(content):
    table = Table(title=content["title"], title_justify="left", box=None, padding=(0, 2), header_style="bold")
    for column in content["columns"]:
        table.add_column(column, justify="right")
    for row in content["rows"]:
        table.add_row(*("" if value is None else _number(value) for value in row))
    return table


def _number(value):
    if isinstance(value, float):
        return f"{value:.6g}"
    return str(value)
