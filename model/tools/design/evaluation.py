"""One evaluation: run the case with values for its unknowns, and keep the result in the journal under its key."""

import copy
import json
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cache
from typing import Any

import numpy as np
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.summary import summarise
from coilset.model.core.base.errors import CoilsetError, InputError
from coilset.model.core.case.settings import put
from coilset.model.core.material import library
from coilset.model.core.results.records.record import Result, Setup
from coilset.model.tools.design.conditions import Condition, without_limit
from coilset.model.tools.design.file import Design
from coilset.model.tools.design.surrogate import Guess, guess
from coilset.model.tools.sweep.evaluate import plain
from coilset.model.tools.sweep.keys import Keys

Plan = tuple[tuple[float, ...] | None, ...]
"""For each phase: the parts of it at which its steps end; None: automatic, or as in the case."""


@dataclass(frozen=True)
class Evaluation:
    """Result of a run.

    Attributes:
        x: values of the unknowns, shape (n,).
        values: of the conditions, shape (m,); NaN if the run failed.
        reason: why it failed; empty if it did not.
        plan: its steps.
        summary: its numbers and warnings, as in summary.json.
        seconds: its duration.
        wrong: whether such a spring cannot be built or run because its entries contradict each other.
    """

    x: np.ndarray
    values: np.ndarray
    reason: str
    plan: Plan
    summary: Mapping[str, Any]
    seconds: float
    wrong: bool = False

    @property
    def rough(self) -> bool:
        """Whether the error of its steps is larger than the case allows."""
        return any(warning["name"] == "step error" for warning in self.summary["warnings"])

    @property
    def failed(self) -> bool:
        """Whether there are no values."""
        return bool(self.reason)


class Evaluator:
    """Runs the case of a design with values for its unknowns.

    Args:
        conditions, data: see `coilset.model.tools.design.conditions.conditions`.
        known: records of earlier evaluations by their keys; those of other unknowns or conditions do not count.
        keep: writes the record of a new one.
        report: called with every Evaluation, and whether it came from the journal.
        threads: of each run.

    Attributes:
        names: of the unknowns in the file.
        named: the same in words, with their units.
        count: number of evaluations, and of those from the journal.
    """

    def __init__(
        self,
        design: Design,
        conditions: Sequence[Condition],
        data: Mapping[str, Any],
        known: Mapping[str, Mapping[str, Any]],
        keep: Callable[[dict[str, Any]], object],
        report: Callable[[Evaluation, bool], object],
        threads: int,
    ) -> None:
        self.design, self.conditions, self._data = design, conditions, data
        self.names = list(design.spec.find)
        self.named = [one.named(name, design.base) for name, one in design.spec.find.items()]
        self._subject = [*self.names, *(one.subject for one in conditions)]  # what `x` and `values` of a record are of
        self._known = {name: record for name, record in known.items() if record.get("of") == self._subject}
        self._keep, self._report = keep, report
        self._key, self._load = Keys(), cache(library.load)
        self.count, self.solves, self._threads = 0, 0, threads

    def data(self, x: np.ndarray, plan: Plan | None = None, others: Mapping[str, Any] | None = None) -> dict[str, Any]:
        """Raw data of the case.

        Args:
            x: values of the unknowns.
            plan: steps of its phases; None: as in the case.
            others: other entries, and their values.
        """
        data = copy.deepcopy(dict(self._data))
        for name, value in (others or {}).items():
            put(data, name, copy.deepcopy(value), f"trade_offs.{name}")
        for (name, unknown), value in zip(self.design.spec.find.items(), x, strict=True):
            unknown.put(name, float(value), data)
        program = data["loading"]
        for phase, marks in zip(program, plan or (None,) * len(program), strict=True):
            if marks is not None:
                phase["steps"] = list(marks)
        return data

    def guess(self, x: np.ndarray, others: Mapping[str, Any] | None = None) -> Guess:
        """The uniform rod's estimate; raises InputError if there is no such spring."""
        return guess(self.design.check(self.data(x, None, others)), self.conditions, self._load)

    def run(self, x: np.ndarray, plan: Plan | None = None) -> Evaluation:
        """Run it, or take its result from the journal."""
        x, self.count = np.array(x, float), self.count + 1
        began = time.perf_counter()
        try:
            case = self.design.check(self.data(x, plan))
            name = self._key(case)
        except InputError as error:
            found = self._failed(x, error, began)
            self._report(found, False)
            return found
        record, known = self._known.get(name), True
        if record is None:
            known, self.solves = False, self.solves + 1
            analysis = None
            try:
                analysis = Analysis(case, MPI.COMM_SELF, detailed=False, threads=self._threads, estimates=False)
                found = self._read(x, analysis.setup, analysis.run(), began)
            except CoilsetError as error:
                found = self._failed(x, error, began)
            del analysis
            status = "failed" if found.failed else "done"
            record = {"key": name, "status": status, "of": self._subject, **_plain(found)}
            self._keep(record)
            self._known[name] = json.loads(json.dumps(record))
        found = _of_record(self._known[name], x)
        self._report(found, known)
        return found

    def _failed(self, x: np.ndarray, error: CoilsetError, began: float) -> Evaluation:
        wrong, reason = isinstance(error, InputError), str(error)
        if isinstance(error, InputError) and error.place:
            reason = f"{self._own_place(error.place)}: {error.problem}"
        return Evaluation(x, np.full(1, np.nan), reason, (), {}, time.perf_counter() - began, wrong)

    def _own_place(self, place: str) -> str:
        """An entry of the case, or the design's own if that holds the same height."""
        heights = {
            f"loading.{one.phase}.to.height": f"{without_limit(one.name)}.height"
            for one in self.conditions
            if one.height
        }
        return heights.get(place, place)

    def _read(self, x: np.ndarray, setup: Setup, result: Result, began: float) -> Evaluation:
        summary = {name: plain(value) for name, value in summarise(setup, result).items()}
        values = [_read(one, summary, result) for one in self.conditions]
        phases = range(len(setup.phases))
        plan = tuple(tuple(step.progress for step in result.steps if step.phase == phase) for phase in phases)
        missing = [one.name for one, value in zip(self.conditions, values, strict=True) if value is None]
        reason = f"{missing[0]} is not a result of this run" if missing else ""
        return Evaluation(x, np.array(values, float), reason, plan, summary, time.perf_counter() - began)


def _read(condition: Condition, summary: Mapping[str, Any], result: Result) -> float | None:
    if condition.phase is None:
        return summary[condition.short_name]
    return [step for step in result.steps if step.phase == condition.phase][-1].force_N


def _plain(found: Evaluation) -> dict[str, Any]:
    values = [None if np.isnan(value) else float(value) for value in found.values]
    return asdict(found) | {"x": found.x.tolist(), "values": values}


def _of_record(record: Mapping[str, Any], x: np.ndarray) -> Evaluation:
    """The Evaluation in a line of the journal, of a case that these unknowns make."""
    values = np.array([np.nan if value is None else value for value in record["values"]])
    plan = tuple(tuple(marks) for marks in record["plan"])
    return Evaluation(x, values, record["reason"], plan, record["summary"], record["seconds"], record["wrong"])
