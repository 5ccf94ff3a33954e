"""`coilset solve`: read, run, write, draw, and print the results."""

import contextlib
import logging
import os
import time
from collections.abc import Sequence
from pathlib import Path

from mpi4py import MPI

from coilset.model.base.agreement import on_first_rank
from coilset.model.base.errors import CoilsetError, InputError, SolveError, naming
from coilset.model.case import Case, read_case
from coilset.model.results.files.checkpoint import Checkpoint
from coilset.model.results.files.folder import DRAWN, RESULTS, clear, prepare
from coilset.model.results.records.provenance import origin
from coilset.model.results.records.record import Step
from coilset.model.results.records.summary import summarise
from coilset.model.results.run_files import write_run
from coilset.model.run.analysis import Analysis
from coilset.model.run.refinement import within_accuracy
from coilset.model.runtime.threads import usual
from coilset.scripts.compiling import compile_first
from coilset.scripts.interrupt import Interrupt
from coilset.scripts.terminal.drawing import Drawings
from coilset.scripts.terminal.interactive import Prompt
from coilset.scripts.terminal.log import run_log
from coilset.scripts.terminal.progress import VOICES, Lines
from coilset.scripts.terminal.target import results_folder

log = logging.getLogger("coilset.steps")
STARTED = float(os.environ.get("COILSET_STARTED", time.time()))


def solve(
    case_file: str | Path,
    out: str | Path | None,
    force: bool,
    settings: Sequence[str],
    pictures: bool,
    resume: bool = False,
    interactive: bool = False,
    comm: MPI.Comm = MPI.COMM_WORLD,
    drawings: Drawings | None = None,
    voice: str = "lines",
    verbose: bool = False,
    threads: int | None = None,
) -> None:
    """Run one case; see `coilset solve --help`. Drawings draws the pictures, `VOICES` are the ways to print a run.

    Raises:
        InputError, SolveError: after the results so far are written.
    """
    telling = VOICES[voice](comm.rank == 0, verbose)
    if interactive and comm.size > 1:
        raise InputError("works on one rank only; omit -n", "--interactive")
    if interactive and voice != "lines":
        raise InputError(f"shows each step, and --{voice} does not; give one of the two", "--interactive")
    case = read_case(case_file, settings)
    folder = results_folder(out, Path(case_file).stem)
    with contextlib.ExitStack() as stack:
        interrupt = stack.enter_context(Interrupt(comm, telling.say))
        with naming(case_file):
            analysis = Analysis(case, comm, threads=threads or usual(comm.size))
        if analysis.law.creep is not None:
            compile_first(stages=("creep",))
        on_first_rank(comm, lambda: _prepare(folder, analysis.case, force, resume))
        on_first_rank(comm, lambda: _begin(stack.enter_context(run_log(folder)), folder, force, resume))
        drawings = (drawings or stack.enter_context(Drawings(os.environ))) if pictures else None
        _solve(telling, analysis, case_file, folder, drawings, resume, interactive, interrupt)


def _prepare(folder: Path, case: Case, force: bool, resume: bool) -> None:
    if resume:
        if force:
            raise InputError("continues a run, and --overwrite discards it; give one of the two", "--resume")
        Checkpoint(folder, case).require()
    prepare(folder, force or resume)


def _begin(log: logging.FileHandler, out: Path, force: bool, resume: bool) -> None:
    """Remove everything of an earlier run from the folder, except what is to be continued.

    Pictures of `coilset mesh` may be of this spring, made before it is solved; where results are replaced, they go.
    """
    if not resume:
        assert log.stream is not None  # it is opened in advance
        log.stream.truncate(0)
        clear(out, RESULTS + DRAWN if force else RESULTS)


def _solve(
    telling: Lines,
    first: Analysis,
    case_file: str | Path,
    out: Path,
    drawings: Drawings | None,
    resume: bool,
    interactive: bool,
    interrupt: Interrupt,
) -> None:
    began, runs, failure = time.perf_counter(), _Runs(telling, case_file, out, resume, interactive, interrupt), None
    analysis = first
    try:
        analysis = runs(first) if interactive else within_accuracy(first, runs)
    except (SolveError, KeyboardInterrupt) as error:
        failure, analysis = error, runs.best
    comm = analysis.comm
    interrupt.over()
    analysed = time.perf_counter() - began
    summary = comm.bcast(summarise(analysis.setup, analysis.result) if comm.rank == 0 else None)
    on_first_rank(comm, lambda: write_run(out, analysis.setup, analysis.result, summary, origin(analysis.case)))
    telling.conclude(summary, out)
    for warning in summary["warnings"]:
        log.warning("warning: %s: %s", warning["name"], warning["message"])
    if drawings:
        try:
            on_first_rank(comm, lambda: _draw(drawings, out, telling))
        except CoilsetError as error:
            if failure is None:
                raise
            telling.warn(str(error))
    telling.say(f"analysis {analysed:.2f} s, all {time.time() - STARTED:.2f} s")
    if failure is not None:
        if analysis.result.steps:
            telling.say("continue from the last step with --resume")
        raise failure


class _Runs:
    """Runs the analyses of a case, the first and the finer ones, each with its checkpoint.

    Attributes:
        best: the last one whose results are to be written: the finest complete one, or the first.
    """

    def __init__(
        self,
        telling: Lines,
        case_file: str | Path,
        out: Path,
        resume: bool,
        interactive: bool,
        interrupt: Interrupt,
    ) -> None:
        self._telling, self._case_file, self._out = telling, case_file, out
        self._resume, self._interactive, self._interrupt = resume, interactive, interrupt
        self._number = 0

    def __call__(self, analysis: Analysis, finer: str = "") -> Analysis:
        """Run one; `finer` says what is finer than before.

        Raises:
            SolveError, KeyboardInterrupt: as Analysis.run.
        """
        comm, telling, checkpoint = analysis.comm, self._telling, Checkpoint(self._out, analysis.case, self._number)
        if not self._number:
            self.best = analysis
            if self._resume:
                analysis.resume(checkpoint.load(comm))
            telling.begin(analysis, self._case_file, self._resume)
        else:
            if self._resume and comm.bcast(checkpoint.exists()):
                try:
                    analysis.resume(checkpoint.load(comm))
                except InputError as error:  # the case has changed since, and with it what must be finer
                    log.info("the finer run is not continued: %s", error)
            telling.again(analysis, finer)
        self._number += 1
        ask = Prompt(analysis, telling.say) if self._interactive else None

        def report(step: Step) -> None:
            telling.step(step)
            self._interrupt.check()
            if ask:
                ask(step)

        try:
            with telling.iterations():
                analysis.run(report, checkpoint.save, self._interrupt.check)
        finally:
            if comm.rank == 0:
                checkpoint.over()
        self.best = analysis
        return analysis


def _draw(drawings: Drawings, out: Path, telling: Lines) -> None:
    for warning in drawings.draw(out):
        telling.warn(warning)
