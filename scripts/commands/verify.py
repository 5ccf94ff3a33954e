"""`coilset verify`: run verification cases, print and keep their results, with all numbers in one final table."""

import os
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

from mpi4py import MPI
from rich.table import Table

from coilset.model.core.base.errors import CoilsetError, InputError
from coilset.model.core.results.files.folder import make, whole
from coilset.scripts.terminal.console import Console, styled, table
from coilset.verification import registry
from coilset.verification.page import page, percent
from coilset.verification.study import Check, Study

WIDTH = 200  # columns of output that goes to a file


def verify(names: Sequence[str] | None, out: str | Path, fast: bool, page_file: str | None = None) -> int:
    """Run the named cases, all if none is named; returns 1 if a value is off, else 0.

    Args:
        names: of cases.
        out: folder of the records and figures.
        fast: only cases that take seconds.
        page_file: where to write the page of all records in `out`, including those of earlier runs; its rows of cases
            without a record stay.

    Raises:
        InputError: for an unknown case.
    """
    if MPI.COMM_WORLD.size > 1:
        raise InputError("works on one rank only; omit -n", "verify")
    cases = [registry.load(name) for name in names or registry.names()]
    if fast:
        cases = [case for case in cases if case.fast]
    console = Console(width=None if sys.stdout.isatty() else WIDTH)
    began = time.perf_counter()
    found = {case.name: _run(case, Path(out) / case.name, console) for case in cases}
    console.print(_all_checks(found))
    judged = [check for study in found.values() for check in study.checks if check.judged]
    shown = sum(not check.judged for study in found.values() for check in study.checks)
    met = sum(check.passed for check in judged)
    console.print(
        f"{len(cases)} case(s) in {time.perf_counter() - began:.0f} s; {len(judged)} numbers judged: "
        f"{met} met, {len(judged) - met} not met; {shown} shown but not judged"
    )
    if page_file:
        make(Path(page_file).parent)
        with whole(Path(page_file)) as path:
            before = Path(page_file).read_text(encoding="utf-8") if Path(page_file).exists() else ""
            path.write_text(page(out, before), encoding="utf-8")
    off = [name for name, study in found.items() if not study.passed]
    within = styled("green", "all judged numbers within tolerance")
    console.print(styled("red", f"off: {', '.join(off)}") if off else within)
    return 1 if off else 0


def show() -> None:
    """List the cases."""
    cases = map(registry.load, registry.names())
    rows = ([case.name, "" if case.fast else "slow", case.title] for case in cases)
    Console().print(table(["case", "", "quantity compared"], rows, left=3))


def _run(case: registry.Case, folder: Path, console: Console) -> Study:
    """The Study of a case, written."""
    length = "" if case.fast else " (slow: up to several minutes)"
    console.rule(styled("bold", case.name, f": {case.title}{length}"), align="left")
    study, began = Study(folder), time.perf_counter()
    try:
        case.run(study)
    except (CoilsetError, RuntimeError) as error:
        study.stopped = str(error)
        console.print(styled("red", study.stopped))
    study.write(case.name)
    for one in study.tables:
        rows = (["" if value is None else _number(value) for value in row] for row in one["rows"])
        console.print(table(one["columns"], rows, one["title"], left=0))
    for note in study.notes:
        console.print(note)
    files = ", ".join([*study.figures, "record.json"])
    console.print(f"{time.perf_counter() - began:.1f} s; {files} in {folder}{os.sep}\n")
    return study


def _all_checks(found: Mapping[str, Study]) -> Table:
    """Every number of every case: what, computed, reference, deviation, tolerance, verdict."""
    made = table(("case", "quantity", "computed", "reference", "deviation", "tolerance"), left=2, padding=1)
    for column in ("verdict", "source"):
        made.add_column(column)
    for name, study in found.items():
        for check in study.checks:
            style = "" if check.judged and check.passed else "red" if check.judged else "yellow"
            row = [name, check.quantity, _number(check.ours), *_limits(check), check.verdict, check.source]
            made.add_row(*row, style=style)
        if study.stopped:
            made.add_row(name, "", "", "", "", "", f"stopped: {study.stopped}", "", style="red")
    return made


def _limits(check: Check) -> tuple[str, str, str]:
    """Reference, deviation and tolerance, in words."""
    if check.kind == "at_most":
        return f"≤ {_number(check.reference + check.tolerance)}", "", ""
    number = percent if check.kind == "relative" else lambda value: f"{value:+.3g}"
    tolerance = number(check.tolerance).lstrip("+") if check.judged else "–"
    return _number(check.reference), number(check.deviation), tolerance


def _number(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    return str(value)
