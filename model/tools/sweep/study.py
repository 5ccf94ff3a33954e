"""Ask and tell: a sweep whose cases another program chooses, such as Optuna, SALib or OpenTURNS."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import xarray as xr

from coilset.model.core.base.errors import InputError
from coilset.model.core.case import check
from coilset.model.core.results.files.folder import make
from coilset.model.core.runtime.processes import usable_cores
from coilset.model.tools.sweep import dataset
from coilset.model.tools.sweep.engines.processes import Workers
from coilset.model.tools.sweep.journal import Journal
from coilset.model.tools.sweep.keys import Keys
from coilset.model.tools.sweep.plan import Plan
from coilset.model.tools.sweep.run import finished, missing, run


@dataclass(frozen=True)
class Trial:
    """A case to be computed.

    Attributes:
        key: digest that identifies the case and its results.
        inputs: value of each input by its name.
        data: the case, as a case file holds it.
    """

    key: str
    inputs: dict[str, Any]
    data: dict[str, Any]


class Study:
    """A plan whose cases are handed out and whose results are handed in, in any order and in several processes' turns.

    Args:
        plan: the sweep file, or its entries; its inputs name what may be varied.
        folder: of the sweep, where a journal keeps each result; made if necessary.

    Raises:
        InputError: a file is wrong, or another process writes to the folder.
    """

    def __init__(self, plan: str | Path | Mapping[str, Any], folder: str | Path) -> None:
        self.plan, self.folder = Plan(plan), Path(folder)
        make(self.folder)
        self._journal = Journal(self.folder / "journal.jsonl")
        self._done, self._keys = set(finished(self.folder, retry=False)), Keys()
        self._asked: set[str] = set()
        self._extra: list[tuple[tuple[Any, ...], str]] = []

    def ask(self, n: int = 1, values: Sequence[Mapping[str, float]] | None = None) -> list[Trial]:
        """The next cases: of the plan those that nobody has computed or requested, or those with given inputs.

        Args:
            n: number of cases of the plan; fewer are returned at its end.
            values: inputs of each case by their names, all of them, in place of those of the plan.

        Raises:
            InputError: an input is missing or unknown, or a case cannot be.
        """
        if values is None:
            rows = [(row, key) for row, key, _ in self.plan.work(missing(self.plan, self._done | self._asked)[:n])]
        else:
            rows = [self._given(inputs) for inputs in values]
            self._extra += rows
        self._asked |= {key for _row, key in rows}
        return [Trial(key, dict(zip(self.plan.names, row, strict=True)), self.plan.data(row)) for row, key in rows]

    def _given(self, inputs: Mapping[str, float]) -> tuple[tuple[Any, ...], str]:
        if set(inputs) != set(self.plan.names):
            raise InputError(f"has the inputs {', '.join(inputs)}; the plan has {', '.join(self.plan.names)}", "values")
        row = tuple(inputs[name] for name in self.plan.names)
        return row, self._keys(check(self.plan.data(row), self.plan.case_path), self.plan.spec.model)

    def tell(self, key: str, summary: Mapping[str, Any] | None, reason: str = "") -> None:
        """Keep the result of a case.

        Args:
            key: of its Trial.
            summary: its numbers, as in summary.json; None if it failed.
            reason: why it failed.
        """
        failed = {"status": "failed", "reason": reason or "no result", "summary": {}}
        record = failed if summary is None else {"status": "done", "reason": "", "summary": dict(summary)}
        self._journal.append({"key": key, **record, "steps": {}, "seconds": None})
        self._done.add(key)

    def evaluate(self, trials: Sequence[Trial], jobs: int | None = None) -> list[dict[str, Any] | None]:
        """Compute cases in processes of this machine and keep their results; the summary of each, None if it failed.

        A case whose result is there already is computed again.
        """
        found: dict[str, dict[str, Any]] = {}
        todo = [(tuple(trial.inputs.values()), trial.key, self.plan.spec.model) for trial in trials]
        with (
            Workers(min(jobs or usable_cores(), max(len(todo), 1)), dict(os.environ)) as workers,
            workers.pool(self.folder / "workers.log") as pool,
        ):
            run(self.plan, todo, pool, self._journal, lambda record: found.update({record["key"]: record}))
        self._done |= found.keys()
        records = [found[trial.key] for trial in trials]
        return [record["summary"] if record["status"] == "done" else None for record in records]

    def results(self) -> xr.Dataset:
        """All cases of the plan, and those given by `values`, as `sweep` returns them."""
        self.plan.add(self._extra)
        self._extra = []
        return dataset.collect(self.plan, self.folder)

    def close(self) -> None:
        """Release the folder."""
        self._journal.close()
