"""The plan of a sweep: its cases as data, checked, and a key for each that says whether it has been run already."""

import copy
import hashlib
import json
from functools import lru_cache
from pathlib import Path

from coilset.model.case import check
from coilset.model.case.settings import put
from coilset.model.case.yaml import read_data
from coilset.model.errors import InputError
from coilset.model.material import library
from coilset.model.sweep.design import rows
from coilset.model.sweep.spec import SweepSpec

KEY_BYTES = 12


class Plan:
    """A sweep file, read and checked, and its cases.

    Args:
        path: the sweep file.

    Attributes:
        spec: SweepSpec.
        case_path: file of the base case, from whose folder other files count.
        names: names of the inputs.
        rows: values of the inputs, a tuple a case.
        keys: key of each case: a digest of all its entries and of its material's constants.

    Raises:
        InputError: if a file cannot be read, or a case breaks the schema; one line with file, place and value.
    """

    def __init__(self, path):
        self.path = Path(path)
        kind = "a sweep file holds the entries case: and vary:"
        self.spec = check(read_data(path, kind=kind), path, SweepSpec)
        self.case_path = self.path.parent / self.spec.case
        self.base = read_data(self.case_path)
        try:
            for entry, value in self.spec.change.items():
                put(self.base, entry, value, f"change.{entry}")
            self.names = list(self.spec.vary)
            self.base_values = {name: self._base_value(name) for name in self.names}
            self.rows = rows(self.spec, self.base_values)
            self.keys = [self._key(row) for row in self.rows]
        except InputError as error:
            raise InputError(error.problem, error.place, error.file or path) from None

    def __len__(self):
        return len(self.rows)

    def entries(self, name):
        """Paths of the entries that an input sets."""
        return self.spec.vary[name].entries or [name]

    def _base_value(self, name):
        """The base case's value of an input, None if the base case leaves it out."""
        value = self.base
        for part in self.entries(name)[0].split("."):
            try:
                value = value[int(part)] if isinstance(value, list) else value[part]
            except (KeyError, IndexError, ValueError, TypeError):
                if self.spec.design == "one_at_a_time":
                    raise InputError("one_at_a_time needs this entry in the base case (or in change:)", name) from None
                return None
        return value

    def task(self, row):
        """What is needed to run a case: its raw data, the base case's file, and the time limit."""
        return {"data": self.data(row), "file": str(self.case_path), "time_limit": self.spec.time_limit}

    def data(self, row):
        """The raw data of one case, as a case file would hold it."""
        data = copy.deepcopy(self.base)
        for name, value in zip(self.names, row, strict=True):
            for entry in self.entries(name):
                put(data, entry, copy.deepcopy(value), f"vary.{name}")
        return data

    def _key(self, row):
        try:
            case = check(self.data(row), self.case_path)
        except InputError as error:
            inputs = ", ".join(f"{name} = {value}" for name, value in zip(self.names, row, strict=True))
            raise InputError(f"{error.problem} (in the case {inputs})", error.place) from None
        content = case.model_dump(mode="json")
        content["material"] = material_digest(case.material)
        if "file" in content["spring"]:
            content["spring"]["file"] = file_digest(Path(content["spring"]["file"]))
        content = json.dumps(content, sort_keys=True)
        return hashlib.blake2b(content.encode(), digest_size=KEY_BYTES).hexdigest()


@lru_cache
def material_digest(name):
    """Digest of a material's constants, so that a changed material file makes new cases."""
    return hashlib.blake2b(library.load(name).parameters().tobytes(), digest_size=KEY_BYTES).hexdigest()


@lru_cache
def file_digest(path):
    """Digest of a file; that of nothing if it cannot be read, which its case will complain of."""
    try:
        return hashlib.blake2b(path.read_bytes(), digest_size=KEY_BYTES).hexdigest()
    except OSError:
        return ""
