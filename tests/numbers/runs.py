"""The runs whose numbers are kept: shipped springs, springs with other entries, a small solid, cases of verification.

Every run is a function of a folder and a number of ranks that leaves plain files (JSON, CSV, NetCDF) in the folder.
They use the commands of whichever checkout's `coilset` is imported; only `press_and_release` knows an interface below.
"""

import functools
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
from mpi4py import MPI

import coilset.model

TREE = Path(coilset.model.__file__).resolve().parents[1]
COILSET = [sys.executable, "-m", "coilset.scripts"]
MPIRUN = ["mpirun", "--oversubscribe", "--mca", "btl", "self,sm", "-n"]
KEPT = ("summary.json", "history.csv", "seats.csv", "points.nc")  # of a results folder

PRESSED = "loading=[{to: {travel: 10}, steps: 5}, {to: {force: 0}, steps: 5}]"
SPRING, CONE = "examples/ck15_presetting.yaml", "examples/springs/cone.yaml"
# what the shipped springs leave out: name → case file, settings
VARIANTS = {
    "clamped": (SPRING, ["ends=clamped", PRESSED]),
    "groove": (SPRING, ["seats={hold: groove}"]),
    "seats-that-move": (
        SPRING,
        [
            "seats={hold: groove, bottom: {shape: stepped, turns: 0.75}, "
            "top: {shape: conical, angle: 5, tilt: free, sideways: 200.0}}",
            PRESSED,
        ],
    ),
    "gaps": (SPRING, ["contact.coils=gaps"]),
    "augmented": (SPRING, ["contact.penetration=0.001"]),
    "friction": (CONE, ["contact.friction={seats: 0.1, coils: 0.1}"]),
    "automatic-steps": (CONE, ["loading.0.steps=auto", "loading.1.steps=auto"]),
    "chords-abramowitz9": (SPRING, ["mesh={axis: chords, section: {kind: plane, rule: abramowitz9}}"]),
    "bfgs": (SPRING, ["solver.method=bfgs", "ends=clamped", PRESSED]),
    "modified-newton": (SPRING, ["solver.method=modified-newton", "ends=clamped", PRESSED]),
    "arc-length": (SPRING, ["solver.method=arc-length", "ends=clamped", PRESSED]),
}


def all_runs() -> dict[str, Callable]:
    """Name → function (folder, ranks) of every run, quick ones first."""
    files = [TREE / "examples/ck15_presetting.yaml", *sorted((TREE / "examples/springs").glob("*.yaml"))]
    found = {f"spring/{file.stem}": functools.partial(solve, file, []) for file in files}
    found |= {
        f"variant/{name}": functools.partial(solve, TREE / file, settings)
        for name, (file, settings) in VARIANTS.items()
    }
    found["solid/pressed"] = solid
    listed = command([*COILSET, "verify", "--list"]).splitlines()[1:]
    cases = [words for line in listed if (words := line.split())]
    for slow in (False, True):
        found |= {
            f"verify/{words[0]}": functools.partial(verify, words[0]) for words in cases if (words[1] == "slow") == slow
        }
    return found


def solve(case: Path, settings: list[str], folder: Path, ranks: int) -> None:
    """`coilset solve`; keeps summary, history, seats and section points."""
    options = [option for setting in settings for option in ("--set", setting)]
    command([*launcher(ranks), *COILSET, "solve", str(case), "--no-pictures", "--out", str(folder), *options])
    for path in sorted(folder.rglob("*"), reverse=True):
        if path.is_dir():
            path.rmdir()
        elif path.name not in KEPT:
            path.unlink()


def verify(name: str, folder: Path, ranks: int) -> None:
    """`coilset verify NAME`; keeps its record. It works on one rank only."""
    if ranks > 1:
        raise RuntimeError("verify works on one rank")
    off = command([*COILSET, "verify", name, "--out", str(folder)], accepted=(0, 1))
    folder.joinpath("record.json").write_bytes((folder / name / "record.json").read_bytes())
    folder.joinpath("printed.txt").write_text(off, encoding="utf-8")
    for path in (folder / name).iterdir():
        path.unlink()
    (folder / name).rmdir()


def solid(folder: Path, ranks: int) -> None:
    """The small solid, in a process of its own."""
    command([*launcher(ranks), sys.executable, __file__, str(folder)])


def press_and_release(comm: MPI.Comm) -> dict[str, np.ndarray]:
    """One turn of Ck 15 as a coarse solid, pressed to nine tenths of the way to block in four steps and released.

    This is the one place that knows the solid's interface. What is in the order of nodes or cells is left out where the
    partition would change it.

    Returns:
        Name → array.
    """
    from coilset.verification.solid_study.pressing import PressedSection, run_solid

    found = {}

    def keep(when: str, problem) -> None:
        if comm.size == 1:
            found[f"positions {when}"] = problem.solid.x.copy()
            found[f"state {when}"] = problem.solid.point_state.copy()

    case = PressedSection(8.0, 2, 12, steps=4)
    result = run_solid(case, comm, on_full=lambda p: keep("full", p), on_end=lambda p: keep("end", p))
    found |= {name: np.array(result[name]) for name in ("unknowns", "iterations", "travel", "force", "torque", "set")}
    return found | {f"stress {when}": np.array(result[when]["stress"]) for when in ("full", "end")}


def launcher(ranks: int) -> list[str]:
    """What stands before a command that runs on several ranks."""
    return [*MPIRUN, str(ranks)] if ranks > 1 else []


def command(arguments: list[str], accepted: tuple[int, ...] = (0,)) -> str:
    """Run a command and return what it prints; RuntimeError with its last line if it fails."""
    wide = {**os.environ, "COLUMNS": "300"}  # no table is broken into more lines
    done = subprocess.run(arguments, capture_output=True, text=True, check=False, env=wide)
    if done.returncode not in accepted:
        last = (done.stderr.strip() or done.stdout.strip() or "no output").splitlines()[-1]
        raise RuntimeError(f"exit code {done.returncode}: {last}")
    return done.stdout


if __name__ == "__main__":
    arrays = press_and_release(MPI.COMM_WORLD)
    if MPI.COMM_WORLD.rank == 0:
        np.savez(Path(sys.argv[1]) / "solid.npz", **arrays)
