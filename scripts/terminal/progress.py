"""Output of a run while it is in progress: lines to read, lines of JSON, or only warnings."""

import contextlib
import json
import logging
import os
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.table import Table
from rich.text import Text

from coilset.model.compose.analysis import Analysis
from coilset.model.core.case.phases import drives_at
from coilset.model.core.contact.base import SEAT_DOFS
from coilset.model.core.results.order_of_warnings import messages_in_order
from coilset.model.core.results.quantities import quantities
from coilset.model.core.results.records.labels import lives_text, within
from coilset.model.core.results.records.record import ContactRecord, SeatReactions, Step
from coilset.scripts.terminal.console import Console, styled, table

if TYPE_CHECKING:  # not where a rod is solved, or without checks
    from coilset.model.physics.slice.analysis import SliceStep
    from coilset.model.tools.checks.check import Check

PRESSED = f"{'step':>5}{'height/mm':>10}{'force/N':>12}"
HEAD = f"{PRESSED}{'iter.':>6}"  # of `step_row`
TURNED = f"{PRESSED}{'turn/°':>9}{'torque/N mm':>13}{'iter.':>6}"  # of a spring that is turned, too
TURN = 5  # the freedom of a head about the axis, of SEAT_DOFS
SOON = 5.0  # seconds; with less elapsed or left, the remaining time is not printed
LATER = 20.0  # seconds, before the first line of progress where it is not a terminal
OFTEN = 1.0  # seconds, at least, from one row to the next within a phase
SPARSE = 0.1  # of the time since the beginning, likewise


class Lines:
    """One line of progress, then the answer: checks, numbers, and warnings; colours on a terminal only.

    On a terminal the line is written over and over; elsewhere another one follows as the time doubles.

    Args:
        talks: False on ranks that print nothing.
    """

    def __init__(self, talks: bool = True) -> None:
        self.console = Console(quiet=not talks)
        self._began, self._from = 0.0, -1.0  # when and where the first step ended; below 0 before
        self._start = self._said = time.monotonic()  # when the first run began, and progress was last printed
        self._open = False  # whether a line of progress is to be written over

    def say(self, text: str) -> None:
        """A line about the run."""
        self.progress_ends()
        self.console.say(text)

    def warn(self, text: str) -> None:
        """A warning."""
        self.progress_ends()
        self.console.warn(text)

    def begin(self, analysis: Analysis, case_file: str | Path, resumed: bool) -> None:
        """The run begins or continues."""
        self.analysis, self._from, self._start = analysis, -1.0, time.monotonic()
        self._said = self._start
        targets = ", ".join(phase.label for phase in analysis.case.loading)
        elements, ranks = len(analysis.setup.turns) - 1, analysis.comm.size
        self.say(f"{Path(case_file).name}: {elements} elements, to {targets}{f', {ranks} ranks' * (ranks > 1)}")
        if resumed and _done(analysis) >= 1.0:
            self.say(f"all {analysis.continuation.number} steps are there: only the results are written again")
        elif resumed:
            self.say(f"continuing after step {analysis.continuation.number}")

    def again(self, analysis: Analysis, finer: str) -> None:
        """A finer run of the same case begins or continues; `finer` names what is finer."""
        self.analysis, self._from = analysis, -1.0
        self.say(f"the estimated error exceeds the accuracy: again with {finer}")

    def step(self, step: Step) -> None:
        """A step has been found."""
        self.progress(f"{step_words(step)}{self._left(step)}")

    def progress(self, text: str) -> None:
        """The line of progress: in place of the one before on a terminal, elsewhere if it is time for another one."""
        now = time.monotonic()
        if self.console.is_terminal and not self.console.quiet:
            self.console.file.write(f"\r\x1b[2K{text[: self.console.width - 1]}")
            self.console.file.flush()
            self._open = True
        elif now - self._start > max(LATER, 2.0 * (self._said - self._start)):
            self._said = now
            self.console.print(text, soft_wrap=True)

    def progress_ends(self) -> None:
        """Remove the line of progress."""
        if self._open:
            self.console.file.write("\r\x1b[2K")
            self._open = False

    def _left(self, step: Step) -> str:
        """Remaining time at the speed since the first step, which may compile; empty if it is short, or unknown."""
        done = _done(self.analysis, step)
        if self._from < 0.0:
            self._began, self._from = time.monotonic(), done
        spent = time.monotonic() - self._began
        left = spent * (1.0 - done) / max(done - self._from, 1e-9)
        return "" if spent < SOON or left < SOON else f"  {duration(left)} left"

    def iterations(self) -> contextlib.AbstractContextManager[None]:
        """Context of the iterations of a run."""
        return contextlib.nullcontext()

    def conclude(self, summary: Mapping[str, Any], made: "Sequence[Check]", out: Path) -> None:
        """Print the results and the checks of the spring; warnings last, the most important one first."""
        self._answer(summary, made)
        self.console.say(f"  results in {out}{os.sep}", whole=True)
        for message in messages_in_order(summary):
            self.warn(message)

    def _answer(self, summary: Mapping[str, Any], made: "Sequence[Check]") -> None:
        self.progress_ends()
        if made:
            from coilset.scripts.terminal.checks import check_lines  # only where their package is

            check_lines(self.console, made)
        self.console.quantities(quantities(summary))
        if summary["working"]:
            self.console.print(working_table(summary["working"]))
        if summary["fatigue"]:
            self.console.print(fatigue_table(summary["fatigue"]))


class Steps(Lines):
    """A line for each phase, and for steps in between as time passes.

    Attributes:
        every: whether each step has its line.
    """

    every = False

    def __init__(self, talks: bool = True) -> None:
        super().__init__(talks)
        self._turned = False  # whether the load program turns a head
        self._unsaid: Step | None = None  # the last step, if it has no row

    def begin(self, analysis: Analysis, case_file: str | Path, resumed: bool) -> None:
        """The run begins or continues."""
        super().begin(analysis, case_file, resumed)
        if _done(analysis) < 1.0:
            self._head()

    def again(self, analysis: Analysis, finer: str) -> None:
        """A finer run of the same case begins or continues; `finer` names what is finer."""
        super().again(analysis, finer)
        self._unsaid = None
        self._head()

    def _head(self) -> None:
        """The head of the steps, whose rows fit in 80 columns."""
        loading = self.analysis.case.loading
        self._turned = any(drive.freedom % SEAT_DOFS == TURN for drive in drives_at(loading, len(loading) - 1))
        self.say(f"{TURNED if self._turned else HEAD}{'points':>7}  contacts")
        self._said = time.monotonic()

    def step(self, step: Step) -> None:
        """A step has been found."""
        waiting, self._unsaid = self._left(step), step
        if self.every or step.progress >= 1.0 or step.left_branch or self._is_due():
            self._print(step, waiting)

    def _print(self, step: Step, waiting: str = "") -> None:
        """The row of a step, with the time that is left."""
        self._said, self._unsaid = time.monotonic(), None
        cuts, left = f"  {step.cuts} cut{'s' * (step.cuts > 1)}" if step.cuts else "", ""
        if step.left_branch:
            left = "  snapped" if step.released_energy_Nmm else "  left its path"
        touching = contact_words(self.analysis.setup.contacts, self.analysis.result.seats)
        row = f"{self._row(step)}{step.contacts:7d}  {touching}{cuts}"
        self.console.print(Text.assemble(row, (left, "yellow"), (waiting, "dim")), soft_wrap=True)

    def _is_due(self) -> bool:
        """Whether the last row is so long ago that another one is wanted."""
        now = time.monotonic()
        return now - self._said > max(OFTEN, SPARSE * (now - self._start))

    def _row(self, step: Step) -> str:
        if not self._turned:
            return step_row(step)
        return f"{_pressed(step)}{step.turn_deg:z9.2f}{step.torque_Nmm:z13.1f}{step.iterations:6d}"

    def conclude(self, summary: Mapping[str, Any], made: "Sequence[Check]", out: Path) -> None:
        """Print the results, after the last step of a run that ended early."""
        if self._unsaid is not None:
            self._print(self._unsaid)
        super().conclude(summary, made, out)


class Verbose(Steps):
    """A line for each step and each iteration."""

    every = True

    @contextlib.contextmanager
    def iterations(self) -> Iterator[None]:
        """Context in which each iteration is printed."""
        if self.console.quiet:
            yield
            return
        log, handler = logging.getLogger("coilset.iterations"), _Handler(self.console)
        log.setLevel(logging.DEBUG)
        log.addHandler(handler)
        try:
            yield
        finally:
            log.removeHandler(handler)
            log.setLevel(logging.NOTSET)


class Quiet(Lines):
    """The answer alone."""

    def say(self, text: str) -> None:
        """Nothing."""

    def warn(self, text: str) -> None:
        """Nothing."""

    def step(self, step: Step) -> None:
        """Nothing."""

    def conclude(self, summary: Mapping[str, Any], made: "Sequence[Check]", out: Path) -> None:
        """The checks and the numbers."""
        self._answer(summary, made)


class Silent(Quiet):
    """Nothing at all."""

    def conclude(self, summary: Mapping[str, Any], made: "Sequence[Check]", out: Path) -> None:
        """Nothing."""


class JsonLines(Lines):
    """A line of JSON for each event, named by its `event`: begin, step, warning, end."""

    def _put(self, event: str, **entries: Any) -> None:
        if not self.console.quiet:
            print(json.dumps({"event": event, **entries}, ensure_ascii=False), flush=True, file=sys.stdout)

    def say(self, text: str) -> None:
        """Nothing that a script would read."""

    def warn(self, text: str) -> None:
        """A warning."""
        self._put("warning", message=text)

    def begin(self, analysis: Analysis, case_file: str | Path, resumed: bool) -> None:
        """The case, its mesh and its load program."""
        super().begin(analysis, case_file, resumed)
        for warning in analysis.setup.warnings:
            self.warn(warning.message)
        self._put(
            "begin",
            case=Path(case_file).name,
            elements=len(analysis.setup.turns) - 1,
            resumed=resumed,
            loading=[phase.label for phase in analysis.case.loading],
            ranks=analysis.comm.size,
        )

    def again(self, analysis: Analysis, finer: str) -> None:
        """A finer run of the same case."""
        super().again(analysis, finer)
        self._put("again", finer=finer, elements=len(analysis.setup.turns) - 1)

    def step(self, step: Step) -> None:
        """The step's row of history.csv, the contacts, and the completed part of the load program."""
        touching = contact_words(self.analysis.setup.contacts, self.analysis.result.seats)
        self._put("step", **asdict(step), touching=touching, done=_done(self.analysis, step))

    def conclude(self, summary: Mapping[str, Any], made: "Sequence[Check]", out: Path) -> None:
        """The summary, as in summary.json, and the checks."""
        checks = [asdict(one) | {"verdict": one.verdict.value, "reserve": one.reserve} for one in made]
        self._put("end", folder=str(out), summary=dict(summary), checks=checks)


VOICES = {"lines": Lines, "steps": Steps, "verbose": Verbose, "quiet": Quiet, "json": JsonLines, "silent": Silent}


def duration(seconds: float) -> str:
    """A time in one or two digits: 40 s, 3 min, 2.5 h."""
    if seconds < 100.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 6000.0 else f"{seconds / 3600.0:.1f} h"


def _done(analysis: Analysis, step: Step | None = None) -> float:
    """Completed part of the load program; all phases count equally."""
    if step is None:
        step = analysis.result.steps[-1] if analysis.result.steps else None
    return 0.0 if step is None else (step.phase + step.progress) / len(analysis.case.loading)


def step_row(step: "Step | SliceStep") -> str:
    """The columns common to the steps of rod and slice, under HEAD."""
    return f"{_pressed(step)}{step.iterations:6d}"


def _pressed(step: "Step | SliceStep") -> str:
    return f"{step.number:5d}{step.seat_height_mm:10.4f}{step.force_N:z12.3f}"


def with_decimals(value: float | None, unit: str, digits: int = 4) -> str:
    """A value with its unit; `none` where the run gave none, as of a spring that was not released."""
    return "none" if value is None else f"{value:z.{digits}f} {unit}"


def step_words(step: Step) -> str:
    """A step in a line of progress."""
    return f"step {step.number}, {step.seat_height_mm:.5g} mm, {abs(step.force_N):.5g} N"


def working_table(states: Sequence[Mapping[str, Any]]) -> Table:
    """The working states of summary.json, a row each; rate in N/mm, stresses in MPa, the true one at the inside."""
    made = table(("length, mm", "force, N", "rate", "τ", "τk", "true", "turn", "safety"), left=0, padding=1)
    for state in states:
        if state["reason"]:
            wanted = state.get("length_wanted", state.get("force_wanted"))
            place = (f"{wanted:g}", "-") if "length_wanted" in state else ("-", f"{wanted:g}")
            made.add_row(*place)
            continue
        is_length = "length_wanted" in state
        error = state["estimated_error"]
        force = within(abs(state["force_N"]), error if is_length else None, "", 2).strip()
        length = within(state["length_mm"], None if is_length else error, "", 3).strip()
        numbers = [state[name] for name in ("shear_MPa", "corrected_shear_MPa", "shear_inside_MPa")]
        made.add_row(
            length,
            force,
            with_decimals(state["rate_N_per_mm"], "", 3).strip(),
            *("-" if number is None else f"{abs(number):.0f}" for number in numbers),
            f"{state['shear_inside_turn']:.2f}",
            "-" if state["safety"] is None else f"{state['safety']:.2f}",
        )
    return made


def fatigue_table(entries: Sequence[Mapping[str, Any]]) -> Table:
    """Fatigue by each criterion, of summary.json, a row each; stresses in MPa."""
    made = table(("fatigue by", "MPa", "endured", "safety", "turn", "angle", "lives 10, 50, 90 %"), left=0, padding=1)
    for one in entries:
        numbers = (f"{one[name]:.0f}" for name in ("amplitude_MPa", "endured_MPa"))
        place = f"{one['safety']:.2f}", f"{one['turn']:.2f}", f"{one['angle_deg']:z.0f}°"
        made.add_row(one["criterion"], *numbers, *place, lives_text(one["lives"], "-"))
    return made


def contact_words(kinds: Sequence[ContactRecord], reactions: Sequence[SeatReactions]) -> str:
    """Which kinds of contact press on the wire now: `both seats, coils`, `bottom seat`, or `no contact`.

    Args:
        kinds: of the Setup.
        reactions: up to now; none if they are not recorded, and then the words are empty.
    """
    if not reactions:
        return ""
    pressure = reactions[-1].pressure
    names = [kinds[number].name for number in sorted({int(row[0]) for row in pressure if row[2] > 0.0})]
    if {"bottom seat", "top seat"} <= set(names):
        names = ["both seats", *(name for name in names if not name.endswith(" seat"))]
    return ", ".join(names) or "no contact"


class _Handler(logging.Handler):
    def __init__(self, console: Console) -> None:
        super().__init__()
        self.console = console

    def emit(self, record: logging.LogRecord) -> None:
        """Print it, fainter than the steps."""
        self.console.print(styled("dim", record.getMessage()), soft_wrap=True)
