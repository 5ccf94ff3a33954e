"""`coilset design`: find entries of a case so that its run meets conditions, and write the resulting case."""

import os
import time
from contextlib import closing
from pathlib import Path

from rich.table import Table

from coilset.model.base.errors import InputError, naming
from coilset.model.design import output
from coilset.model.design.design import find, make_search
from coilset.model.design.evaluation import Evaluation
from coilset.model.design.search import Found, Search
from coilset.model.design.trade_offs import TradeOff, trade_offs
from coilset.model.design.wish import Wish, read_wish
from coilset.model.results.files.folder import clear, making
from coilset.model.runtime.threads import usual
from coilset.model.sweep.journal import Journal, read_records
from coilset.scripts.terminal.console import Console
from coilset.scripts.terminal.log import run_log
from coilset.scripts.terminal.target import results_folder

WIDTH = 150  # width of printed lines without a terminal


def design(wish_file: str, out: str | None, force: bool, resume: bool, threads: int | None = None) -> None:
    """Find what a wish requires; see `coilset design --help`.

    Raises:
        InputError: the wish is wrong or cannot be met; then nothing is written.
        SolveError: the search does not converge; --resume continues it.
    """
    console = Console()
    if not console.is_terminal:
        console = Console(width=WIDTH)
    wish = read_wish(wish_file)
    with naming(wish_file):
        make_search(wish)
    folder = results_folder(out, Path(wish_file).stem)
    new = _prepare(folder, force, resume)
    try:
        with naming(wish_file), run_log(folder) as log:
            if not resume:
                assert log.stream is not None  # it is opened in advance
                log.stream.truncate(0)
                clear(folder, output.FILES)
            with closing(Journal(folder / "evaluations.jsonl")) as journal:
                _design(console, wish, folder, journal, threads or usual(1))
    except InputError as error:
        if error.place != "--out" and (new or not resume):  # with --out, another run uses the folder
            _forget(folder, new)
        raise
    except KeyboardInterrupt:
        console.print("interrupted; run the same command with --resume to continue")
        raise


def _design(console: Console, wish: Wish, folder: Path, journal: Journal, threads: int) -> None:
    began = time.perf_counter()
    known = {record["key"]: record for record in read_records(journal.path)}
    progress = Progress(console)
    search = make_search(wish, known, journal.append, progress, threads)
    progress.search = search
    console.say(f"{wish.file.name}: {len(search.width)} unknown(s), {len(search.conditions)} condition(s)")
    found = find(search)
    rows = list(trade_offs(search, found, wish.spec.trade_offs))
    output.write(folder, wish, search, found, rows, time.perf_counter() - began)
    _conclude(console, search, found, rows, folder, time.perf_counter() - began)


class Progress:
    """A line for each evaluation."""

    def __init__(self, console: Console) -> None:
        self.console, self.number = console, 0
        self.search: Search | None = None

    def __call__(self, found: Evaluation, known: bool) -> None:
        """An evaluation has ended."""
        assert self.search is not None
        self.number += 1
        search, names = self.search, self.search.evaluator.names
        unknowns = ", ".join(f"{name} {value:.7g}" for name, value in zip(names, found.x, strict=True))
        if found.failed:
            answer = f"fails: {found.reason}"
        else:
            values = (
                f"{one.words} {value:.7g} {one.unit}"
                for one, value in zip(search.conditions, found.values, strict=True)
            )
            answer = f"{', '.join(values)}, off by {abs(search.off(found.values)).max():.1e}"
        seconds = "known" if known else f"{found.seconds:.1f} s"
        self.console.print(f"{self.number:3d}  {unknowns}: {answer} ({seconds})", soft_wrap=True)


def _conclude(
    console: Console, search: Search, found: Found, rows: list[TradeOff], folder: Path, seconds: float
) -> None:
    for name, value in zip(search.evaluator.names, found.x, strict=True):
        console.print(f"[bold]{name} = {value:.7g}[/]")
    if not found.met:
        parts = (
            f"{one.words} {value:.6g} for {one.wish:g} {one.unit}"
            for one, value in zip(search.conditions, found.best.values, strict=True)
        )
        console.print(f"as close as possible (least squares): {', '.join(parts)}")
    console.print("estimates for other wishes and springs, by the uniform rod as the runs have corrected it:")
    table = Table(box=None, padding=(0, 2))
    table.add_column("", no_wrap=True)
    for name in (*search.evaluator.names, "wire length, mm", "as wound, mm", "torque/yield"):
        table.add_column(".".join(name.split(".")[-2:]), justify="right")
    table.add_column("")
    for row in rows:
        value = f"{row.value:.6g}" if isinstance(row.value, float) else str(row.value)
        numbers = [*row.unknowns.values(), row.wire_length_mm, row.free_length_before_mm, row.torque]
        cells = ("–" if number is None else f"{number:.5g}" for number in numbers)
        table.add_row(f"{row.of} {value}", *cells, "" if row.possible else "out of reach")
    console.print(table)
    for warning in found.best.summary["warnings"]:
        console.warn(warning["message"])
    console.say(
        f"{search.evaluator.count} evaluations in {seconds:.1f} s; solve {folder}{os.sep}found.yaml for all "
        "results of this spring (also there: design.json, trade_offs.csv)"
    )


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
    """Remove all traces of a rejected wish."""
    clear(folder, (*output.FILES, "log.txt"))
    if new:
        folder.rmdir()
