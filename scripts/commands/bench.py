"""`coilset bench`: measure, print tables and keep a record."""

import json
import os
import platform
import shutil
import sys
import tempfile
import time
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Any

from rich.table import Table

from coilset.model.core.results.files.folder import clear, make, whole
from coilset.model.core.runtime.processes import folder_of_mpirun, mpi_settings, mpirun, usable_cores
from coilset.scripts.terminal.console import Console, table
from coilset.scripts.terminal.spring_costs import comparison, cost_table
from coilset.verification.benchmarks.everyday import MEASURED, everyday, launchers, of_a_new_command
from coilset.verification.benchmarks.measure import STAGES, per_element
from coilset.verification.benchmarks.million import FILES, interrupted, million
from coilset.verification.benchmarks.process import read_json
from coilset.verification.benchmarks.springs import press_springs

WIDTH = 140  # columns of output that goes to a file
MODULE = "coilset.verification.benchmarks.measure"
SIZES = {False: ((40, 5), (4_000, 2), (16_000, 1)), True: ((40, 5), (4_000, 3), (16_000, 2), (100_000, 1))}
SHARED = {False: (320, 2_560), True: (320, 2_560, 20_000)}  # elements that one and two ranks are compared on
KINDS = ("clamped, no contact", "clamped, coils in contact")
PAIRS = 3  # of one and two ranks


def bench(out: str, full: bool, cold: bool, against: str | None = None) -> None:
    """Run the benchmarks; see `coilset bench --help`.

    Raises:
        CoilsetError: if a measurement failed.
        InputError: if `against` is not a checkout.
    """
    environment = dict(os.environ)  # as it was before MPI
    console, began, folder = Console(width=None if sys.stdout.isatty() else WIDTH), time.perf_counter(), Path(out)
    starts = launchers(Path(against).resolve() if against else None)
    record: dict[str, Any] = {"machine": machine()}
    with console.status("measuring"):
        record["commands"] = everyday(starts, environment)
        record["example"] = measure(environment, "example", 5)
        if cold:
            with tempfile.TemporaryDirectory() as nothing:
                empty = {"XDG_CACHE_HOME": nothing, "NUMBA_CACHE_DIR": nothing}
                record["cold"] = measure(environment | empty, "example", 1)["first"]
        record["elements"] = [measure(environment, "press", *run) for run in SIZES[full]]
        record["ranks"] = [
            {"kind": kind, **one_and_two(environment, elements, touching)}
            for touching, kind in enumerate(KINDS)
            for elements in SHARED[full]
        ]
    record["load_after"] = os.getloadavg()[0]
    _keep(folder / "bench.json", record)
    for one in tables(record):
        console.print(one)
    found = record["machine"]
    console.print(
        f"{found['processor']}, {found['cores']} cores, load {found['load']:.1f} at the start, "
        f"{record['load_after']:.1f} at the end; {time.perf_counter() - began:.0f} s; bench.json in {folder}{os.sep}"
    )


def bench_springs(out: str, count: int, against: str | None = None) -> None:
    """Run the first `count` random springs here and in another checkout; see `coilset bench --help`.

    Raises:
        CoilsetError: if a process that runs them died.
        InputError: if `against` is not a checkout.
    """
    environment = of_a_new_command(os.environ)
    starts = launchers(Path(against).resolve() if against else None)
    console = Console(width=None if sys.stdout.isatty() else WIDTH)
    began, folder = time.perf_counter(), Path(out)

    def report(number: int, found: Sequence[Mapping[str, Any]]) -> None:
        for which, side in zip(("", " in the other checkout"), found, strict=False):
            if side["end"] != "complete":
                console.print(f"spring {number}{which}: {side['end']} after {side['seconds']:.1f} s {side['message']}")

    with console.status(f"running {count} springs"):
        rows = press_springs(starts, range(count), environment, report)
    _keep(folder / "springs.json", rows)
    for side, title in zip(range(len(starts)), ("random springs", "the same in the other checkout"), strict=False):
        console.print(cost_table(rows, side, title))
    if len(starts) > 1:
        console.print(comparison(rows))
    console.print(f"{time.perf_counter() - began:.0f} s; springs.json in {folder}{os.sep}")


def bench_million(out: str, fraction: float) -> None:
    """Run a sweep of a fraction of a million cases, or carry on with it; see `coilset bench --help`.

    Raises:
        InputError: the folder has an interrupted run of another fraction.
        CoilsetError: a command failed, or a case is missing.
    """
    environment, console, folder = dict(os.environ), Console(), Path(out)
    make(folder)
    before = interrupted(folder, fraction)
    if before is None:
        clear(folder, FILES)
        shutil.rmtree(folder / "million", ignore_errors=True)
    found = million(folder, fraction, environment, console.say, before)
    each = 1e3 * found.run_seconds / (found.uniform + found.rods)
    console.print(
        f"{found.uniform:,} uniform rods and {found.rods:,} rods in {found.run_seconds:,.0f} s, {each:.2f} ms a case, "
        f"killed three times, carried on {found.carried_on} times: {found.repeated} cases computed twice, "
        f"{found.failed} failed\n"
        f"collected again in {found.collect_seconds:,.0f} s; memory of the leading process {found.run_GiB:.2f} GiB, of "
        f"collecting {found.collect_GiB:.2f} GiB\n"
        f"on disk {found.journal_bytes:,.0f} bytes a case in the journal, {found.parquet_bytes:,.0f} in Parquet"
    )


def _keep(file: Path, record: Any) -> None:
    make(file.parent)
    with whole(file) as path:
        path.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")


def measure(environment: dict[str, str], job: str, *arguments: int, ranks: int = 1) -> dict[str, Any]:
    """One measurement.

    Args:
        environment: of the process, from before MPI.
        job, arguments: see coilset.verification.benchmarks.measure.
        ranks: under mpirun if there are more than one.

    Raises:
        CoilsetError: if the process failed.
    """
    command = [*(mpirun(ranks) if ranks > 1 else ()), sys.executable, "-m", MODULE, job, *map(str, arguments)]
    with folder_of_mpirun() as folder:
        name = f"the measurement '{' '.join(map(str, (job, *arguments)))}'"
        return read_json(command, name, mpi_settings() | environment | folder)


def one_and_two(environment: dict[str, str], elements: int, touching: int) -> dict[str, Any]:
    """One step on one and on two ranks in turns: medians of elapsed and processor seconds, difference of the forces."""
    runs = [
        [measure(environment, "press", elements, 2, touching, ranks=ranks) for ranks in (1, 2)] for _ in range(PAIRS)
    ]
    seconds = [
        [median(sum(pair[kind] for pair in turn[side]["stages"].values()) for turn in runs) for side in (0, 1)]
        for kind in (0, 1)
    ]
    one, two = runs[-1]
    return {
        **{name: two[name] for name in ("elements", "contacts")},
        "elapsed": seconds[0],
        "processor": seconds[1],
        "difference": abs(two["force_N"] / one["force_N"] - 1.0),
    }


def machine() -> dict[str, Any]:
    """The machine, and how busy it is."""
    model = platform.processor() or platform.machine()
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            model = next(line.split(":", 1)[1].strip() for line in file if line.startswith("model name"))
    except (OSError, StopIteration):
        pass
    return {"processor": model, "cores": usable_cores(), "load": os.getloadavg()[0]}


def tables(record: dict[str, Any]) -> Iterable[Table]:
    """The tables of a record."""
    rows, example = record["commands"], record["example"]
    sides = ("", ", the other")[: len(rows[0]["end"])]
    heads = [f"{kind}{side}" for kind in MEASURED for side in sides]
    yield table(
        ["command", *heads],
        ([row["name"], *(f"{value:.2f}" for kind in MEASURED for value in row[kind])] for row in rows),
        "commands, medians, s",
    )
    first = [one - other for one, other in zip(example["first"], example["analysis"], strict=True)]
    stages = {"import": example["import"], "load compiled code": first}
    if "cold" in record:
        stages["compile, from nothing"] = [a - b for a, b in zip(record["cold"], example["analysis"], strict=True)]
    stages |= example["stages"] | {name: example[name] for name in ("analysis", "output", "pictures")}
    title = f"example: {example['elements']} elements, {example['steps']} steps, {example['iterations']} iterations"
    rows = ([name, *(f"{1e3 * value:.1f}" for value in pair)] for name, pair in stages.items())
    yield table(["stage", "elapsed, ms", "processor, ms"], rows, title)
    yield table(
        ["elements", "iterations", "plastic", "memory, GiB", "µs per element and iteration", *STAGES],
        (
            [
                f"{run['elements']:,}",
                str(run["iterations"]),
                f"{100 * run['plastic']:.0f} %",
                f"{run['memory_GiB']:.2f}",
                f"{per_element(run):.1f}",
                *(f"{run['stages'][stage][1]:.2f} s" for stage in STAGES),
            ]
            for run in record["elements"]
        ),
        "one plastic step from rest, clamped heads",
    )
    yield table(
        ["spring", "elements", "contacts", "one, s", "two, s", "ratio", "one, processor", "two", "difference of force"],
        (
            [
                row["kind"],
                f"{row['elements']:,}",
                f"{row['contacts']:,}",
                *(f"{value:.2f}" for value in row["elapsed"]),
                f"{row['elapsed'][0] / row['elapsed'][1]:.2f}",
                *(f"{value:.2f}" for value in row["processor"]),
                f"{row['difference']:.1e}",
            ]
            for row in record["ranks"]
        ),
        "one rank and two in turns, medians; processor time is that of the busier rank, its waiting included",
    )
