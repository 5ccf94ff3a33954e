"""Files as somebody with bad intentions would send them: none runs code, reaches other files, or hangs.

    scripts/coilset python tests/faults/hostile.py       # all of them, a line each

Each is a folder with what MOUTHS reads. It is refused in one line, or read as the data that it is.
"""

import io
import json
import os
import pickle
import shutil
import sys
import tempfile
import zipfile
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import h5py
import numpy as np
from mpi4py import MPI

from coilset.meshes.measured.measured import read_centre_line
from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.errors import CoilsetError
from coilset.model.core.case import check, read_case
from coilset.model.core.material import library
from coilset.model.core.results.files.checkpoint import Checkpoint
from coilset.model.core.results.files.labelled import labelled
from coilset.model.core.results.files.opened import open_run
from coilset.model.physics.vibration.lift import read_lift
from coilset.model.tools.design.file import read_design_file
from coilset.model.tools.identification import programs
from coilset.model.tools.identification.experiments import read_test
from coilset.model.tools.nest.file import read_nest
from coilset.model.tools.sheet.from_results import read as read_results
from coilset.model.tools.studies.loaded_spring import after_results
from coilset.model.tools.sweep.journal import read_records
from coilset.model.tools.sweep.plan import Plan
from coilset.scripts.commands.report import report
from coilset.scripts.commands.solve import solve
from coilset.verification.comparison import compare

SPRING = "spring: {wire_diameter: 5.0, mean_diameter: 40.0, turns: 2.5, pitch: 12.0}\n"
CASE = SPRING + "material: elastic\nloading: [{to: {travel: 1}, steps: 2}]\naccuracy: none\nends: clamped\n"
CASE += "mesh: {elements_per_turn: 8, section: {rule: abramowitz9}}\n"
VICTIM = "victim.txt"
PWNED = "pwned"
TOUCH = f"open('{PWNED}', 'w')"
EVIL = f"{TOUCH}\nclass Evil: pass\n"


class Pickled:
    """Runs code when it is unpickled."""

    def __reduce__(self) -> tuple:
        return exec, (TOUCH,)


def arrays(**named: np.ndarray) -> bytes:
    file = io.BytesIO()
    np.savez(file, **named)
    return file.getvalue()


def claiming(length: int) -> bytes:
    """An archive with an array that claims to be long."""
    header = f"{{'descr': '<f8', 'fortran_order': False, 'shape': ({length},), }}".ljust(117) + "\n"
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("about.npy", b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header.encode())
    return file.getvalue()


def foreign(kind: str) -> Callable[[Path], None]:
    """points.nc with values that are in another file."""

    def write(folder: Path) -> None:
        with h5py.File(folder / "points.nc", "a") as file:
            if kind == "external":
                file.create_dataset("stolen", (4,), "u1", external=[(str(folder / VICTIM), 0, 4)])
            elif kind == "link":
                file["stolen"] = h5py.ExternalLink(str(folder / "other.nc"), "/position")
            elif kind == "virtual":
                layout = h5py.VirtualLayout((4,), "f8")
                layout[:] = h5py.VirtualSource(str(folder / "other.nc"), "position", (4,))
                file.create_virtual_dataset("stolen", layout)
            else:
                file["round"] = file["/"]

    return write


def case_with(options: str) -> dict[str, str]:
    return {"case.yaml": f"{CASE}solver: {{options: {{{options}}}}}\n", "evil.py": EVIL}


def of_results(change: Callable[[dict], object]) -> Callable[[Path], None]:
    """A results folder whose summary is changed."""

    def write(folder: Path) -> None:
        file = folder / "summary.json"
        summary = json.loads(file.read_text())
        change(summary)
        file.write_text(json.dumps(summary))

    return write


def claiming_points(folder: Path) -> None:
    """points.nc with an array that claims to be long, of which nothing is stored."""
    with h5py.File(folder / "points.nc", "a") as file:
        file.create_dataset("long", (10**10,), "f8")


def pipe(name: str) -> Callable[[Path], None]:
    """A pipe that nobody writes to in place of a file."""

    def write(folder: Path) -> None:
        (folder / name).unlink()
        os.mkfifo(folder / name)

    return write


def linked_spring(folder: Path) -> None:
    """The folder of a nest, whose outer spring is a link to results elsewhere."""
    for name in ("summary.json", "points.nc", "history.csv", "seats.csv"):
        (folder / name).rename(folder / "private" / name)
    spring = json.loads((folder / "private" / "summary.json").read_text())
    summary = {"clearance_min_mm": 1.0, "warnings": [], "outer": spring, "inner": None}
    (folder / "summary.json").write_text(json.dumps(summary))
    (folder / "nest.csv").write_text("step,seat_height_mm,force_N,outer_force_N,inner_force_N\n1,34,40,40,0\n")
    (folder / "outer").symlink_to("private")


def scripted(summary: dict) -> None:
    summary["set_mm"] = "<script>alert(1)</script>"


def evil_options(summary: dict) -> None:
    summary["origin"]["case"]["solver"]["options"] = {"pc_type": "python", "pc_python_type": "evil.py:Evil"}


MOUTHS: dict[str, Callable[[Path], object]] = {
    "case": lambda folder: Analysis(read_case(folder / "case.yaml"), MPI.COMM_SELF),
    "measured": lambda folder: read_centre_line(folder / "measured.csv"),
    "test": lambda folder: read_test(folder / "test.csv"),
    "compare": lambda folder: compare(folder, folder / "out"),
    "material": lambda folder: library.load(folder / "own.yaml"),
    "program": lambda folder: programs.read(folder / "program.yaml"),
    "sweep": lambda folder: Plan(folder / "sweep.yaml"),
    "design": lambda folder: read_design_file(folder / "design.yaml"),
    "nest": lambda folder: read_nest(folder / "nest.yaml"),
    "motion": lambda folder: read_lift(folder / "motion.csv"),
    "journal": lambda folder: list(read_records(folder / "journal.jsonl")),
    "resume": lambda folder: Checkpoint(folder, read_case(folder / "case.yaml")).load(MPI.COMM_SELF),
    "results": lambda folder: check(open_run(folder).case, folder / "case"),
    "page": lambda folder: labelled(folder),
    "sheet": lambda folder: read_results(folder),
    "modes": lambda folder: after_results(folder),
    "report": lambda folder: report(folder),
    "solve": lambda folder: solve(folder / "case.yaml", folder, True, [], voice="quiet"),
}
OF_RESULTS = ("resume", "results", "page", "sheet", "modes", "report", "solve")  # mouths that read a results folder
WRITES = ("report", "solve")


@dataclass(frozen=True)
class Hostile:
    """One attempt.

    Attributes:
        what: it tries, in words.
        mouth: of MOUTHS, that reads it.
        files: texts, bytes, or `-> target` of a link, by their names.
        change: what else is done to the folder.
        says: part of the line that refuses it; empty: it is read as data.
    """

    what: str
    mouth: str
    files: dict[str, str | bytes] = field(default_factory=dict)
    change: Callable[[Path], None] = lambda folder: None
    says: str = ""


def _tag(tag: str) -> dict[str, str]:
    return {"case.yaml": f"{CASE}sheet: {{customer: {tag}}}\n"}


def _of_case(name: str, entries: str) -> dict[str, str]:
    return {name: entries, **case_with("")}


NEST = "outer: {case: case.yaml}\ninner: {case: case.yaml}\nloading: [{to: block}]\n"
DESIGN = json.dumps({"conditions": [], "found": {}, "origin": {"case": {}}})
MATERIAL = """name: own
description: a table
source: somebody
units: N, mm, K
validity: {plastic_work: 100, remark: none}
temperatures:
  - temperature: 293.15
    elasticity: {G: 79000, nu: 0.29}
    isotropic: {law: table, file: curve.csv}
    kinematic: none
    non_normality: none
"""
_ALIASES = "".join(f"b{k}: &b{k} [{', '.join([f'*b{k - 1}'] * 10)}]\n" for k in range(1, 9))
_POLYGLOT = SPRING + (
    'material: "ck15"\nloading: [{"to": {"travel": 5}, "steps": 2}]\naccuracy: "none"\n'
    f'sheet: {{"customer": "{TOUCH}"}}\n'
    'solver: {"options": {"pc_type": "python", "pc_python_type": "case.yaml:Evil"}}\n'
)
_OPTIONS = {
    "a preconditioner in Python": ("pc_type: python, pc_python_type: 'evil.py:Evil'", "pc_type"),
    "a file of Python beside a plain type": ("pc_python_type: 'evil.py:Evil'", "pc_python_type"),
    "a linear solver in Python": ("ksp_type: python, ksp_python_type: 'evil.py:Evil'", "ksp_type"),
    "a nonlinear solver in Python": ("snes_type: python, snes_python_type: 'evil.py:Evil'", "snes_type"),
    "a monitor in Python": ("snes_monitor_python: 'evil.py:Evil'", "snes_monitor_python"),
    "Python within the preconditioning solver": (
        "npc_pc_type: python, npc_pc_python_type: 'evil.py:Evil'",
        "npc_pc_type",
    ),
    "a line search of C": ("snes_linesearch_type: shell", "snes_linesearch_type"),
    "a viewer to a file": (f"snes_view: 'ascii:{VICTIM}'", "snes_view"),
    "a monitor to a file": (f"snes_monitor: 'ascii:{VICTIM}'", "snes_monitor"),
    "a monitor to a file that it appends to": (f"ksp_monitor: 'ascii:{VICTIM}::append'", "ksp_monitor"),
    "a reason to a file": (f"ksp_converged_reason: 'ascii:{VICTIM}'", "ksp_converged_reason"),
    "a matrix to a file": (f"ksp_view_mat: 'binary:{VICTIM}'", "ksp_view_mat"),
    "a connection": ("snes_monitor: 'socket:5005'", "snes_monitor"),
    "a file of options": ("options_file: evil.txt", "options_file"),
    "a library": ("dll_append: evil.so", "dll_append"),
    "a log": (f"log_view: ':{VICTIM}'", "log_view"),
    "a file in place of a number": (f"snes_rtol: 'ascii:{VICTIM}'", "snes_rtol"),
    "a file in place of a word": (f"pc_factor_mat_solver_type: '{VICTIM}'", "pc_factor_mat_solver_type"),
    "MUMPS's own file": ("mat_mumps_icntl_1: 77", "mat_mumps_icntl_1"),
}
HOSTILE = [
    *(Hostile(f"PETSc: {what}", "case", case_with(text), says=says) for what, (text, says) in _OPTIONS.items()),
    Hostile("a case that is a program as well", "case", {"case.yaml": _POLYGLOT}, says="pc_type: 'python'"),
    # options wherever a case comes from
    Hostile(
        "options in a sweep",
        "sweep",
        _of_case("sweep.yaml", "case: case.yaml\nvary: {solver.options.pc_type: {values: [python, lu]}}\n"),
        says="solver.options.pc_type",
    ),
    Hostile(
        "options in the case of a sweep",
        "sweep",
        {"sweep.yaml": "case: case.yaml\nvary: {spring.pitch: {values: [12]}}\n", **case_with("snes_view: 'ascii:a'")},
        says="snes_view",
    ),
    Hostile(
        "options in a design",
        "design",
        {
            "design.yaml": f"{CASE}solver: {{options: {{pc_type: python}}}}\nfind: {{spring.pitch: [11, 13]}}\n"
            "such_that: {free_length_after_mm: 25.0}\n"
        },
        says="pc_type",
    ),
    Hostile(
        "options in a spring of a nest",
        "nest",
        {"nest.yaml": NEST} | case_with("pc_type: python"),
        says="pc_type",
    ),
    Hostile(
        "options in what is compared",
        "compare",
        {"measured.csv": "quantity,value,error\nset_mm,1,1\n", **case_with("pc_type: python")},
        says="pc_type",
    ),
    Hostile("options of a run, for its modes", "modes", change=of_results(evil_options), says="pc_type"),
    # YAML
    Hostile("a tag that calls a function", "case", _tag(f'!!python/object/apply:eval ["{TOUCH}"]'), says="tag"),
    Hostile("a tag that imports a module", "case", _tag("!!python/module:evil"), says="tag"),
    Hostile("a tag that names a function", "case", _tag("!!python/name:os.system"), says="tag"),
    Hostile("a tag that includes a file", "case", _tag("!include /etc/passwd"), says="tag"),
    Hostile("expressions of templates", "case", _tag("'{{ 7*7 }} ${jndi:ldap://x} {0.__class__} %s'")),
    Hostile("aliases of aliases", "case", {"case.yaml": f"b0: &b0 [1]\n{_ALIASES}{CASE}"}, says="1,000,000 values"),
    Hostile("deep nesting", "case", {"case.yaml": CASE + "sheet: " + "[" * 5000 + "]" * 5000}, says="nested deeper"),
    Hostile("an alias of what contains it", "case", {"case.yaml": f"{CASE}sheet: &a [*a]\n"}, says="nested deeper"),
    Hostile("a long list", "case", {"case.yaml": f"{CASE}rates_at: [{'1, ' * 900_000}]\n"}, says="longer than 2 MB"),
    Hostile("an endless file", "case", {"case.yaml": "-> /dev/zero"}, says="longer than 2 MB"),
    Hostile(
        "a number of 100,000 digits", "case", {"case.yaml": f"{CASE}temperature: {'9' * 100_000}\n"}, says="number"
    ),
    Hostile("another encoding", "case", {"case.yaml": CASE.encode("utf-16")}, says="UTF-8"),
    Hostile("a NUL", "case", {"case.yaml": f'{CASE}sheet: {{customer: "\\0"}}\n'}, says="none, such as NUL"),
    Hostile(
        "orders to the terminal", "case", {"case.yaml": f'{CASE}sheet: {{customer: "\\e]52;c;eA==\\a"}}\n'}, says="ESC"
    ),
    Hostile("names of Python's own", "case", {"case.yaml": f"{CASE}__class__: x\n"}, says="unknown entry"),
    Hostile(
        "names of limits", "case", {"case.yaml": f"{CASE}limits: {{__class__.__init__: [0, 1]}}\n"}, says="is no number"
    ),
    *(
        Hostile(f"{what} as a material", "case", {"case.yaml": CASE.replace("elastic", name), **files}, says=says)
        for what, name, files, says in (
            ("a file of the system", "../../../../../etc/passwd", {}, "neither a material of the library"),
            ("a folder", "/", {}, "neither a material of the library"),
            ("a program", "evil.py", {"evil.py": EVIL}, "neither a material of the library"),
            ("an endless file", "own.yaml", {"own.yaml": "-> /dev/zero"}, "longer than 2 MB"),
            ("a link to a file of the system", "own.yaml", {"own.yaml": "-> /etc/passwd"}, "is not a material file"),
        )
    ),
    Hostile(
        "an endless centre line in a sweep",
        "sweep",
        {"sweep.yaml": "case: case.yaml\nvary: {temperature: {values: [300]}}\n", "own.csv": "-> /dev/zero"}
        | {"case.yaml": CASE.replace(SPRING, "spring: {file: own.csv}\n")},
        says="own.csv",
    ),
    Hostile(
        "an endless outline",
        "case",
        {"case.yaml": CASE.replace("wire_diameter: 5.0", "wire: {outline: own.csv}"), "own.csv": "-> /dev/zero"},
        says="own.csv",
    ),
    Hostile(
        "a thousand turns of a thousand elements",
        "case",
        {"case.yaml": CASE.replace("turns: 2.5", "turns: 9e9").replace("per_turn: 8", "per_turn: 9e9")},
        says="turns",
    ),
    Hostile("a spring that is an endless file", "nest", {"nest.yaml": NEST, "case.yaml": "-> /dev/zero"}, says="2 MB"),
    # other files
    Hostile("an endless test", "test", {"test.csv": "-> /dev/zero"}, says="longer than 100 MB"),
    Hostile("a test of formulas", "test", {"test.csv": "strain,stress\n" + "=1+1,@SUM(1)\n" * 30}, says="not a number"),
    Hostile("endless measurements", "compare", {"measured.csv": "-> /dev/zero", **case_with("")}, says="100 MB"),
    Hostile("an endless centre line", "measured", {"measured.csv": "-> /dev/zero"}, says="no such file"),
    Hostile("formulas as points", "measured", {"measured.csv": "x,y,z\n=1+1,@SUM(1),0\n"}, says="not a number"),
    Hostile("a NUL in a table", "measured", {"measured.csv": "x,y,z\n0,0,\0\n"}, says="measured.csv"),
    Hostile("a quotation without end", "measured", {"measured.csv": 'x,y,z\n"' + "0," * 100_000}, says="measured.csv"),
    Hostile("a material with a function", "material", {"own.yaml": "name: !!python/name:os.system\n"}, says="tag"),
    *(
        Hostile(f"{what} as a curve", "material", {"own.yaml": MATERIAL, "curve.csv": f"-> {file}"}, says=says)
        for what, file, says in (
            ("an endless file", "/dev/zero", "longer than 100 MB"),
            ("a file of the system", "/etc/passwd", "curve.csv"),
        )
    ),
    Hostile("stresses in Pa", "material", {"own.yaml": MATERIAL.replace("{G: 79000", "{G: 79e9")}, says="as in Pa"),
    Hostile("a law in Python", "material", {"own.yaml": "name: x\nlaw: evil.py\n", "evil.py": EVIL}, says="law"),
    Hostile(
        "a program with a tag", "program", {"program.yaml": f'- !!python/object/apply:eval ["{TOUCH}"]\n'}, says="tag"
    ),
    Hostile(
        "a sweep of Python's names",
        "sweep",
        _of_case("sweep.yaml", "case: case.yaml\nvary: {spring.__class__: {values: [1, 2]}}\n"),
        says="__class__",
    ),
    Hostile(
        "a sweep of endless size",
        "sweep",
        _of_case("sweep.yaml", "case: case.yaml\nvary: {spring.pitch: {from: 11, to: 13, count: 1000000000000}}\n"),
        says="count",
    ),
    Hostile(
        "a grid of endless size",
        "sweep",
        _of_case(
            "sweep.yaml",
            "case: case.yaml\ndesign: grid\nvary: {spring.pitch: {from: 11, to: 13, count: 1000000}, "
            "spring.turns: {from: 2, to: 3, count: 1000000}}\n",
        ),
        says="cases",
    ),
    Hostile("a sweep of itself", "sweep", {"sweep.yaml": "case: sweep.yaml\nvary: {a: {values: [1]}}\n"}, says="case"),
    Hostile(
        "conditions in Python",
        "design",
        {"design.yaml": f"{CASE}find: {{spring.pitch: [11, 13]}}\nsuch_that: {{\"__import__('os')\": 1}}\n"},
        says="__import__",
    ),
    Hostile(
        "a motion beyond all numbers",
        "motion",
        {"motion.csv": "time_s,travel_mm\n0,0\n0.002,1e308\n"},
        says="no head moves",
    ),
    Hostile("a journal that is nested deep", "journal", {"journal.jsonl": "[" * 200_000 + "\n"}, says="not a record"),
    # results folders
    *(
        Hostile(f"{what} as checkpoint", "resume", {"checkpoint/state.npz": content}, says="state.npz")
        for what, content in (
            ("a pickle among arrays", arrays(about=np.array([Pickled()], object))),
            ("a pickle", pickle.dumps(Pickled())),
            ("7 PiB", claiming(10**15)),
            ("nothing", b""),
        )
    ),
    Hostile("a summary that is nested deep", "results", {"summary.json": "[" * 200_000}, says="summary.json"),
    Hostile("a summary that is a list", "results", {"summary.json": "[]"}, says="summary.json"),
    Hostile("values of another file", "results", change=foreign("external"), says="in another file"),
    Hostile("a link to another file", "page", change=foreign("link"), says="is a link"),
    Hostile("values put together of another file", "results", change=foreign("virtual"), says="in another file"),
    Hostile("an array of 80 GB that is not stored", "results", change=claiming_points, says="points.nc"),
    Hostile("a history without end", "report", {"history.csv": "-> /dev/zero"}, says="there is no history.csv"),
    *(
        Hostile(f"a pipe for the {mouth}", mouth, change=pipe("history.csv"), says="there is no history.csv")
        for mouth in ("report", "sheet")
    ),
    Hostile("a set that is a script", "report", change=of_results(scripted), says="is not readable"),
    Hostile("a page that is a link", "report", {"report.html": f"-> {VICTIM}"}),
    Hostile("an unfinished page that is a link", "report", {f".report.{16 * 'a'}.partial.html": f"-> {VICTIM}"}),
    Hostile("a design whose results are linked", "report", {"design.json": DESIGN, "found": "-> private"}, says="link"),
    Hostile("a nest whose spring is a link", "report", change=linked_spring, says="outer: is a link"),
    Hostile("a group in itself", "results", change=foreign("round"), says="is no array"),
    Hostile("another file for the sheet", "sheet", change=foreign("external"), says="in another file"),
    Hostile("points that are none", "sheet", {"points.nc": b"PK\3\4"}, says="points.nc"),
    Hostile("a history with formulas", "page", {"history.csv": "step,force_N\n=1+1,@SUM(1)\n"}, says="history.csv"),
    Hostile("a log that is a link", "solve", {"log.txt": f"-> {VICTIM}"}, says="log.txt"),
    Hostile("links in place of results", "solve", {"summary.json": f"-> {VICTIM}", "points.nc": f"-> {VICTIM}"}),
    Hostile("a folder of fields that is a link", "solve", {"fields": "-> private"}, says="there is a link named"),
    Hostile("a checkpoint that is a link", "solve", {"checkpoint": "-> private"}, says="there is a link named"),
]


def made(folder: Path) -> Path:
    """Results of a small run, as the attempts on results folders begin with."""
    (folder / "case.yaml").write_text(CASE)
    solve(folder / "case.yaml", folder, False, [], comm=MPI.COMM_SELF, voice="quiet")
    return folder


def put(attempt: Hostile, folder: Path, results: Path) -> None:
    """Lay an attempt out in an empty folder."""
    if attempt.mouth in OF_RESULTS:
        shutil.copytree(results, folder, dirs_exist_ok=True)
    (folder / VICTIM).write_text("mine")
    (folder / "private").mkdir()
    for name in ("00.vtu", "steps.jsonl", "state.npz"):
        (folder / "private" / name).write_text("mine")
    for name, content in attempt.files.items():
        path = folder / name
        path.parent.mkdir(exist_ok=True)
        if isinstance(content, str) and content.startswith("-> "):
            shutil.rmtree(path, ignore_errors=True)
            path.unlink(missing_ok=True)
            path.symlink_to(content[3:])
        else:
            path.write_bytes(content if isinstance(content, bytes) else content.encode())
    attempt.change(folder)


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def attack(attempt: Hostile, folder: Path) -> str:
    """Have a folder read; the line that refuses it, empty if it was read as data.

    Raises:
        AssertionError: it did what it should not.
    """
    here, before, private = os.getcwd(), set(folder.rglob("*")), contents(folder / "private")
    os.chdir(folder)
    try:
        MOUTHS[attempt.mouth](folder)
        line = ""
    except CoilsetError as error:
        line = str(error)
    finally:
        os.chdir(here)
    assert not (folder / PWNED).exists(), "ran code"
    assert (folder / VICTIM).read_text() == "mine", "overwrote a file"
    assert contents(folder / "private") == private, "reached another folder"
    assert "\n" not in line, "needed more than a line"
    assert bool(line) is bool(attempt.says), line or "was accepted"
    assert attempt.says in line, line
    if attempt.mouth not in WRITES:
        assert set(folder.rglob("*")) == before, "wrote files"
    return line


def main() -> int:
    """Run all; the number of those that did what they should not."""
    failed = 0
    with tempfile.TemporaryDirectory() as place:
        (results := Path(place, "results")).mkdir()
        made(results)
        for number, attempt in enumerate(HOSTILE):
            (folder := Path(place, str(number))).mkdir()
            put(attempt, folder, results)
            try:
                said = attack(attempt, folder) or "read as data"
            except AssertionError as error:
                failed, said = failed + 1, f"FAILED: {error}"
            print(f"{attempt.mouth:9} {attempt.what}: {said[:150]}", flush=True)
    print(f"{len(HOSTILE)} hostile inputs, {failed} not held")
    return failed


if __name__ == "__main__":
    sys.exit(main() > 0)
