"""The plan of a sweep: its cases as checked data, and a key for each that identifies its results."""

import copy
import hashlib
import json
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from coilset.model.core.base.entry import check_entries, shown
from coilset.model.core.base.errors import InputError, naming
from coilset.model.core.base.yaml import read_data
from coilset.model.core.case import Case, check, read_case_data
from coilset.model.core.case.settings import located, put, value_at
from coilset.model.core.results.files.folder import whole
from coilset.model.tools.sweep.design import rows
from coilset.model.tools.sweep.engines.pool import Task
from coilset.model.tools.sweep.keys import Keys, Model, as_rod
from coilset.model.tools.sweep.packed import Row, Strings
from coilset.model.tools.sweep.rehearsal import Rehearsal
from coilset.model.tools.sweep.shards import WHOLE, Shard
from coilset.model.tools.sweep.spec import SweepSpec

Work = tuple[Row, str, Model]  # inputs, key and model of what is to be computed


class Plan:
    """A sweep file, read and checked, and its cases.

    Args:
        path: the sweep file, or its entries; paths in these count from the working directory.
        kept: a file with the keys as `keep` wrote them; if it is that of this plan, the cases are not checked again,
            which takes 0.3 ms each.
        shard: only its cases are checked, and those of the others have empty keys, unless `kept` has them.

    Attributes:
        spec: SweepSpec.
        case_path: file of the base case. Paths in it are relative to its folder; paths in the sweep file, to the
            folder of the sweep file.
        names: names of the inputs.
        rows: values of the inputs, one tuple per case.
        keys: key of each case: a digest of all its entries and of its material's constants.
        notices: for the user, about entries of the cases, one line each.

    Raises:
        InputError: if a file cannot be read, a case violates the schema, or no case can be built with a value of an
            input; one line with file, place and value.
    """

    def __init__(self, path: str | Path | Mapping[str, Any], kept: Path | None = None, shard: Shard = WHOLE) -> None:
        if isinstance(path, Mapping):
            data, self.path = copy.deepcopy(dict(path)), Path("sweep")
        else:
            data, self.path = read_data(path, "a sweep file holds the entries case: and vary:"), Path(path)
        self.spec = check_entries(data, SweepSpec, self.path)
        self.case_path = self.path.parent / self.spec.case
        self.base = read_case_data(self.case_path)
        self.names = list(self.spec.vary)
        with naming(self.path):
            for entry, value in self.spec.change.items():
                put(self.base, entry, self._located(entry, value), f"change.{entry}")
            self.base_values = {name: self._base_value(name) for name in self.names}
            self.rows = rows(self.spec, self.base_values)
            self.notices: list[str] = []
            self._sources: list[int] = []  # the first case of each material and file
            self.keys = (kept and self._kept(kept)) or Strings(self._check_cases(shard))

    def __len__(self) -> int:
        return len(self.rows)

    def entries(self, name: str) -> list[str]:
        """Paths of the entries that an input sets."""
        return self.spec.vary[name].entries or [name]

    @property
    def task_keys(self) -> np.ndarray:
        """Keys of everything to compute, as bytes: each case by the sweep's model, then `rods` of them by rods."""
        cases = self.keys.array
        return np.concatenate([cases, np.char.rstrip(cases[: self.spec.rods], b"u")]) if self.spec.rods else cases

    def work(self, numbers: Iterable[int]) -> Iterator[Work]:
        """Some of what is to be computed, by its numbers in the order of `task_keys`."""
        for number in numbers:
            again, case = divmod(int(number), len(self))
            key = self.keys[case]
            yield self.rows[case], as_rod(key) if again else key, "rod" if again else self.spec.model

    def add(self, cases: Iterable[tuple[Row, str]]) -> None:
        """Append cases that are not of the design: inputs and keys."""
        for row, key in cases:
            if key not in self.keys:
                self.rows.added.append(row)
                self.keys.add(key)

    def task(self, row: Row, key: str, model: Model = "rod") -> Task:
        """The task of running a case: arguments of `evaluate`."""
        file, limit = str(self.case_path), self.spec.time_limit
        found = {"data": self.data(row), "file": file, "time_limit": limit, "key": key, "model": model}
        return found | {"estimates": not self.spec.rods}  # rods that correct uniform ones are compared with these

    def data(self, row: Row) -> dict[str, Any]:
        """The raw data of one case, as in a case file."""
        data = copy.deepcopy(self.base)
        for name, value in zip(self.names, row, strict=True):
            for entry in self.entries(name):
                put(data, entry, self._located(entry, copy.deepcopy(value)), f"vary.{name}")
        return data

    def _located(self, entry: str, value: Any) -> Any:
        return located(entry, value, self.path.parent.absolute())

    def _base_value(self, name: str) -> Any:
        """The base case's value of an input, None if it is left out there."""
        value = value_at(self.base, self.entries(name)[0], missing := object())
        if value is not missing:
            return value
        if self.spec.design == "one_at_a_time":
            raise InputError("one_at_a_time needs this entry in the base case (or in change:)", name)
        return None

    def _check_cases(self, shard: Shard) -> Iterator[str]:
        """The keys, one after the other; empty those of other shards."""
        rehearsal, keys, own = Rehearsal(self.spec), Keys(), shard.cases(len(self))
        for number, row in enumerate(self.rows):
            if number not in own:
                yield ""
                continue
            case, before = self._checked(row), keys.sources
            self.notices = self.notices or list(case.notices())
            rehearsal.try_case(row, case)
            yield keys(case, self.spec.model)
            if keys.sources > before:
                self._sources.append(number)
        if shard.count == 1:  # a value may be right in the cases of another shard only
            rehearsal.conclude()

    def _checked(self, row: Row) -> Case:
        try:
            return check(self.data(row), self.case_path)
        except InputError as error:
            inputs = ", ".join(f"{name} = {shown(value)}" for name, value in zip(self.names, row, strict=True))
            raise InputError(f"{error.problem} (in the case {inputs})", error.place) from None

    def keep(self, path: Path) -> None:
        """Write the keys for later commands.

        Raises:
            CoilsetError: if the file cannot be written.
        """
        if not path.exists() or self._kept(path) is None:
            with whole(path) as partial:
                np.savez(
                    partial,
                    recipe=self._recipe(),
                    keys=self.keys.array,
                    notices=np.array(self.notices, dtype=str),
                    sources=self._sources,
                )

    def _kept(self, path: Path) -> Strings | None:
        """The keys of a file, if it is of this plan, and the cases that first name a material or file still have
        theirs: it has not changed since, nor has the program."""
        try:
            with np.load(path) as file:
                if str(file["recipe"]) != self._recipe():
                    return None
                keys, notices, sources = Strings(file["keys"]), file["notices"].tolist(), file["sources"].tolist()
        except (OSError, ValueError, LookupError, TypeError, BadZipFile):
            return None
        fresh = Keys()
        if any(fresh(self._checked(self.rows[number]), self.spec.model) != keys[number] for number in sources):
            return None
        self.notices, self._sources = notices, sources
        return keys

    def _recipe(self) -> str:
        """Digest of what the cases are made of."""
        folders = [str(path.parent.absolute()) for path in (self.path, self.case_path)]
        spec = self.spec.model_dump(mode="json", exclude={"figures"})
        made_of = json.dumps([spec, self.base, folders], sort_keys=True, default=str)
        return hashlib.blake2b(made_of.encode() + self.rows.content()).hexdigest()
