"""Kill runs at random moments, go on with --resume, and compare with runs that nobody disturbed, bit by bit.

    scripts/coilset python tests/faults/kills.py --kills 100
    scripts/coilset python tests/faults/kills.py --kills 30 --springs 7 43 58 106 194 25

A small spring with contact and friction, on one and on two ranks, a sweep, and a search for a design; with `--springs`
the random springs of these numbers instead, with fewer section points than usual. Each is killed
(`kill -9`) again and again, at a random moment after something new was kept, until it comes to its end; then it begins
anew. Says how often each was killed, what differed, and how many processes were left; exits 1 if there is anything of
either. Where two runs that nobody disturbs differ, as on two ranks where MUMPS adds what arrives first, numbers are to
agree to `AGREEMENT`, and how often was iterated does not count.
"""

import argparse
import csv
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import uuid
from pathlib import Path

import numpy as np
import yaml

from coilset.verification.random_springs.springs import random_spring

CASE = """
spring: {wire_diameter: 5.0, mean_diameter: 40.0, turns: 2.5, pitch: 12.0}
mesh: {elements_per_turn: 10, section: {rule: abramowitz9}}
contact: {friction: {seats: 0.1, coils: 0.1}}
loading:
  - {to: block, steps: 24}
  - {to: {force: 0}, steps: 12}
"""
SWEEP = """
case: case.yaml
change: {contact: {}, loading.0.steps: 4, loading.1.steps: 3}
vary: {spring.pitch: {from: 11, to: 13, count: 12}}
"""
DESIGN = """
spring: {wire_diameter: 5.0, mean_diameter: 40.0, turns: 2.5, pitch: 12.0}
mesh: {elements_per_turn: 8, section: {rule: abramowitz9}}
loading:
  - {to: {height: 20.0}}
  - {to: {force: 0}}
find: {loading.0.to.height: [18, 34], spring.wire_diameter: [4.5, 5.5]}
such_that: {free_length_after_mm: 25.0, force_at: {height: 21.0, N: 160.0}}
"""
JOURNALS = {"sweep": "journal.jsonl", "design": "evaluations.jsonl"}  # a line for each case
LONGEST = 0.5  # seconds after something was kept, at most, in which the kill comes
AGREEMENT = 1e-9  # of a quantity's largest magnitude, and absolutely, in N, mm and MPa
COUNTED = ("iterations", "evaluations", "failed_solves")  # work that takes another way where bits differ
WAIT = 120.0  # seconds for something to be kept
FEWER = {"section": {"kind": "curved", "radial": 3, "angular": 12}}  # of the random springs
SPRING = "random spring "  # with its number, the name of a run
COMMANDS = {
    "solve": ["solve", "case.yaml", "--no-pictures", "--out", "out"],
    "solve on 2 ranks": ["-n", "2", "solve", "case.yaml", "--no-pictures", "--out", "out"],
    "sweep": ["sweep", "sweep.yaml", "--no-pictures", "--jobs", "2", "--out", "out"],
    "design": ["design", "design.yaml", "--out", "out"],
}


class Running:
    """A command under way; all its processes carry a mark."""

    def __init__(self, words: list[str], folder: Path) -> None:
        self.mark = f"COILSET_MARK={uuid.uuid4()}"
        name, value = self.mark.split("=")
        with open(folder / "said.txt", "ab") as said:
            self.process = subprocess.Popen(
                [sys.executable, "-m", "coilset.scripts", *words],
                cwd=folder,
                stdout=said,
                stderr=said,
                stdin=subprocess.DEVNULL,
                env=os.environ | {name: value},
                start_new_session=True,
            )

    def left(self) -> list[int]:
        """Processes with the mark, those that have ended and wait to be noticed not counted."""
        found = []
        for folder in Path("/proc").glob("[0-9]*"):
            try:
                if self.mark.encode() in (folder / "environ").read_bytes().split(b"\0"):
                    found.append(int(folder.name))
            except OSError:
                continue
        return found

    def kill(self) -> list[int]:
        """Kill the outer process alone; the processes that are there five seconds later, which are killed, too."""
        os.kill(self.process.pid, signal.SIGKILL)
        self.process.wait()
        end = time.monotonic() + 5.0
        while (found := self.left()) and time.monotonic() < end:
            time.sleep(0.05)
        for number in found:
            os.kill(number, signal.SIGKILL)
        return found


def kept(folder: Path) -> tuple[float, int]:
    """When the state was kept last, and how long the journal is; zeros if nothing was kept."""
    state, journals = folder / "out" / "checkpoint" / "state.npz", (folder / "out" / name for name in JOURNALS.values())
    size = sum(journal.stat().st_size for journal in journals if journal.exists())
    return (state.stat().st_mtime if state.exists() else 0.0, size)


def to_the_end(name: str, folder: Path, kills: int, left: list[int]) -> int:
    """Run a command to its end with at most so many kills; how many there were."""
    begun, count = False, 0
    while True:
        before = kept(folder)
        running = Running([*words(name), *(["--resume"] if begun else [])], folder)
        until = time.monotonic() + WAIT
        while running.process.poll() is None and kept(folder) == before and time.monotonic() < until:
            time.sleep(0.005)
        if count < kills:
            time.sleep(random.uniform(0.0, LONGEST))
        else:
            running.process.wait()
        if running.process.poll() is not None:
            if running.process.returncode:
                raise RuntimeError((folder / "said.txt").read_text()[-2000:])
            return count
        left += running.kill()
        count, begun = count + 1, any(kept(folder))


def found(name: str, folder: Path) -> dict[str, object]:
    """What a run has found, without times and dates."""
    out = folder / "out"
    if name in JOURNALS:
        records = [json.loads(line) for line in (out / JOURNALS[name]).read_text().splitlines()]
        cases = {one["key"]: {entry: value for entry, value in one.items() if entry != "seconds"} for one in records}
        return cases | ({"found": (out / "found.yaml").read_text()} if name == "design" else {})
    tables = {}
    for path in ("history.csv", "seats.csv"):
        with open(out / path, encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        tables |= {f"{path} {column}": np.array([float(row[column] or "nan") for row in rows]) for column in rows[0]}
    summary = json.loads((out / "summary.json").read_text())
    with np.load(out / "checkpoint" / "state.npz") as state:
        numbers = state["state"]
    return {**tables, "state": numbers, **{entry: value for entry, value in summary.items() if entry != "origin"}}


def differing(wanted: dict[str, object], now: dict[str, object], to_the_bit: bool) -> set[str]:
    """Names of what two runs have found differently."""
    return {name for name in {*wanted, *now} if not same(name, wanted.get(name), now.get(name), to_the_bit)}


def same(name: str, one: object, other: object, to_the_bit: bool) -> bool:
    """Is it the same, bit by bit or to `AGREEMENT`?"""
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        if to_the_bit or one.shape != other.shape:
            return one.tobytes() == other.tobytes()
        tolerance = AGREEMENT * (1.0 + np.abs(one).max(initial=0.0, where=np.isfinite(one)))
        return name.endswith(COUNTED) or np.allclose(one, other, rtol=0.0, atol=tolerance, equal_nan=True)
    if not to_the_bit and isinstance(one, float) and isinstance(other, float):
        return abs(one - other) <= AGREEMENT * (1.0 + abs(one))
    return one == other or (not to_the_bit and name in (*COUNTED, "warnings"))  # warnings have numbers in their words


def words(name: str) -> list[str]:
    """Words of the command of a run."""
    return COMMANDS["solve"] if name.startswith(SPRING) else COMMANDS[name]


def fresh(folder: Path, name: str = "") -> Path:
    """An empty folder with the input files of a run."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    if name.startswith(SPRING):
        case = random_spring(int(name.removeprefix(SPRING))) | {"mesh": FEWER}
        (folder / "case.yaml").write_text(yaml.safe_dump(case))
        return folder
    (folder / "case.yaml").write_text(CASE)
    (folder / "sweep.yaml").write_text(SWEEP)
    (folder / "design.yaml").write_text(DESIGN)
    return folder


def main() -> int:
    """See the module."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", choices=COMMANDS, help="of the commands")
    parser.add_argument("--springs", type=int, nargs="+", help="numbers of random springs, instead of the commands")
    options = parser.parse_args()
    random.seed(options.seed)
    chosen = [options.only] if options.only else list(COMMANDS)
    chosen = [f"{SPRING}{number}" for number in options.springs] if options.springs else chosen
    bad, each = False, -(-options.kills // len(chosen))
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as place:
        for name in chosen:
            undisturbed = fresh(Path(place) / "undisturbed", name)
            to_the_end(name, undisturbed, 0, [])
            wanted = found(name, undisturbed)
            to_the_end(name, fresh(Path(place) / "again", name), 0, [])
            to_the_bit = not differing(wanted, found(name, Path(place) / "again"), True)
            count, ends, left, unlike = 0, 0, [], set()
            while count < each:
                folder = fresh(Path(place) / "killed", name)
                count += to_the_end(name, folder, each - count, left)
                now, ends = found(name, folder), ends + 1
                unlike |= differing(wanted, now, to_the_bit)
            bad = bad or bool(unlike or left)
            kind = "to the bit" if to_the_bit else f"to {AGREEMENT:g}, as undisturbed runs differ"
            print(
                f"{name}: {count} kills, {ends} times to the end; compared {kind}; differing: "
                f"{sorted(unlike) or 'nothing'}; processes left: {len(left)}",
                flush=True,
            )
    return int(bad)


if __name__ == "__main__":
    sys.exit(main())
