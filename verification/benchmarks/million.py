"""A million presses of the uniform rod and 20,000 rods as one sweep, killed three times on the way: `coilset bench
--million`; a fraction of it for a try. Where it was interrupted itself, the same command carries on.
"""

import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

import yaml

from coilset.model.compose.examples import EXAMPLES
from coilset.model.core.base.errors import CoilsetError, InputError
from coilset.model.core.results.files.folder import whole
from coilset.model.core.runtime.processes import end_with_parent
from coilset.model.tools.sweep.journal import read_records

UNIFORM, RODS = 1_000_000, 20_000
KILLED_AT = (0.25, 0.5, 0.75)  # shares of all records at which the sweep is killed
LOOK_SECONDS, KEEP_SECONDS = 0.2, 10.0
FILES = ("million.yaml", "million.json", "progress.json")


@dataclass(frozen=True)
class Million:
    """What it took.

    Attributes:
        uniform, rods: number of cases of each model.
        run_seconds, collect_seconds: by the clock; the runs with all their starts.
        run_GiB, collect_GiB: largest resident memory of the leading process.
        carried_on: how often the bench was interrupted and carried on.
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
    carried_on: int
    repeated: int
    journal_bytes: float
    parquet_bytes: float
    failed: int


@dataclass
class Progress:
    """What an interrupted bench leaves to the one that carries on.

    Attributes:
        passed: number of shares at which the sweep has been killed.
        seconds: of its runs so far, by the clock.
        carried_on: see Million.
    """

    passed: int = 0
    seconds: float = 0.0
    carried_on: int = 0

    def keep(self, path: Path) -> None:
        """Write it."""
        with whole(path) as partial:
            partial.write_text(json.dumps(asdict(self)), encoding="utf-8")


def interrupted(folder: Path, fraction: float) -> Progress | None:
    """Of the run in a folder, None if there is none or it has ended.

    Raises:
        InputError: it is one of another fraction, or of another checkout's case.
    """
    plan, kept = folder / "million.yaml", folder / "progress.json"
    if not kept.exists() or not plan.exists():
        return None
    if plan.read_text(encoding="utf-8") != _plan(*_numbers(fraction)):
        raise InputError(
            "holds an interrupted run of another fraction or checkout; remove it, or give another folder",
            "--out",
            folder,
        )
    return Progress(**json.loads(kept.read_text(encoding="utf-8")))


def million(
    folder: Path,
    fraction: float,
    environment: Mapping[str, str],
    report: Callable[[str], object],
    before: Progress | None = None,
) -> Million:
    """Run it.

    Args:
        folder: for the sweep file and its results; a new one, but to carry on.
        fraction: of the whole.
        environment: of the commands.
        report: called with a line before each stage.
        before: of the `interrupted` run that this one carries on.

    Raises:
        CoilsetError: a command failed, or a case is missing or there twice.
    """
    uniform, rods = _numbers(fraction)
    plan, out, kept = folder / "million.yaml", folder / "million", folder / "progress.json"
    plan.write_text(_plan(uniform, rods), encoding="utf-8")
    progress = before or Progress(carried_on=-1)
    progress.carried_on += 1
    progress.keep(kept)
    sweep = [sys.executable, "-m", "coilset.scripts", "sweep", str(plan), "--no-pictures", "--out", str(out)]
    command, records = [*sweep, "--resume"], _Lines(out / "journal.jsonl")
    watch = _Watch(progress, kept)
    for number, share in enumerate(KILLED_AT[progress.passed :], progress.passed + 1):
        report(f"until {share:.0%} of {uniform:,} presses and {rods:,} rods, then killed")
        records.enough = round(share * (uniform + rods))
        _run(command, environment, lambda: watch.look() or records.reached())
        progress.passed = number
        watch.keep()
    report("the rest")
    peak = _run(command, environment, watch.look)
    watch.keep()
    report("collected once more, alone")
    began = time.perf_counter()
    collect_peak = _run([*sweep, "--collect"], environment)
    collect_seconds = time.perf_counter() - began
    keys: dict[str, str] = {}
    count = 0
    for record in read_records(records.path):
        count += 1
        keys[record["key"]] = record["status"]
    if len(keys) != uniform + rods:
        raise CoilsetError(f"{records.path}: has {len(keys)} cases instead of {uniform + rods}")
    found = Million(
        uniform,
        rods,
        progress.seconds,
        collect_seconds,
        peak / 2**20,
        collect_peak / 2**20,
        progress.carried_on,
        count - len(keys),
        records.path.stat().st_size / len(keys),
        (out / "sweep.parquet").stat().st_size / len(keys),
        sum(status == "failed" for status in keys.values()),
    )
    (folder / "million.json").write_text(json.dumps(asdict(found), indent=1) + "\n", encoding="utf-8")
    kept.unlink()
    return found


def _numbers(fraction: float) -> tuple[int, int]:
    """Of uniform rods and of rods."""
    return max(round(fraction * UNIFORM), 100), max(round(fraction * RODS), 10)


def _plan(uniform: int, rods: int) -> str:
    """Its sweep file."""
    content = {
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
    return yaml.safe_dump(content)


class _Watch:
    """Adds the time that passes to the progress, and keeps it."""

    def __init__(self, progress: Progress, path: Path) -> None:
        self.progress, self.path, self.last = progress, path, time.perf_counter()

    def look(self) -> bool:
        """Keep it, if that is due; never a reason to kill."""
        if time.perf_counter() - self.last > KEEP_SECONDS:
            self.keep()
        return False

    def keep(self) -> None:
        """Keep it now."""
        now = time.perf_counter()
        self.progress.seconds, self.last = self.progress.seconds + now - self.last, now
        self.progress.keep(self.path)


class _Lines:
    """Counts the lines of a growing file, which may not be there yet, and reads each once."""

    def __init__(self, path: Path) -> None:
        self.path, self.enough, self._found, self._read = path, 0, 0, 0

    def reached(self) -> bool:
        """Whether there are `enough`."""
        if self.path.exists():
            with open(self.path, "rb") as file:
                file.seek(self._read)
                self._found += sum(chunk.count(b"\n") for chunk in iter(lambda: file.read(1 << 24), b""))
                self._read = file.tell()
        return self._found >= self.enough


def _run(command: list[str], environment: Mapping[str, str], enough: Callable[[], bool] = lambda: False) -> int:
    """Run a command to its end, or kill it and its workers once it is `enough`; its largest resident memory, KiB."""
    with tempfile.TemporaryFile() as said:
        process = subprocess.Popen(
            command,
            env=environment,
            stdout=subprocess.DEVNULL,
            stderr=said,
            start_new_session=True,
            preexec_fn=end_with_parent,
        )
        killed = False
        while not (ended := os.wait4(process.pid, os.WNOHANG))[0]:
            time.sleep(LOOK_SECONDS)
            if not killed and enough():
                os.killpg(process.pid, signal.SIGKILL)
                killed = True
        process.returncode = os.waitstatus_to_exitcode(ended[1])
        if process.returncode not in (0, 3) and not killed:  # 3: some cases failed, which are counted
            said.seek(0)
            raise CoilsetError(f"{' '.join(command)}: {said.read().decode(errors='replace').strip()}")
        return ended[2].ru_maxrss
