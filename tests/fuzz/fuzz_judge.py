"""What holds for every input, right or wrong: one line and exit code 2, soon, and not for much memory."""

import resource
import time
from collections import Counter
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from fuzz_files import EXAMPLES
from fuzz_schema import breaches
from mpi4py import MPI

from coilset.meshes.measured.measured import MeasuredSpec
from coilset.model.compose.build import build_wire
from coilset.model.core.base.columns import read_columns
from coilset.model.core.base.errors import CoilsetError, InputError
from coilset.model.core.base.yaml import load_yaml, read_data
from coilset.model.core.case import Case, check
from coilset.model.core.case import read_case as case_of
from coilset.model.core.case.material import case_law
from coilset.model.core.case.targets import check_targets
from coilset.model.core.material import library
from coilset.model.core.material.law.file import MaterialFile
from coilset.model.core.results.files.checkpoint import Checkpoint
from coilset.model.core.results.files.labelled import labelled
from coilset.model.physics.accuracy.effort import Effort
from coilset.model.physics.vibration.lift import read_lift
from coilset.model.tools.design.file import DesignFile, read_design_file
from coilset.model.tools.identification import programs
from coilset.model.tools.identification.elastic_part import TESTER, check_elastic, corrected
from coilset.model.tools.identification.experiments import read_test
from coilset.model.tools.identification.programs import Program
from coilset.model.tools.identification.relaxation_tests import read_relaxation
from coilset.model.tools.limits.case_warnings import case_warnings
from coilset.model.tools.nest.file import NestFile, read_nest
from coilset.model.tools.spring_fit.pressing import read_pressing
from coilset.model.tools.sweep.journal import read_records
from coilset.model.tools.sweep.plan import Plan
from coilset.model.tools.sweep.spec import SweepSpec
from coilset.scripts.commands.report import report
from coilset.scripts.commands.sheet import Options, sheet
from coilset.verification.comparison import _checked

SLOWEST = 2.0  # seconds of the processor for a refusal
DRAWN = 10.0  # of a page, whose last figure may be the one that meets the damage
LARGEST = 2**30  # bytes that a file may add to the memory of the process
LONGEST = 500  # characters of a line, without the paths in it
SMALL = 20_000  # section points of a wire that is built
PROGRAM = Program.model_validate(
    {
        "name": "torsion and release",
        "steps": [{"to": {"gamma12": 0.03}, "increments": 6}, {"to": {"tau12": 0.0}, "increments": 2}],
    }
)
COUNTED: Counter[str] = Counter()  # how many files of a kind were read, or refused


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
    if (len(turns) - 1) * len(rule) < SMALL:
        build_wire(case, spring, law, MPI.COMM_SELF, 1)


def read_material(path: str) -> None:
    """A material, and what it does at a point in torsion."""
    law = library.load(path)
    programs.run(law, PROGRAM)


def read_experiment(path: str) -> None:
    """A test of wire as `material fit` reads it."""
    test = read_test(path)
    corrected(test, 84000.0, 0.29, {}, tuple(TESTER))
    check_elastic(test, 84000.0, 0.29)
    read_test(path, engineering=True)


def read_results(folder: str) -> None:
    """A results folder as `coilset.open`, `sheet --results` and `--resume` read it."""
    case = Path(folder) / "case.yaml"
    refused(labelled, folder)
    refused(lambda folder: sheet(case, Options(results=folder, pictures=False)), folder)
    Checkpoint(folder, case_of(case)).load(MPI.COMM_SELF)


def refused(read: Callable[[str], Any], path: str) -> CoilsetError | None:
    """The error that refuses a file in one line, None if it is read."""
    try:
        with np.errstate(all="ignore"):
            read(path)
    except CoilsetError as error:
        check_line(str(error).replace(path, "FILE"))
        return error
    return None


READERS: dict[str, tuple[Callable[[str], Any], type | None]] = {
    "case": (read_case, Case),
    "material": (read_material, MaterialFile),
    "program": (programs.read, Program),
    "sweep": (Plan, SweepSpec),
    "design": (read_design_file, DesignFile),
    "nest": (read_nest, NestFile),
    "measured": (lambda path: MeasuredSpec(file=path).build(), None),
    "test": (read_experiment, None),
    "press": (lambda path: read_pressing(path, case_of(EXAMPLES / "material" / "springs" / "spring.yaml")), None),
    "compare": (lambda path: _checked(read_columns(path), False), None),
    "relaxation": (read_relaxation, None),
    "motion": (read_lift, None),
    "journal": (lambda path: list(read_records(path)), None),
    "results": (read_results, None),
    "page": (report, None),
}


def judge(kind: str, path: str, text: str = "") -> None:
    """Read a file, and fail for anything but data that keep the reference, or a refusal in one short line."""
    reader, model = READERS[kind]
    before, began = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, time.process_time()
    refusal = refused(reader, path)
    took, after = time.process_time() - began, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    assert 1024 * (after - before) < LARGEST, "takes too much memory"
    COUNTED[f"{kind} {'read' if refusal is None else 'refused'}"] += 1
    if isinstance(refusal, InputError):
        assert took < (DRAWN if kind == "page" else SLOWEST), f"refused after {took:.1f} s: {refusal}"
    elif refusal is None and model is not None:
        own = {name: value for name, value in load_yaml(text).items() if kind != "design" or name in model.model_fields}
        schema = reference(model)
        assert breaches(own, schema, schema.get("$defs", {})) == []


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
