"""`coilset sweep`: run a sweep file, keep every case as soon as it ends, and draw the results."""

import os
import signal
import time
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass
from functools import partial
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from coilset.model.core.base.errors import InputError, SolveError
from coilset.model.core.results.files.folder import clear, making, refuse_obstacles
from coilset.model.tools.sweep import multifidelity, parquet
from coilset.model.tools.sweep.engines.pool import Pool
from coilset.model.tools.sweep.engines.processes import Workers
from coilset.model.tools.sweep.journal import Journal, Records, journals, read_records
from coilset.model.tools.sweep.plan import Plan
from coilset.model.tools.sweep.run import Limits, finished, missing, run
from coilset.model.tools.sweep.shards import WHOLE, Shard
from coilset.scripts.terminal.console import Console, table
from coilset.scripts.terminal.log import only_run
from coilset.scripts.terminal.target import results_folder

if TYPE_CHECKING:  # at run time only after the environment is saved
    from mpi4py import MPI

REPORT_SECONDS = 30.0  # seconds between progress lines without a terminal
OF_PRESSED = "set_mm", "force_max_N", "rate_N_per_mm", "residual_shear_max_MPa"  # numbers of which statistics are shown
OF_TURNED = "turn_set_deg", "torque_max_Nmm", "turn_rate_Nmm_per_deg", "residual_bending_inside_MPa"
SHOWN_FAILURES = 5
KEPT_FROM = 10_000  # cases: from here on reading them again is worth a file


@dataclass(frozen=True)
class Options:
    """How a sweep is run; see `coilset sweep --help`."""

    force: bool = False
    resume: bool = False
    retry: bool = False
    collect: bool = False
    shard: Shard = WHOLE
    until: float = inf  # seconds from the start of the command
    budget: float = inf  # seconds of all cases together
    scheduler: str | None = None
    ranks_per_case: int = 1
    pictures: bool = True

    @property
    def continues(self) -> bool:
        """Whether cases that are there are kept."""
        return self.resume or self.retry or self.collect or self.shard.count > 1


def sweep(sweep_file: str, out: str | None, workers: Workers, options: Options) -> None:
    """Run a sweep, by the Workers if it has no other engine.

    Raises:
        InputError: before anything is run, if a file is wrong or the folder already holds a sweep.
        SolveError: cases failed; after the results are written.
        KeyboardInterrupt: after the finished cases are collected.
    """
    from mpi4py import MPI

    from coilset.model.core.base.agreement import on_first_rank

    comm = MPI.COMM_WORLD
    folder = results_folder(out, Path(sweep_file).stem)
    console = Console()
    interrupted = False
    with ExitStack() as held:
        plan = on_first_rank(comm, lambda: _prepare(sweep_file, folder, options, held))
        try:
            if not options.collect:
                with _pool(comm, workers, options, folder) as pool:
                    if pool is not None and plan is not None:
                        _lead(plan, folder, options, pool, console)
        except KeyboardInterrupt:
            interrupted = True
        failed = comm.bcast(0 if plan is None else _conclude(plan, folder, options, console))
    if interrupted:
        console.print("interrupted; run the same command with --resume to continue")
        raise KeyboardInterrupt
    if failed:
        raise SolveError(f"{failed} case(s) failed; their reasons are in the journal, --retry runs them again")


def _prepare(sweep_file: str, out: Path, options: Options, held: ExitStack) -> Plan:
    """The plan of a sweep, whose folder, or shard in it, is `held` for it from now on."""
    if options.force and options.continues:
        raise InputError("discards what other options keep; give one of them", "--overwrite")
    shard = options.shard
    refuse_obstacles(out, [shard.journal, "plan.npz", "sweep.nc", "sweep.parquet", "workers.log"])
    plan = Plan(sweep_file, out / "plan.npz", shard)
    if not (options.force or options.continues) and journals(out):
        raise InputError("holds a sweep; use --resume to finish it, or --overwrite to overwrite it", "--out", out)
    with making(out):
        out.mkdir(parents=True, exist_ok=True)
    held.enter_context(only_run(out) if shard.count == 1 else shard.claimed(out))
    if options.force:
        clear(out, ("sweep.nc", "sweep.parquet", "report.html", *(path.name for path in journals(out))))
    if shard.count == 1 and len(plan) >= KEPT_FROM:
        plan.keep(out / "plan.npz")
    return plan


@contextmanager
def _pool(comm: "MPI.Comm", workers: Workers, options: Options, out: Path) -> Iterator[Pool | None]:
    if options.scheduler is not None:
        from coilset.model.tools.sweep.engines.dask import dask_pool

        with dask_pool(options.scheduler) as pool:
            yield pool
    elif comm.size > 1:
        from coilset.model.tools.sweep.engines.mpi import mpi_pool

        with mpi_pool(comm, options.ranks_per_case) as pool:
            yield pool
    else:
        with workers.pool(out / "workers.log") as pool:
            yield pool


def _lead(plan: Plan, out: Path, options: Options, pool: Pool, console: Console) -> None:
    """Run the missing cases, with a progress bar."""
    signal.signal(signal.SIGTERM, signal.getsignal(signal.SIGINT))  # a batch system's signal at the end of a job
    shard, limits = options.shard, Limits(options.until, options.budget, time.monotonic())
    done = finished(out, options.retry)
    with closing(Journal(out / shard.journal, locked=shard.count == 1)) as journal:
        total, todo = len(missing(plan, (), shard)), missing(plan, done, shard)
        left = len(todo)
        del done
        for notice in plan.notices:
            console.warn(notice)
        share = f", shard {shard.number} of {shard.count}" if shard.count > 1 else ""
        console.say(f"{plan.path.name}{share}: {total} cases, {total - left} done already, {pool.workers} at a time")
        progress = Bar(left, console)
        with progress.bar:
            run(plan, plan.work(todo), pool, journal, progress.report, limits)
        if progress.done < left:
            console.print(f"stopped at its limit with {left - progress.done} cases left; --resume continues")


class Bar:
    """Progress bar with cases per minute and time left; an occasional line without a terminal."""

    def __init__(self, total: int, console: Console) -> None:
        self.total, self.console, self.done, self.failed = total, console, 0, 0
        self.began = self.said = time.monotonic()
        self.bar = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("{task.fields[rate]}"),
            TimeRemainingColumn(),
            TextColumn("[red]{task.fields[failed]}"),
            console=console,
            disable=not console.is_terminal,
            speed_estimate_period=120.0,
        )
        self.task = self.bar.add_task("cases", total=total, rate="", failed="")

    def report(self, record: dict[str, Any]) -> None:
        """A case has ended."""
        now = time.monotonic()
        self.done += 1
        self.failed += record["status"] == "failed"
        speed = 60.0 * self.done / max(now - self.began, 1e-9)
        failed = f"{self.failed} failed" if self.failed else ""
        self.bar.update(self.task, completed=self.done, rate=f"{speed:.1f} a minute", failed=failed)
        if not self.console.is_terminal and now - self.said > REPORT_SECONDS:
            self.said = now
            left = f"{(self.total - self.done) / speed:.1f} minutes left"
            self.console.print(f"{self.done}/{self.total} cases, {speed:.1f} a minute, {left} {failed}")


def _conclude(plan: Plan, out: Path, options: Options, console: Console) -> int:
    """Data set, figures and a summary in words; returns the number of failed cases."""
    if options.shard.count > 1:
        console.say(f"journal in {out / options.shard.journal}; when all shards are done, --collect joins them")
        return sum(record["status"] == "failed" for record in read_records(out / options.shard.journal))
    clear(out, ("sweep.parquet", "report.html"))  # of other cases
    records = Records(out, plan.task_keys)
    counts = records.counts
    of_rods, written = None, parquet.write(out / "sweep.parquet", plan, records)
    del records
    if written is None:
        console.warn("sweep.parquet is not written: the package pyarrow is not installed")
    else:  # before xarray and matplotlib, so that memory need not hold both
        of_rods = list(multifidelity.lines(plan, partial(multifidelity.of_parquet, out / "sweep.parquet")))
    from coilset.model.tools.figures.png import write_png  # after the cases: xarray and matplotlib take half a second
    from coilset.model.tools.findings import capability
    from coilset.model.tools.findings.figures import FILES, draw
    from coilset.model.tools.findings.histogram import histogram
    from coilset.model.tools.sweep import dataset

    data = dataset.collect(plan, out)
    clear(out, ("limits.png", *FILES))
    dataset.write(out / "sweep.nc", data)
    if data.sizes["case"] < len(plan):
        console.say(f"sweep.nc and figures show {data.sizes['case']} of {len(plan)} cases; sweep.parquet has all")
    shown = multifidelity.as_rods(data)
    files, problems = draw(out, plan, shown) if options.pictures else ([], [])
    for line in multifidelity.lines(plan, partial(multifidelity.of_response, data)) if of_rods is None else of_rods:
        console.print(line)
    capable = capability.capabilities(data)
    for line in capability.lines(capable):
        console.print(line)
    if capable and options.pictures:
        write_png(out / "limits.png", [histogram(one) for one in capable])
    extents = table(["", "minimum", "mean", "maximum"])
    turned = "turn_set_deg" in data and data["turn_set_deg"].notnull().any()
    for name in OF_TURNED if turned else OF_PRESSED:
        if name in data and data[name].notnull().any():
            values = shown[name]
            words, unit = values.attrs["long_name"], values.attrs["units"]
            numbers = (f"{float(value):.5g}" for value in (values.min(), values.mean(), values.max()))
            extents.add_row(f"{words}, {unit}", *numbers)
    console.print(extents)
    failures = [k for k, status in enumerate(data.status.values) if status == "failed"]
    for k in failures[:SHOWN_FAILURES]:
        inputs = ", ".join(f"{name} = {data[name].values[k]}" for name in plan.names)
        console.warn(f"{inputs}: {data.reason.values[k]}", "failed")
    console.print(", ".join(f"{count} {status}" for status, count in counts.items() if count or status == "done"))
    console.say(
        f"results in {out}{os.sep} (sweep.nc, sweep.parquet, journal.jsonl{''.join(', ' + name for name in files)})"
    )
    for problem in problems:
        console.warn(str(problem))
    return counts["failed"]
