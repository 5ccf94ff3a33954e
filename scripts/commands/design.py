"""`coilset design`: find entries of a case so that its run meets conditions, and write the resulting case."""

import os
import time
from contextlib import closing
from dataclasses import replace
from pathlib import Path

from coilset.model.core.base.errors import InputError, naming
from coilset.model.core.case.names import entry_name
from coilset.model.core.results.files.folder import clear, making
from coilset.model.core.runtime.threads import usual
from coilset.model.tools.design import output
from coilset.model.tools.design.choices import Options
from coilset.model.tools.design.design import Solution, make_search, solve
from coilset.model.tools.design.evaluation import Evaluation
from coilset.model.tools.design.file import Design, read_design_file
from coilset.model.tools.design.search import TOLERANCE, Search
from coilset.model.tools.design.trade_offs import TradeOff, trade_offs
from coilset.model.tools.sweep.journal import Journal, read_records
from coilset.scripts.terminal.console import Console, styled, table
from coilset.scripts.terminal.log import run_log
from coilset.scripts.terminal.target import results_folder

WIDTH = 150  # width of printed lines without a terminal


def design(design_file: str, out: str | None, force: bool, resume: bool, threads: int | None = None) -> None:
    """Find the unknowns of a design; see `coilset design --help`.

    Raises:
        InputError: the file is wrong or its conditions cannot be met; then nothing is written.
        SolveError: the search does not converge; --resume continues it.
    """
    console = Console()
    if not console.is_terminal:
        console = Console(width=WIDTH)
    wanted = read_design_file(design_file)
    with naming(design_file):
        make_search(wanted)
    folder = results_folder(out, Path(design_file).stem)
    new = _prepare(folder, force, resume)
    try:
        with naming(design_file), run_log(folder, goes_on=resume):
            if not resume:
                clear(folder, output.FILES)
            with closing(Journal(folder / "evaluations.jsonl")) as journal:
                _design(console, wanted, folder, journal, threads or usual(1))
    except InputError as error:
        if error.place != "--out" and (new or not resume):  # with --out, another run uses the folder
            _forget(folder, new)
        raise
    except KeyboardInterrupt:
        console.print("interrupted; run the same command with --resume to continue")
        raise


def _design(console: Console, wanted: Design, folder: Path, journal: Journal, threads: int) -> None:
    began = time.perf_counter()
    known = {record["key"]: record for record in read_records(journal.path)}
    progress = Progress(console)
    search = make_search(wanted, known, journal.append, progress, threads)
    progress.search = search
    console.say(f"{wanted.file.name}: {len(search.width)} unknown(s), {len(search.conditions)} condition(s)")
    solution = solve(search)
    rows = list(trade_offs(solution.found.search, solution.found, wanted.spec.trade_offs))
    output.write(folder, wanted, solution, rows, time.perf_counter() - began)
    _conclude(console, solution, rows, folder, time.perf_counter() - began)


class Progress:
    """A line for each evaluation."""

    def __init__(self, console: Console) -> None:
        self.console, self.number = console, 0
        self.search: Search | None = None

    def __call__(self, found: Evaluation, known: bool) -> None:
        """An evaluation has ended."""
        assert self.search is not None
        self.number += 1
        search = self.search
        unknowns = ", ".join(
            f"{one.words} {value:.7g} {one.unit}".rstrip()
            for one, value in zip(search.evaluator.named, found.x, strict=True)
        )
        if found.failed:
            answer = f"fails: {found.reason}"
        else:
            values = dict.fromkeys(  # a result may have a lower and an upper limit
                f"{one.words} {value:.7g} {one.unit}"
                for one, value in zip(search.conditions, found.values, strict=True)
            )
            answer = f"{', '.join(values)}, off by {abs(search.missed(search.off(found.values))).max():.1e}"
        seconds = "known" if known else f"{found.seconds:.1f} s"
        self.console.print(f"{self.number:3d}  {unknowns}: {answer} ({seconds})", soft_wrap=True)


def _conclude(console: Console, solution: Solution, rows: list[TradeOff], folder: Path, seconds: float) -> None:
    found, search = solution.found, solution.found.search
    if solution.options is not None:
        _list(console, solution.options)
    for name, words, value in zip(search.evaluator.names, search.evaluator.named, found.x, strict=True):
        entry = "" if words.words == name else f"  ({name})"
        console.print(styled("bold", f"{words.words} = {value:.7g} {words.unit}".rstrip(), entry))
    for one, value, off in zip(search.conditions, found.best.values, found.off, strict=True):
        if not found.met or one.sense:
            missed = f", missed by {one.deviation(one.missed(off))}" if abs(one.missed(off)) > TOLERANCE else ""
            active = "" if not one.sense or missed else ", active" if one.is_active(off) else ", not active"
            console.print(f"{one.words} {value:.6g} {one.unit} for {one.wanted}{missed}{active}")
    if not found.met:
        console.print("the conditions are not met; this spring comes as close as possible (least squares)")
    elif found.is_one_of_many:
        console.print("several springs meet these conditions; this one is nearest to the entries of the case")
    _estimates(console, search, rows)
    for warning in found.best.summary["warnings"]:
        console.warn(warning["message"])
    console.say(
        f"{search.evaluator.count} evaluations in {seconds:.1f} s; solve {folder}{os.sep}found.yaml for all "
        "results of this spring (also there: design.json, trade_offs.csv)"
    )


def _list(console: Console, options: Options) -> None:
    """The combinations that were evaluated, and how their best relates to all."""
    tried = len(options.tried)
    among = f"all {tried}" if tried == options.total else f"the {tried} evaluated of {options.total}"
    made = table([*options.best.chosen, ""], left=0)
    for one in options.tried:
        result = one.reason or ("met" if one.found and one.found.met else f"off by {100.0 * one.off:.2g} %")
        cells = [f"{value:.7g}" for value in one.chosen.values()]
        made.add_row(*cells, result + (f" (the best of {among})" if one is options.best else ""))
    console.print(made)


def _estimates(console: Console, search: Search, rows: list[TradeOff]) -> None:
    console.print("estimates for other targets (fast model, corrected by the runs):")
    heads = [one.head for one in search.evaluator.named]
    made = table(["", *heads, "wire length, mm", "length as wound, mm", "torque/yield", ""])
    made.columns[0].no_wrap = True
    targets = {one.name: one for one in search.conditions}
    for row in rows:
        value = f"{row.value:.6g}" if isinstance(row.value, float) else str(row.value)
        numbers = [*row.unknowns.values(), row.wire_length_mm, row.free_length_before_mm, row.torque]
        cells = ("–" if number is None else f"{number:.5g}" for number in numbers)
        if row.of in targets:
            what = replace(targets[row.of], target=row.value)
            of = f"{what.words} {what.wanted}"
        else:
            entry = entry_name(row.of)
            of = f"{entry.words} {value} {entry.unit}".rstrip()
        made.add_row(of, *cells, "" if row.possible else "out of reach")
    console.print(made)


# ---- the folder ------------------------------------------------------------------------------------------------------


def _prepare(folder: Path, force: bool, resume: bool) -> bool:
    """Make the folder; whether it is new.

    Raises:
        InputError: if it holds a design already, finished or not, or cannot be made.
    """
    new = not folder.exists()
    with making(folder):
        if not (force or resume):
            if (folder / "design.json").exists():
                raise InputError(
                    "holds a design already; give --overwrite to replace it, or another --out", "--out", folder
                )
            if (folder / "evaluations.jsonl").exists():
                raise InputError(
                    "holds an unfinished search; give --resume to go on with it, --overwrite to begin "
                    "anew, or another --out",
                    "--out",
                    folder,
                )
        folder.mkdir(parents=True, exist_ok=True)
    return new


def _forget(folder: Path, new: bool) -> None:
    """Remove all traces of a rejected design."""
    clear(folder, (*output.FILES, "log.txt"))
    if new:
        folder.rmdir()
