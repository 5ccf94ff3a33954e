"""`coilset solve`: read, run, write, draw, and print the results."""

import contextlib
import logging
import os
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mpi4py import MPI

from coilset.model.compose.analysis import Analysis, run_within_accuracy
from coilset.model.compose.run_files import write_run
from coilset.model.compose.summary import summarise
from coilset.model.core.base.agreement import on_first_rank
from coilset.model.core.base.errors import CoilsetError, InputError, SolveError, naming
from coilset.model.core.base.package import optional
from coilset.model.core.case import Case, read_case
from coilset.model.core.results.files.checkpoint import Checkpoint
from coilset.model.core.results.files.folder import DRAWN, RESULTS, clear, prepare
from coilset.model.core.results.records.provenance import origin
from coilset.model.core.results.records.record import Step
from coilset.model.core.runtime.threads import usual
from coilset.scripts.compiling import compile_first
from coilset.scripts.interrupt import Interrupt
from coilset.scripts.terminal.drawing import Drawings
from coilset.scripts.terminal.interactive import Prompt
from coilset.scripts.terminal.log import run_log
from coilset.scripts.terminal.progress import VOICES, Lines
from coilset.scripts.terminal.target import results_folder

if TYPE_CHECKING:
    from coilset.model.tools.checks.check import Check

log = logging.getLogger("coilset.steps")
try:
    STARTED = float(os.environ["COILSET_STARTED"])  # s, by scripts/coilset
except (KeyError, ValueError):
    STARTED = time.time()


def solve(
    case_file: str | Path,
    out: str | Path | None,
    force: bool,
    settings: Sequence[str],
    *,
    drawings: Drawings | None = None,
    resume: bool = False,
    interactive: bool = False,
    voice: str = "lines",
    threads: int | None = None,
    comm: MPI.Comm = MPI.COMM_WORLD,
) -> None:
    """Run one case; see `coilset solve --help`. Drawings draws the pictures, if any; `voice` is one of VOICES.

    Raises:
        InputError, SolveError: after the results so far are written.
    """
    voice = "verbose" if interactive and voice == "lines" else voice
    output = VOICES[voice](comm.rank == 0)
    if interactive and comm.size > 1:
        raise InputError("works on one rank only; omit -n", "--interactive")
    if interactive and voice in ("quiet", "json"):
        raise InputError(f"shows each step, and --{voice} does not; give one of the two", "--interactive")
    case = read_case(case_file, settings)
    folder = results_folder(out, Path(case_file).stem)
    with contextlib.ExitStack() as stack:
        interrupt = stack.enter_context(Interrupt(comm, output.say))
        with naming(case_file):
            analysis = Analysis(case, comm, threads=threads or usual(comm.size))
        if analysis.law.data.creep is not None:
            compile_first(stages=("creep",))
        on_first_rank(comm, lambda: _prepare(folder, analysis.case, force, resume))
        on_first_rank(comm, lambda: stack.enter_context(run_log(folder, goes_on=resume)))
        if not resume:  # pictures of `coilset mesh` may be of this spring; where results are replaced, they go
            on_first_rank(comm, lambda: clear(folder, RESULTS + DRAWN if force else RESULTS))
        _solve(analysis, _Runs(output, case_file, folder, resume, interactive, interrupt), drawings)


def _prepare(folder: Path, case: Case, force: bool, resume: bool) -> None:
    if resume:
        if force:
            raise InputError("continues a run, and --overwrite discards it; give one of the two", "--resume")
        Checkpoint(folder, case).require()
    prepare(folder, force or resume)


def _checks(analysis: Analysis, summary: dict[str, Any]) -> "list[Check]":
    """Of the spring and its run; none of a run without steps, or where their package is missing."""
    table = optional("coilset.model.tools.checks.table")
    records = optional("coilset.model.tools.sheet.from_results")
    if table is None or records is None or not analysis.result.steps:
        return []
    return table.checks(analysis.case, analysis.spring, records.of_steps(summary, analysis.result.steps))


@dataclass
class _Runs:
    """Runs the analyses of a case, the first and the finer ones, each with its checkpoint.

    Attributes:
        best: the last one whose results are to be written: the finest complete one, or the first.
    """

    output: Lines
    case_file: str | Path
    folder: Path
    resume: bool
    interactive: bool
    interrupt: Interrupt
    best: Analysis = field(init=False)
    number: int = 0

    def __call__(self, analysis: Analysis, finer: str = "") -> Analysis:
        """Run one; `finer` names what is finer than before.

        Raises:
            SolveError, KeyboardInterrupt: as Analysis.run.
        """
        comm, output, checkpoint = analysis.comm, self.output, Checkpoint(self.folder, analysis.case, self.number)
        if not self.number:
            self.best = analysis
            if self.resume:
                analysis.resume(checkpoint.load(comm))
            output.begin(analysis, self.case_file, self.resume)
        else:
            if self.resume and comm.bcast(checkpoint.exists()):
                try:
                    analysis.resume(checkpoint.load(comm))
                except InputError as error:  # the case has changed since, and with it what must be finer
                    log.info("the finer run is not continued: %s", error)
            output.again(analysis, finer)
        self.number += 1
        ask = Prompt(analysis, output.say) if self.interactive else None

        def report(step: Step) -> None:
            output.step(step)
            self.interrupt.check()
            if ask:
                ask(step)

        with output.iterations():
            analysis.run(report, checkpoint.save, self.interrupt.check)
        self.best = analysis
        return analysis


def _solve(first: Analysis, runs: _Runs, drawings: Drawings | None) -> None:
    """Run an analysis, and finer ones if need be; write, print and draw the results."""
    began, failure, output, folder = time.perf_counter(), None, runs.output, runs.folder
    try:
        analysis = runs(first) if runs.interactive else run_within_accuracy(first, runs)
    except (SolveError, KeyboardInterrupt) as error:
        failure, analysis = error, runs.best
        if runs.interrupt.stopped() and isinstance(error, SolveError):  # a step that was to be finished, and failed
            output.say(str(error))
            failure = KeyboardInterrupt()
    comm = analysis.comm
    runs.interrupt.over()
    analysed = time.perf_counter() - began
    summary = comm.bcast(summarise(analysis.setup, analysis.result) if comm.rank == 0 else None)
    setup, result = analysis.setup, analysis.result
    lacking = on_first_rank(comm, lambda: write_run(folder, setup, result, summary, origin(analysis.case)))
    output.conclude(summary, _checks(analysis, summary) if comm.rank == 0 else [], folder)
    for problem in lacking or ():
        output.warn(problem)
    for warning in summary["warnings"]:
        log.warning("warning: %s: %s", warning["name"], warning["message"])
    if drawings and analysis.result.steps and not runs.interrupt.hurries:  # without steps there is nothing to draw
        try:
            for problem in on_first_rank(comm, lambda: drawings.draw(folder)) or ():
                output.warn(problem)
        except CoilsetError as error:
            if failure is None:
                raise
            output.warn(str(error))
    output.say(f"analysis {analysed:.2f} s, all {time.time() - STARTED:.2f} s")
    if failure is not None:
        if analysis.result.steps:
            output.say("continue from the last step with --resume")
        raise failure
