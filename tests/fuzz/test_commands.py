"""No command line, however spoilt, gets a traceback or a long wait, and none that is refused leaves a file.

Where a command has looked at all it was given and would begin to work, it is stopped: nothing is solved here.
"""

import contextlib
import io
import os
import time

import pytest
from fuzz_effort import looks
from fuzz_files import EXAMPLES
from fuzz_judge import SLOWEST, check_line
from fuzz_tables import RELAXATION
from hypothesis import given
from hypothesis import strategies as st

from coilset.model.compose import build
from coilset.model.core.base.errors import CoilsetError
from coilset.model.physics.slice import analysis as slices
from coilset.scripts import main, precompile, ranks, running
from coilset.scripts.commands import design, material, mesh, nest, report, solid, solve, sweep, verify
from coilset.scripts.commands import slice as slice_command
from coilset.scripts.startup import typer
from coilset.verification.benchmarks import everyday

COMMANDS = {  # a right line each, and the options that it takes besides
    "solve case.yaml": [
        "--overwrite",
        "--resume",
        "--no-pictures",
        "--interactive",
        "--method",
        "bfgs",
        "--out",
        "there",
    ],
    "slice case.yaml": ["--overwrite", "--section", "oval:4:5", "--across", "3", "--no-pictures", "--out", "there"],
    "solid case.yaml": ["--overwrite", "--turns", "2", "--across", "1", "--layers", "9", "--out", "there"],
    "mesh case.yaml --no-pictures": ["--overwrite", "--write", "wire.vtu", "--out", "there"],
    "sheet case.yaml --no-pictures": [
        "--wire",
        "EN 10270-1 SH",
        "--length",
        "30",
        "--grade",
        "2",
        "--dynamic",
        "--surface",
        "shot peened",
        "--wires",
        "--results",
        "there",
        "--overwrite",
    ],
    "sweep sweep.yaml": ["--overwrite", "--resume", "--retry", "--jobs", "1", "--ranks-per-case", "2", "--no-pictures"],
    "material show ck15": ["--out", "there", "--overwrite"],
    "material test ck15 program.yaml": ["--no-spin", "--out", "there", "--overwrite"],
    "material fit test.csv --G 80000 --nu 0.3": ["--temperature", "300", "--no-saturation", "--name", "mine"],
    "design design.yaml": ["--overwrite", "--resume", "--out", "there"],
    "report run": ["--overwrite", "--out", "there"],
    "nest nest.yaml": ["--overwrite", "--no-pictures", "--out", "there"],
    "modes run": ["--at", "block-3mm", "--at", "height=x", "--count", "3", "--glued", "--no-pictures"],
    "surge run --lift 3 --speed 3000": ["--opening", "720", "--motion", "taken", "--at", "force=1e9", "--no-pictures"],
    "fields run": ["--overwrite", "taken"],
    "animate run": ["taken"],
    "compare run": ["--overwrite", "--out", "there"],
    "material certificate --rm 1800 --rp02 1500": ["--G", "81500", "--nu", "0.6", "--name", "../x", "--out", "there"],
    "material creep relaxation.csv": ["--form", "garofalo", "--error", "2", "--name", "mine", "--overwrite"],
    "material fit --spring press.csv spring.yaml": ["--known", "G=x", "--tester", "friction", "--law", "thesis"],
    "bench": ["--full", "--cold", "--against", "taken", "--out", "there"],
    "compile": ["--overwrite"],
    "verify bend-45": ["--fast", "--list", "--page", "page.md", "--out", "there"],
    "examples ck15_presetting": ["--overwrite", "--out", "there"],
    "-n 2 solve case.yaml": ["--overwrite"],
}
DESIGN = "case: case.yaml\nfind: {spring.pitch: [11.0, 13.0]}\nsuch_that: {set_mm: 13}\n"
SETTINGS = [
    "spring.wire_diameter=4",
    "spring.pitch=5",
    "loading.0.steps=x",
    "loading.9.steps=1",
    "mesh=1",
    "=1",
    "a=b",
    "material=nowhere.yaml",
    "ends=clamped",
    "contact.friction.seats=0.1",
    "loading=[{to: {force: 1e9}}]",
    "seats.top.tilt=free",
    "spring.turns=[",
    "mesh.elements_per_turn=1e6",
    "rates_at=[1]",
]
WORDS = [
    "",
    "-",
    "--",
    "-x",
    "--help",
    "-h",
    "--version",
    "-n",
    "0",
    "-1",
    "1e9",
    "nan",
    "nowhere.yaml",
    "taken",
    "taken/x",
    "x" * 300,
    "../..",
    "/dev/null",
    "/proc/x",
    "ä",
    "case.yaml",
    "solve",
    "--out",
    "--set",
    "--write",
]


class Reached(Exception):
    """The command would begin to work here."""


def reach(*_: object, **__: object) -> None:
    raise Reached


@st.composite
def lines(draw):
    """A right command line with words put in, left out or replaced."""
    line = draw(st.sampled_from(list(COMMANDS)))
    words = line.split()
    for _option in range(draw(st.integers(0, 3))):
        words.append(draw(st.sampled_from(COMMANDS[line])))
    if draw(st.booleans()):
        words += ["--set", draw(st.sampled_from(SETTINGS))]
    for _change in range(draw(st.integers(0, 2))):
        place, word = draw(st.integers(0, len(words))), draw(st.sampled_from(WORDS))
        change = draw(st.sampled_from(["put in", "replace", "leave out"]))
        words[place : place + (change != "put in")] = [] if change == "leave out" else [word]
    return words


@pytest.fixture
def place(tmp_path, monkeypatch):
    """A folder to stand in, where no command begins to work."""
    for name, source in (
        ("case.yaml", "ck15_presetting.yaml"),
        ("program.yaml", "material/tension.yaml"),
        ("test.csv", "material/fit/tension.csv"),
        ("press.csv", "material/springs/press_1.csv"),
        ("spring.yaml", "material/springs/spring.yaml"),
        ("nest.yaml", "nested/nest.yaml"),
        ("nested_outer.yaml", "nested/nested_outer.yaml"),
        ("nested_inner.yaml", "nested/nested_inner.yaml"),
    ):
        (tmp_path / name).write_bytes((EXAMPLES / source).read_bytes())
    (tmp_path / "relaxation.csv").write_text(RELAXATION)
    (tmp_path / "sweep.yaml").write_text("case: case.yaml\nvary: {spring.pitch: [11.0, 12.0]}\n")
    (tmp_path / "design.yaml").write_text(DESIGN)
    (tmp_path / "taken").write_text("mine")
    (tmp_path / "run").mkdir()
    monkeypatch.chdir(tmp_path)
    for module, name in (
        (solve, "prepare"),
        (slice_command, "prepare"),
        (solid, "prepare"),
        (sweep, "_pool"),
        (ranks, "launch"),
        (verify, "_run"),
        (mesh, "make"),
        (build, "line_mesh"),
        (slices.SliceAnalysis, "run"),
        (design, "solve"),
        (everyday, "timed"),
        (precompile, "warm"),
        (report, "_write"),
        (nest, "press"),
        (material, "write_material"),
        (material, "write_picture"),
        (material, "_write_csv"),
    ):
        monkeypatch.setattr(module, name, reach)
    monkeypatch.setattr("coilset.model.tools.identification.fit.fit", reach)
    monkeypatch.setattr("coilset.model.tools.spring_fit.fit.fit_springs", reach)
    monkeypatch.setattr("coilset.model.tools.identification.programs.run", reach)
    monkeypatch.setattr("coilset.scripts.commands.test.test", reach)
    return tmp_path


def files(folder):
    return {str(path.relative_to(folder)): path.stat().st_size for path in folder.rglob("*")}


def run(words):
    """What became of a line: `done`, `reached` or `refused`, and what it said."""
    try:
        code = main.app(words, prog_name="coilset", standalone_mode=False)
        return ("done" if not code else "refused"), ""
    except Reached:
        return "reached", ""
    except CoilsetError as error:
        return "refused", str(error)
    except (typer.Exit, typer.Abort):
        return "done", ""
    except Exception as error:
        if not hasattr(error, "format_message"):  # of click
            raise
        return "refused", running.command_line_message(error)


def test_spoilt_command_lines(place, monkeypatch):
    @looks(1 / 10)
    @given(lines())
    def spoil(words):
        monkeypatch.setattr("sys.argv", ["coilset", *words])
        before, began = files(place), time.process_time()
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            outcome, said = run(words)
        took = time.process_time() - began
        if outcome == "refused":
            check_line(said.replace(os.getcwd(), "HERE"))
            assert took < SLOWEST, f"refused after {took:.1f} s"
            assert files(place) == before
        else:
            for name in set(files(place)) - set(before):  # what it made on its way, so that the next one is alone
                if os.path.isfile(name):
                    os.unlink(name)

    spoil()
