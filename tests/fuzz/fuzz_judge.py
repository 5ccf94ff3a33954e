"""What holds for every input, right or wrong: one line and exit code 2, soon, and not for much memory."""

import resource
import time
from collections.abc import Callable
from functools import cache
from typing import Any

from fuzz_schema import breaches

from coilset.model.base.errors import InputError
from coilset.model.base.yaml import load_yaml, read_data
from coilset.model.case import Case, check
from coilset.model.case.targets import check_targets
from coilset.model.material import library, programs
from coilset.model.material.law.file import MaterialFile
from coilset.model.material.programs import Program
from coilset.model.run.effort import Effort
from coilset.model.standards.case_warnings import case_warnings
from coilset.model.standards.wires.law import case_law
from coilset.model.sweep.plan import Plan
from coilset.model.sweep.spec import SweepSpec

SLOWEST = 2.0  # seconds of the processor for a refusal
LARGEST = 2**30  # bytes that a file may add to the memory of the process
LONGEST = 500  # characters of a line, without the paths in it


def read_case(path: str) -> None:
    """All that a command looks at before it works."""
    case = check(read_data(path, "a case file"), path)
    spring = case.spring.build()
    law = case_law(case, spring)
    check_targets(case, spring, law.G)
    turns = spring.stations(case.mesh.elements_per_turn, case.mesh.sagitta)
    rule = case.section_rule
    Effort.of(len(turns) - 1, 2 * len(rule), 1).check_memory(LARGEST)
    case_warnings(case, spring, law)
    if case.temperature is not None:
        law.known(case.temperature)


READERS: dict[str, tuple[Callable[[str], Any], type]] = {
    "case": (read_case, Case),
    "material": (library.load, MaterialFile),
    "program": (programs.read, Program),
    "sweep": (Plan, SweepSpec),
}


def judge(kind: str, path: str, text: str) -> None:
    """Read a file, and fail for anything but data that keep the reference, or a refusal in one short line."""
    reader, model = READERS[kind]
    before, began = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, time.process_time()
    try:
        reader(path)
        refusal = None
    except InputError as error:
        refusal = str(error)
    took, after = time.process_time() - began, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    assert 1024 * (after - before) < LARGEST, "takes too much memory"
    if refusal is not None:
        assert took < SLOWEST, f"refused after {took:.1f} s: {refusal[:200]}"
        check_line(refusal.replace(path, "FILE"))
    else:
        schema = reference(model)
        assert breaches(load_yaml(text), schema, schema.get("$defs", {})) == []


@cache
def reference(model: type) -> dict[str, Any]:
    """What the reference page is made of; it takes as long to make as several files to read."""
    return model.model_json_schema()


def check_line(line: str) -> None:
    """One short line, for people: no object of the program's, no name of an exception."""
    assert "\n" not in line
    assert line.isprintable() or "\t" in line
    assert len(line) < LONGEST, f"{len(line)} characters: {line[:200]}"
    for word in ("Traceback", "object at 0x", "ValidationError", "pydantic", "NoneType", "<class"):
        assert word not in line, line
