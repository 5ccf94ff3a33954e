"""Runs the measurements, each in a process of its own, and brings them together in one record."""

import functools
import os
import platform
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from coilset.model.runtime.processes import folder_of_mpirun, mpi_settings, mpirun, usable_cores
from coilset.verification.benchmarks.everyday import everyday, launchers, walks
from coilset.verification.benchmarks.process import read_json
from coilset.verification.benchmarks.ranks import compare
from coilset.verification.benchmarks.target import targets

MODULE = "coilset.verification.benchmarks.measure"
QUICK = ((40, 5), (400, 3), (4_000, 2), (16_000, 1))  # elements, and how often they are measured
UNESTIMATED = 100_000  # elements that are also measured without the error of the step
FULL = ((40, 5), (400, 5), (4_000, 3), (16_000, 2), (40_000, 1), (100_000, 1), (400_000, 1))
SHARED = {"quick": 8_000, "full": 40_000}  # elements that one and two ranks are compared on
RANKS = (1, 2)
CASES = {"quick": 20, "full": 100}
OPENSEES = ((40, 0), (40, 1), (320, 0))  # elements, and whether coilset's axis is curved


def measure(environment: dict[str, str], job: str, *arguments: int, ranks: int = 1) -> dict[str, Any]:
    """One measurement.

    Args:
        environment: of the process, from before MPI.
        job, arguments: see coilset.verification.benchmarks.measure.
        ranks: under mpirun if there are more than one.

    Raises:
        CoilsetError: if the process failed.
    """
    command = [sys.executable, "-m", MODULE, job, *map(str, arguments)]
    if ranks > 1:
        command = [*mpirun(ranks), *command]
    with folder_of_mpirun() as folder:
        name = f"the measurement '{' '.join(map(str, (job, *arguments)))}'"
        return read_json(command, name, mpi_settings() | environment | folder)


def cold(environment: dict[str, str]) -> dict[str, Any]:
    """The example with nothing compiled yet: forms and kernels are built in a folder that is thrown away."""
    with tempfile.TemporaryDirectory() as folder:
        return measure(environment | {"XDG_CACHE_HOME": folder, "NUMBA_CACHE_DIR": folder}, "example", 1)


def bench(
    full: bool,
    with_cold: bool,
    environment: dict[str, str],
    report: Callable[[str], object],
    against: Path | None = None,
) -> dict[str, Any]:
    """All measurements.

    Args:
        full: up to 400,000 elements, which needs 10 GiB and a quarter of an hour; otherwise up to 16,000.
        with_cold: also time the compilers.
        environment: of the processes, from before MPI.
        report: called with the name of each measurement before it begins.
        against: another checkout, whose commands and walks are timed beside this one's.

    Returns:
        The record: plain data for JSON.
    """
    size = "full" if full else "quick"
    record: dict[str, Any] = {"machine": machine()}
    starts = launchers(against)
    report("commands")
    record["commands"] = everyday(starts, environment)
    report("walks")
    record["walks"] = walks(starts, environment)
    report("example")
    record["example"] = measure(environment, "example", 5)
    if with_cold:
        report("example, nothing compiled")
        record["cold"] = cold(environment)
    record["elements"], record["unestimated"] = [], []
    for elements, repeats in FULL if full else QUICK:
        report(f"{elements} elements")
        record["elements"].append(measure(environment, "press", elements, repeats))
        if elements == UNESTIMATED:
            report(f"{elements} elements, error not estimated")
            record["unestimated"].append(measure(environment, "press", elements, repeats, 0, 0))
    record["ranks"] = []
    for ranks in RANKS:
        report(f"{ranks} rank(s)")
        record["ranks"].append(measure(environment, "press", SHARED[size], 2, ranks=ranks))  # the first one warms up
    record["one_and_two_ranks"] = compare(functools.partial(measure, environment), size, report)
    report("cases")
    record["cases"] = measure(environment, "cases", CASES[size])
    record["opensees"] = []
    for elements, curved in OPENSEES:
        report(f"OpenSees, {elements} elements")
        record["opensees"].append(measure(environment, "opensees", elements, curved))
    record["load_after"] = os.getloadavg()[0]
    record["targets"] = targets(record)
    return record


def machine() -> dict[str, Any]:
    """What it runs on, and how busy that is."""
    model = platform.processor() or platform.machine()
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            model = next(line.split(":", 1)[1].strip() for line in file if line.startswith("model name"))
    except (OSError, StopIteration):
        pass
    return {"processor": model, "cores": usable_cores(), "load": os.getloadavg()[0]}
