"""`coilset bench`: measure, print tables, keep a record and a figure."""

import json
import os
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.table import Table

from coilset.model.results.files.folder import make, whole
from coilset.scripts.terminal.console import Console
from coilset.scripts.terminal.spring_costs import comparison, cost_table
from coilset.verification.benchmarks.everyday import launchers, of_a_new_command
from coilset.verification.benchmarks.run import bench as measure_all
from coilset.verification.benchmarks.springs import press_springs
from coilset.verification.benchmarks.target import ITERATION, per_element, seconds

WIDTH = 140  # columns of output that goes to a file


def bench(out: str, full: bool, cold: bool, against: str | None = None) -> None:
    """Run the benchmarks; see `coilset bench --help`.

    Raises:
        CoilsetError: if a measurement failed.
        InputError: if `against` is not a checkout.
    """
    environment = dict(os.environ)  # as it was before MPI
    console = Console(width=None if sys.stdout.isatty() else WIDTH)
    began, folder = time.perf_counter(), Path(out)
    with console.status("") as status:
        record = measure_all(
            full,
            cold,
            environment,
            lambda name: status.update(f"measuring: {name}"),
            Path(against).resolve() if against else None,
        )
    from coilset.verification.benchmarks.figure import draw

    make(folder)
    with whole(folder / "bench.json") as path:
        path.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    draw(folder / "bench.png", record)
    for table in (
        _commands(record["commands"]),
        _walks(record["walks"]),
        _stages(record),
        _elements([*record["elements"], *record["unestimated"]]),
        _ranks(record["ranks"]),
        _one_and_two(record["one_and_two_ranks"]),
        _opensees(record["opensees"]),
        _targets(record["targets"]),
    ):
        console.print(table)
    cases = record["cases"]
    console.print(
        f"cases: {cases['cases']} one after the other, {cases['failed']} failed, {cases['seconds'][1]:.3f} s "
        f"each on the processor: {3600 / cases['seconds'][1]:,.0f} an hour and core "
        f"({3600 / cases['seconds'][0]:,.0f} as busy as the machine is)"
    )
    machine = record["machine"]
    console.print(
        f"{machine['processor']}, {machine['cores']} cores, load {machine['load']:.1f} at the start, "
        f"{record['load_after']:.1f} at the end; {time.perf_counter() - began:.0f} s; "
        f"bench.json, bench.png in {folder}{os.sep}"
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
    make(folder)
    with whole(folder / "springs.json") as path:
        path.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
    for side, title in zip(range(len(starts)), ("random springs", "the same in the other checkout"), strict=False):
        console.print(cost_table(rows, side, title))
    if len(starts) > 1:
        console.print(comparison(rows))
    console.print(f"{time.perf_counter() - began:.0f} s; springs.json in {folder}{os.sep}")


def _new(title: str, *columns: str) -> Table:
    table = Table(title=title, title_justify="left", box=None, padding=(0, 2), header_style="bold")
    for column in columns:
        table.add_column(column, justify="left" if column == columns[0] else "right")
    return table


def _commands(rows: list[dict[str, Any]]) -> Table:
    """Medians of this checkout, and of another one if given."""
    sides = ("", ", the other")[: len(rows[0]["end"])]
    table = _new(
        "commands, medians by the clock, s",
        "command",
        *(f"first line{side}" for side in sides),
        *(f"end{side}" for side in sides),
    )
    for row in rows:
        table.add_row(row["name"], *(f"{value:.2f}" for value in (*row["first_line"], *row["end"])))
    return table


def _walks(rows: list[dict[str, Any]]) -> Table:
    """Medians, as of the commands."""
    sides = ("s", "the other, s")[: len(rows[0]["seconds"])]
    table = _new("the example's load program alone, medians by the clock", "walk", "threads", *sides)
    for row in rows:
        spent = ("–" if value is None else f"{value:.3f}" for value in row["seconds"])
        table.add_row(row["name"], str(row["threads"]), *spent)
    return table


def _stages(record: dict[str, Any]) -> Table:
    """Time by stage of the example, warm; compilation on request."""
    example = record["example"]
    title = (
        f"example: {example['elements']} elements, {example['section_points']} points a section, "
        f"{example['steps']} steps, {example['iterations']} iterations"
    )
    table = _new(title, "stage", "time, ms", "processor, ms")

    def row(name: str, pair: Sequence[float], style: str = "") -> None:
        table.add_row(name, *(f"{1e3 * value:.1f}" for value in pair), style=style)

    row("import", example["import"])
    row("load compiled code", _more(example["first"], example["analysis"]))
    if "cold" in record:
        row("compile, from nothing", _more(record["cold"]["first"], example["analysis"]))
    for stage, pair in example["stages"].items():
        row(stage, pair)
    row("analysis", example["analysis"], "bold")
    row("output", example["output"])
    row("pictures", example["pictures"])
    return table


def _more(first: Sequence[float], warm: Sequence[float]) -> list[float]:
    """How much longer the first analysis of a process takes than the others."""
    return [one - other for one, other in zip(first, warm, strict=True)]


def _elements(runs: list[dict[str, Any]]) -> Table:
    table = _new(
        "one plastic step from rest, clamped heads; µs of the processor for an element in an iteration",
        "elements",
        "error",
        "iterations",
        "plastic",
        "all, s",
        "memory, GiB",
        "µs",
        *ITERATION,
    )
    for run in runs:
        table.add_row(
            f"{run['elements']:,}",
            "estimated" if run["estimated"] else "not estimated",
            str(run["iterations"]),
            f"{100 * run['plastic']:.0f} %",
            f"{seconds(run['stages']):.2f}",
            f"{run['memory_GiB']:.2f}",
            f"[bold]{per_element(run):.1f}[/]",
            *(f"{per_element(run, stage):.2f}" for stage in ITERATION),
        )
    return table


def _ranks(runs: list[dict[str, Any]]) -> Table:
    first = runs[0]
    table = _new(
        f"{first['elements']:,} elements on several ranks",
        "ranks",
        "time, s",
        "faster",
        "law, processor",
        "assemble, processor",
        "memory of a rank, GiB",
        "force against one rank",
    )
    for run in runs:
        law, assemble = (f"{run['stages'][stage][1]:.2f} s" for stage in ("law", "assemble"))
        table.add_row(
            str(run["ranks"]),
            f"{seconds(run['stages'], 0):.2f}",
            f"{seconds(first['stages'], 0) / seconds(run['stages'], 0):.2f}",
            law,
            assemble,
            f"{run['memory_GiB']:.2f}",
            f"{abs(run['force_N'] / first['force_N'] - 1):.1e}",
        )
    return table


def _opensees(runs: list[dict[str, Any]]) -> Table:
    table = _new(
        "the same clamped spring in OpenSees: 10 mm in 40 steps and release; the analysis alone, with "
        "several threads by the clock",
        "elements",
        "our axis",
        "error",
        "time",
        "coilset, N",
        "set, mm",
        "s",
        "OpenSees, N",
        "set, mm",
        "s",
        "times as fast",
    )
    for run in runs:
        theirs = run["opensees"]
        for ours, words in ((run["coilset"], "estimated"), (run["unestimated"], "none")):
            for kind, clock in (("seconds", "processor"), ("elapsed", f"{ours['threads']} threads")):
                row = [f"{run['elements']:,}", run["axis"], words, clock, *_answer(ours, kind)]
                if theirs:
                    row += [*_answer(theirs, kind), f"{theirs[kind] / ours[kind]:.1f}"]
                table.add_row(*row)
    if not all(run["opensees"] for run in runs):
        table.caption = "OpenSees is not here: pip install --target FOLDER openseespy; PYTHONPATH=FOLDER"
    return table


def _answer(run: dict[str, Any], kind: str) -> list[str]:
    return [f"{run['force_N']:.3f}", f"{run['set_mm']:.4f}", f"{run[kind]:.3f}"]


def _one_and_two(rows: list[dict[str, Any]]) -> Table:
    table = _new(
        "one rank and two in turns, medians; processor time is that of the busier rank, its waiting included",
        "spring",
        "elements",
        "contacts",
        "one rank, s",
        "two, s",
        "faster",
        "one, processor",
        "two, processor",
        "force against one rank",
    )
    for row in rows:
        (one, two), spent = row["elapsed"], row["processor"]
        table.add_row(
            row["kind"],
            f"{row['elements']:,}",
            f"{row['contacts']:,}",
            f"{one:.2f}",
            f"{two:.2f}",
            f"{one / two:.2f}",
            *(f"{each:.2f} s" for each in spent),
            f"{row['difference']:.1e}",
        )
    return table


def _targets(rows: list[dict[str, Any]]) -> Table:
    table = _new("aimed at", "quantity", "measured", "at most")
    for row in rows:
        style = "" if row["value"] <= row["limit"] else "yellow"
        table.add_row(row["name"], f"{row['value']:.3g} {row['unit']}", f"{row['limit']:g} {row['unit']}", style=style)
    return table
