"""Pictures are drawn by processes of their own: what becomes of them however they, or those who wait for them, end."""

import io
import json
import os
import signal
import subprocess
import sys
import threading
import time

import pytest
from matplotlib.image import imread

from coilset.model.core.base.errors import CoilsetError
from coilset.model.core.runtime.processes import mpi_environment, mpirun
from coilset.model.tools.figures import pictures
from coilset.model.tools.figures.display import ensure
from coilset.scripts.startup import announce_begin
from coilset.scripts.terminal import drawing
from coilset.scripts.terminal.drawing import Drawings

# A stand-in for the process that draws: takes its task, and then does what its part is called.
STAND_IN = """
import json, os, pathlib, signal, sys, time
signal.signal(signal.SIGINT, signal.SIG_IGN)
out = pathlib.Path(os.fsdecode(sys.stdin.buffer.read()))
what = sys.argv[1]
if what == "dies": os.kill(os.getpid(), signal.SIGSEGV)
if what == "leaves": sys.exit(7)
if what == "hangs": (out / "begun").touch(); time.sleep(600)
problem = "springs.png: cannot be written" if what == "fails" else None
print(json.dumps({"problem": problem, "warnings": [f"{what} {out.name}"]}), flush=True)
"""


@pytest.fixture
def stand_in(monkeypatch, tmp_path):
    """Replaces what is started by STAND_IN, and the parts by those named; gives the processes that were started."""
    started = []

    def use(*parts):
        script, popen = tmp_path / "stand_in.py", subprocess.Popen
        script.write_text(STAND_IN)

        def start(command, **options):
            started.append(popen([sys.executable, str(script), command[-1]], **options))
            return started[-1]

        monkeypatch.setattr(drawing, "PARTS", parts)
        monkeypatch.setattr(drawing.subprocess, "Popen", start)
        return started

    return use


def test_warnings_of_all_parts_come_back(stand_in, tmp_path):
    started = stand_in("one", "two")
    with Drawings(os.environ) as drawings:
        assert drawings.draw(tmp_path) == [f"one {tmp_path.name}", f"two {tmp_path.name}"]
    assert all(process.returncode is not None for process in started)


def test_an_error_of_a_library_is_a_warning(monkeypatch, tmp_path):
    def draw(folder):
        raise KeyError(f"no triangles in {folder.name}")

    monkeypatch.setitem(pictures.PARTS, "scene", lambda: draw)
    found = drawing.draw_part("scene", io.BytesIO(os.fsencode(tmp_path)))
    assert found == {
        "problem": None,
        "warnings": [f"not all pictures are drawn: 'no triangles in {tmp_path.name}'"],
    }


@pytest.mark.parametrize(
    ("what", "said"),
    [
        ("dies", "not all pictures are drawn: the process that draws them ended with signal 11"),
        ("leaves", "not all pictures are drawn: the process that draws them ended with exit code 7"),
        ("fails", "springs.png: cannot be written"),
    ],
)
def test_a_part_that_fails_is_said_and_the_others_come_to_their_end(stand_in, tmp_path, what, said):
    stand_in(what, "fine")
    with Drawings(os.environ) as drawings:
        with pytest.raises(CoilsetError) as caught:
            drawings.draw(tmp_path)
        assert drawings.processes["fine"].wait() == 0
    assert str(caught.value) == said


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_the_waiting_and_the_processes(stand_in, tmp_path, monkeypatch, number):
    started = stand_in("hangs")

    def interrupt(*_):
        raise KeyboardInterrupt

    def kill():
        while not (tmp_path / "begun").exists():
            time.sleep(0.01)
        os.kill(os.getpid(), number)

    before = [signal.signal(signal.SIGINT, interrupt), signal.getsignal(signal.SIGTERM)]
    killer = threading.Thread(target=kill)
    try:
        killer.start()
        with pytest.raises(KeyboardInterrupt), Drawings(os.environ) as drawings:
            drawings.draw(tmp_path)
    finally:
        signal.signal(signal.SIGINT, before[0])
        killer.join()
    assert signal.getsignal(signal.SIGTERM) is before[1]
    assert [process.returncode for process in started] == [-signal.SIGTERM]


def test_processes_without_a_task_end_at_once(stand_in, monkeypatch):
    """As when the case is refused: they were started before it was read."""
    started = stand_in("one", "two")
    monkeypatch.setattr(drawing.os, "sched_getaffinity", lambda pid: {0, 1})
    monkeypatch.setattr(drawing, "number_of_ranks", lambda: 1)
    with Drawings(os.environ) as drawings:
        drawings.start_if_free()
        assert len(started) == 2
    assert all(process.returncode is not None for process in started)


@pytest.mark.parametrize(("cores", "ranks", "processes"), [(1, 1, 0), (2, 2, 0), (4, 2, 1)])
def test_they_are_started_early_only_on_cores_that_no_rank_has(stand_in, monkeypatch, cores, ranks, processes):
    started = stand_in("one")
    monkeypatch.setattr(drawing.os, "sched_getaffinity", lambda pid: set(range(cores)))
    monkeypatch.setattr(drawing, "number_of_ranks", lambda: ranks)
    with Drawings(os.environ) as drawings:
        drawings.start_if_free()
        assert len(started) == processes


def test_the_process_ends_with_nothing_where_no_task_comes():
    done = subprocess.run(
        [sys.executable, "-m", "coilset.scripts.terminal.drawing", "figures"], input=b"", capture_output=True
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, b"", b"")


def test_the_first_line_names_the_file_that_is_read(tmp_path, capsys):
    """Not that it is solved: whether the file is right is not known yet."""
    case = tmp_path / "spring.yaml"
    announce_begin(str(case), None)
    assert capsys.readouterr().out == ""  # of a file that is not there
    case.touch()
    announce_begin(str(case), str(tmp_path / "out"))
    assert capsys.readouterr().out.endswith(" reads spring.yaml\n")


def test_pictures_of_a_run_are_drawn_by_the_command(example, tmp_path):
    coarse = "loading=[{to: {travel: 4}, steps: 1}]", "mesh.elements_per_turn=8", "accuracy=none"
    short = [word for entry in coarse for word in ("--set", entry)]
    out = tmp_path / "out"
    command = [sys.executable, "-m", "coilset.scripts", "solve", str(example), "--out", str(out), *short]
    said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    pictures = {path.name for path in out.glob("*.png")}
    assert {"characteristic.png", "cross_section.png", "force_centre.png", "seat_pressure.png"} <= pictures
    assert "springs.png" in pictures or "springs.png is not drawn" in said
    assert not list(out.glob(".*partial*"))
    assert json.loads((out / "summary.json").read_text())["steps"] == 1


def test_two_ranks_draw_the_spring_and_its_force_line(example, tmp_path):
    """Also the case with most pictures ends without a fault of the libraries that ranks and drawing both load."""
    if not ensure():
        pytest.skip("no display and no Xvfb")
    case = example.parent / "springs" / "side_load.yaml"
    coarse = "loading.0.steps=1", "mesh.elements_per_turn=8", "mesh.section={radial: 2, angular: 6}", "accuracy=none"
    settings = [word for entry in coarse for word in ("--set", entry)]
    command = [*mpirun(2), sys.executable, "-m", "coilset.scripts", "solve", str(case), "--out", "out", *settings]
    done = subprocess.run(
        command, cwd=tmp_path, env=mpi_environment(), capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stderr
    for name in ("springs.png", "force_line.png"):
        picture = imread(tmp_path / "out" / name)
        assert picture[..., :3].std() > 0.02
