"""Kill runs at random moments, go on with --resume, and compare with runs that nobody disturbed, bit by bit.

    scripts/coilset python tests/faults/kills.py --kills 100
    scripts/coilset python tests/faults/kills.py --kills 30 --springs 7 43 58 106 194 25

A small spring with contact and friction, on one and on two ranks, one that is run again finer, a sweep, a search for a
design, a nest and a page; with `--springs` the random springs of these numbers instead, with fewer section points than
usual. Each is killed (`kill -9`) again and again, at a random moment after something new was kept, until it comes to
its end; then it begins anew. What keeps nothing is killed at any moment, and begins from the start. Says how often each
was killed, what differed, files that were left unfinished, and how many processes were left; exits 1 if there is
anything of these. Where two runs that nobody disturbs differ, as on two ranks where MUMPS adds what arrives first,
numbers are to agree to `AGREEMENT`, and how often was iterated does not count.
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
from dataclasses import dataclass, field
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
FINER = """
spring: {wire_diameter: 5.0, mean_diameter: 40.0, turns: 2.5, pitch: 12.0}
mesh: {section: {radial: 4, angular: 12}}
loading: [{to: block}, {to: {force: 0}}]
"""
OF_NEST = """
spring: {wire_diameter: DIAMETER, mean_diameter: MEAN, turns: 3.5, pitch: 8.0, hand: HAND}
mesh: {elements_per_turn: 8, section: {rule: abramowitz9}}
accuracy: 0.1
loading: [{to: block}]
"""
NEST = """
outer: {case: outer.yaml}
inner: {case: inner.yaml}
loading: [{to: {height: 20}, steps: 8}]
"""
JOURNALS = {"sweep": "journal.jsonl", "design": "evaluations.jsonl"}  # a line for each case
LONGEST = 0.5  # seconds after something was kept, at most, in which the kill comes
AGREEMENT = 1e-9  # of a quantity's largest magnitude, and absolutely, in N, mm and MPa
COUNTED = ("iterations", "evaluations", "failed_solves")  # work that takes another way where bits differ
MOST = 2  # kills before an end, of what keeps nothing and would never come to it
WAIT = 120.0  # seconds for something to be kept
FEWER = {"section": {"kind": "curved", "radial": 3, "angular": 12}}  # of the random springs
SPRING = "random spring "  # with its number, the name of a run
COMMANDS = {
    "solve": ["solve", "case.yaml", "--no-pictures", "--out", "out"],
    "solve on 2 ranks": ["-n", "2", "solve", "case.yaml", "--no-pictures", "--out", "out"],
    "finer run": ["solve", "finer.yaml", "--no-pictures", "--out", "out"],
    "sweep": ["sweep", "sweep.yaml", "--no-pictures", "--jobs", "2", "--out", "out"],
    "design": ["design", "design.yaml", "--out", "out"],
    "nest": ["nest", "nest.yaml", "--no-pictures", "--out", "out"],
    "page": ["report", "out"],
}
AGAIN = {"nest": ["--overwrite"], "page": []}  # after a kill, of those that keep nothing; the others take --resume
PAGE = "report.html"


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
    """When a state was kept last, and how long the journal is; zeros if nothing was kept."""
    states = [state.stat().st_mtime for state in (folder / "out").glob("checkpoint*/state.npz")]
    journals = (folder / "out" / name for name in JOURNALS.values())
    return max(states, default=0.0), sum(journal.stat().st_size for journal in journals if journal.exists())


def wait_for_news(running: Running, folder: Path, before: tuple[float, int]) -> None:
    """Until something new was kept, and up to `LONGEST` more."""
    until = time.monotonic() + WAIT
    while running.process.poll() is None and kept(folder) == before and time.monotonic() < until:
        time.sleep(0.005)
    time.sleep(random.uniform(0.0, LONGEST))


def to_the_end(name: str, folder: Path, kills: int, left: list[int], usual: float = 0.0) -> int:
    """Run a command, which takes its `usual` seconds, to its end with at most so many kills; how many there were."""
    begun, count = False, 0
    while True:
        before = kept(folder)
        running = Running([*words(name), *(AGAIN.get(name, ["--resume"]) if begun else [])], folder)
        if count >= kills:
            running.process.wait()
        elif name in AGAIN:
            time.sleep(random.uniform(0.0, usual))
        else:
            wait_for_news(running, folder, before)
        if running.process.poll() is not None:
            if running.process.returncode:
                raise RuntimeError((folder / "said.txt").read_text()[-2000:])
            return count
        left += running.kill()
        count, begun = count + 1, name in AGAIN or any(kept(folder))
        for partial in folder.rglob(".*partial*"):
            os.utime(partial, (0, 0))  # as if some time had passed, after which others are not writing it
        if (page := folder / "out" / PAGE).exists() and not page.read_text().rstrip().endswith("</html>"):
            raise RuntimeError(f"{page} is not whole")


def found(name: str, folder: Path) -> dict[str, object]:
    """What a run has found, without times and dates."""
    out = folder / "out"
    unfinished = {path.name: "left" for path in out.rglob(".*partial*")}
    if name == "page":
        return unfinished | {PAGE: (out / PAGE).read_text(encoding="utf-8")}
    if name in JOURNALS:
        records = [json.loads(line) for line in (out / JOURNALS[name]).read_text().splitlines()]
        cases = {one["key"]: {entry: value for entry, value in one.items() if entry != "seconds"} for one in records}
        return unfinished | cases | ({"found": (out / "found.yaml").read_text()} if name == "design" else {})
    arrays = {}
    for path in sorted(out.rglob("*.csv")):
        with open(path, encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        of = path.relative_to(out)
        arrays |= {f"{of} {column}": np.array([float(row[column] or "nan") for row in rows]) for column in rows[0]}
    for path in sorted(out.glob("checkpoint*/state.npz")):
        with np.load(path) as state:
            arrays[f"{path.parent.name} state"] = state["state"]
    summary = json.loads((out / "summary.json").read_text())
    own = {entry: value for entry, value in summary.items() if entry not in ("origin", "outer", "inner")}
    return {**unfinished, **arrays, **own}


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
    inner, outer = (
        OF_NEST.replace("DIAMETER", diameter).replace("MEAN", mean).replace("HAND", hand)
        for diameter, mean, hand in (("3.0", "24.0", "left"), ("4.0", "36.0", "right"))
    )
    for file, text in zip(
        ("case", "sweep", "design", "finer", "nest", "inner", "outer"),
        (CASE, SWEEP, DESIGN, FINER, NEST, inner, outer),
        strict=True,
    ):
        (folder / f"{file}.yaml").write_text(text)
    if name == "page":  # the same results each time, as their date is on it
        if not (solved := folder.parent / "solved").exists():
            to_the_end("solve", fresh(solved), 0, [])
        shutil.copytree(solved / "out", folder / "out")
    return folder


@dataclass
class Tried:
    """What killing a command has shown.

    Attributes:
        kills, ends: how often it was killed, and came to its end.
        unlike: names of what differs from an undisturbed run.
        left: processes that outlived it.
        to_the_bit: whether undisturbed runs agree to the bit, so that killed ones are to do so, too.
    """

    kills: int = 0
    ends: int = 0
    unlike: set[str] = field(default_factory=set)
    left: list[int] = field(default_factory=list)
    to_the_bit: bool = True


def tried(name: str, kills: int, place: Path, compared: bool = True) -> Tried:
    """Kill a command so many times; `compared`: run it twice undisturbed first, to see whether bits differ then."""
    undisturbed, outcome = fresh(place / "undisturbed", name), Tried()
    made = time.monotonic()
    to_the_end(name, undisturbed, 0, [])
    wanted, usual = found(name, undisturbed), time.monotonic() - made
    if compared:
        to_the_end(name, fresh(place / "again", name), 0, [])
        outcome.to_the_bit = not differing(wanted, found(name, place / "again"), True)
    while outcome.kills < kills:
        folder, most = fresh(place / "killed", name), kills - outcome.kills
        outcome.kills += to_the_end(name, folder, min(most, MOST) if name in AGAIN else most, outcome.left, usual)
        outcome.ends += 1
        outcome.unlike |= differing(wanted, found(name, folder), outcome.to_the_bit)
    return outcome


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
            outcome = tried(name, each, Path(place))
            bad = bad or bool(outcome.unlike or outcome.left)
            kind = "to the bit" if outcome.to_the_bit else f"to {AGREEMENT:g}, as undisturbed runs differ"
            print(
                f"{name}: {outcome.kills} kills, {outcome.ends} times to the end; compared {kind}; differing: "
                f"{sorted(outcome.unlike) or 'nothing'}; processes left: {len(outcome.left)}",
                flush=True,
            )
    return int(bad)


if __name__ == "__main__":
    sys.exit(main())
