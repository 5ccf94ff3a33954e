"""A million presses of the uniform rod and 20,000 rods as one sweep, killed three times on the way: `coilset bench
--million`; a fraction of it for a try.
"""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

import yaml

from coilset.model.base.errors import CoilsetError
from coilset.model.run.examples import EXAMPLES
from coilset.model.sweep.journal import read_records

UNIFORM, RODS = 1_000_000, 20_000
KILLED_AT = (0.25, 0.5, 0.75)  # shares of all records at which the sweep is killed
LOOK_SECONDS = 0.2


@dataclass(frozen=True)
class Million:
    """What it took.

    Attributes:
        uniform, rods: number of cases of each model.
        run_seconds, collect_seconds: by the clock; the runs with their four starts.
        run_GiB, collect_GiB: largest resident memory of the leading process.
        repeated: records beyond one for each case, those in flight when the sweep was killed.
        journal_bytes, parquet_bytes: on disk, a case.
        failed: number of cases that failed.
    """

    uniform: int
    rods: int
    run_seconds: float
    collect_seconds: float
    run_GiB: float
    collect_GiB: float
    repeated: int
    journal_bytes: float
    parquet_bytes: float
    failed: int


def million(folder: Path, fraction: float, environment: Mapping[str, str], report: Callable[[str], object]) -> Million:
    """Run it.

    Args:
        folder: for the sweep file and its results; a new one.
        fraction: of the whole.
        environment: of the commands.
        report: called with a line before each stage.

    Raises:
        CoilsetError: a command failed, or a case is missing or there twice.
    """
    uniform, rods = max(round(fraction * UNIFORM), 100), max(round(fraction * RODS), 10)
    plan, out = folder / "million.yaml", folder / "million"
    plan.write_text(yaml.safe_dump(_plan(uniform, rods)), encoding="utf-8")
    began = time.perf_counter()
    sweep = [sys.executable, "-m", "coilset.scripts", "sweep", str(plan), "--no-pictures", "--out", str(out)]
    command = [*sweep, "--resume"]
    journal = out / "journal.jsonl"
    for share in KILLED_AT:
        report(f"until {share:.0%} of {uniform:,} presses and {rods:,} rods, then killed")
        _killed(command, environment, journal, round(share * (uniform + rods)))
    report("the rest")
    peak = _checked(command, environment)
    run_seconds = time.perf_counter() - began
    report("collected once more, alone")
    began = time.perf_counter()
    collect_peak = _checked([*sweep, "--collect"], environment)
    collect_seconds = time.perf_counter() - began
    keys: dict[str, str] = {}
    count = 0
    for record in read_records(journal):
        count += 1
        keys[record["key"]] = record["status"]
    if len(keys) != uniform + rods:
        raise CoilsetError(f"{journal}: has {len(keys)} cases instead of {uniform + rods}")
    found = Million(
        uniform,
        rods,
        run_seconds,
        collect_seconds,
        peak / 2**20,
        collect_peak / 2**20,
        count - len(keys),
        journal.stat().st_size / len(keys),
        (out / "sweep.parquet").stat().st_size / len(keys),
        sum(status == "failed" for status in keys.values()),
    )
    (folder / "million.json").write_text(json.dumps(asdict(found), indent=1) + "\n", encoding="utf-8")
    return found


def _plan(uniform: int, rods: int) -> dict[str, object]:
    return {
        "case": str(EXAMPLES / "ck15_presetting.yaml"),
        "change": {"mesh.section.radial": 5, "mesh.section.angular": 12, "solver.tolerance": 1e-5},
        "model": "uniform_rod",
        "rods": rods,
        "vary": {
            "spring.wire_diameter": {"mean": 5.0, "tolerance": 0.05},
            "spring.mean_diameter": {"mean": 40.0, "tolerance": 0.5},
            "spring.pitch": {"mean": 12.0, "tolerance": 0.3},
        },
        "design": "random",
        "samples": uniform,
        "seed": 1,
    }


def _killed(command: list[str], environment: Mapping[str, str], journal: Path, records: int) -> None:
    """Start the sweep, and kill it and its workers when the journal has so many records."""
    with subprocess.Popen(
        command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, start_new_session=True
    ) as process:
        found = read = 0
        while process.poll() is None and found < records:
            time.sleep(LOOK_SECONDS)
            lines, read = _lines(journal, read)
            found += lines
        if process.poll() not in (None, 0, 3):
            assert process.stderr is not None
            raise CoilsetError(f"{' '.join(command)}: {process.stderr.read().decode(errors='replace').strip()}")
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)


def _lines(path: Path, start: int) -> tuple[int, int]:
    """Number of lines that end behind a place in a file, in bytes, and where the file ends; 0 if there is none."""
    if not path.exists():
        return 0, 0
    with open(path, "rb") as file:
        file.seek(start)
        return sum(chunk.count(b"\n") for chunk in iter(lambda: file.read(1 << 24), b"")), file.tell()


def _checked(command: list[str], environment: Mapping[str, str]) -> int:
    """Run a command to its end; the largest resident memory of it alone, KiB."""
    process = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    assert process.stderr is not None
    said = process.stderr.read().decode(errors="replace").strip()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    process.stderr.close()
    if process.returncode not in (0, 3):  # 3: some cases failed, which are counted
        raise CoilsetError(f"{' '.join(command)}: {said}")
    return usage.ru_maxrss
