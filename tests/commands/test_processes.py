"""Processes end with the command that started them, however it ends: real ones, known by a mark they carry."""

import json
import os
import re
import signal
import subprocess
import sys
import time
import uuid
from pathlib import Path

import pytest
from mpi4py import MPI

from coilset.scripts.interrupt import Interrupt

LAUNCHER = Path(__file__).resolve().parents[2] / "scripts" / "coilset"
CACHE = Path(os.environ.get("COILSET_CACHE", Path.home() / ".cache" / "coilset"))
LONG = ["--steps", "--no-pictures"] + [
    part
    for setting in (
        "mesh.section.rule=abramowitz9",
        "mesh.elements_per_turn=8",
        "loading=[{to: {travel: 8}, steps: 2000}]",
    )
    for part in ("--set", setting)
]
PATIENCE = 240.0  # seconds; a busy machine takes long to start Python
RELEASE = os.environ.get("COILSET_RELEASE") or "trixie"  # another has kernels of its own, still to be compiled
PRIVATE = {"COILSET_RELEASE": RELEASE}

in_private_root = pytest.mark.skipif(
    not (CACHE / f"debian-{RELEASE.replace('trixie', '13')}" / "usr").is_dir()
    or os.geteuid() != 0
    or not any(os.access(Path(folder) / "bwrap", os.X_OK) for folder in os.environ["PATH"].split(":")),
    reason="no private Debian here",
)


def hear_interrupts():
    """What a shell starts in the background ignores SIGINT, and hands that on to all that it starts."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


class Running:
    """A command under way in a folder; what it says goes to files there."""

    def __init__(self, command, folder, stdin=subprocess.DEVNULL, **environment):
        self.folder, self.mark = folder, f"COILSET_MARK={uuid.uuid4()}"
        name, value = self.mark.split("=")
        self.said, self.complaints = folder / "stdout", folder / "stderr"
        with open(self.said, "wb") as out, open(self.complaints, "wb") as err:
            self.process = subprocess.Popen(
                command,
                cwd=folder,
                stdout=out,
                stderr=err,
                stdin=stdin,
                start_new_session=True,
                env=os.environ | {"COILSET_RELEASE": "", name: value} | environment,
                preexec_fn=hear_interrupts,
            )

    def wait_for(self, words):
        """Until it has said these words."""
        self.until(lambda: words in self.said.read_text())

    def wait_for_a_step(self):
        """Until it has printed the row of one."""
        self.until(lambda: re.search(r"^ +\d+ +\d+\.\d{4} ", self.said.read_text(), re.MULTILINE))

    def until(self, condition):
        end = time.monotonic() + PATIENCE
        while not condition():
            assert time.monotonic() < end, (self.said.read_text(), self.complaints.read_text(), self.alive())
            time.sleep(0.02)

    def alive(self):
        """Every process that carries the mark, by number; those that have ended and wait to be noticed are none."""
        found = {}
        for folder in Path("/proc").glob("[0-9]*"):
            try:
                if self.mark.encode() in (folder / "environ").read_bytes().split(b"\0"):
                    found[int(folder.name)] = (folder / "cmdline").read_bytes().replace(b"\0", b" ").decode()
            except OSError:
                continue
        return found

    def end(self):
        for number in self.alive():
            os.kill(number, signal.SIGKILL)
        self.process.wait()
        if self.process.stdin:
            self.process.stdin.close()


@pytest.fixture
def start(tmp_path):
    """Start commands that do not outlive the test."""
    started = []

    def begin(command, **environment):
        started.append(Running(command, tmp_path, **environment))
        return started[-1]

    yield begin
    for running in started:
        running.end()


def coilset(*arguments):
    """A command through the launcher: with PRIVATE in a private root, without in the environment of this Python."""
    return [str(LAUNCHER), *map(str, arguments)]


@in_private_root
@pytest.mark.parametrize(
    ("ranks", "number"),
    [(1, signal.SIGTERM), (1, signal.SIGINT), (2, signal.SIGKILL)],
)
def test_ending_the_outer_process_ends_all(start, example, ranks, number):
    """With results and exit code 130, but for SIGKILL: after SIGINT the step is finished, after SIGTERM it is left."""
    command = coilset("-n", ranks, "solve", example, "--out", "out", *LONG)
    running = start(command, **PRIVATE)
    running.wait_for_a_step()
    assert len(running.alive()) > 2 * ranks
    os.kill(running.process.pid, number)
    running.process.wait(PATIENCE)
    if number == signal.SIGKILL:
        running.until(lambda: not running.alive())
    else:
        assert running.alive() == {}
        judge_gentle_end(running, number)


def complaints_of(running):
    """Lines of the error output, but for those on compiling, which a first run has."""
    lines = running.complaints.read_text().strip().splitlines()
    return [line for line in lines if not line.startswith("coilset: compil")]


def judge_gentle_end(running, number):
    said, complaints = running.said.read_text(), complaints_of(running)
    assert running.process.returncode == 130, (said, complaints)
    assert ("leaving" if number == signal.SIGTERM else "finishing") + " this step" in said
    assert "--resume" in said
    assert complaints == ["coilset: interrupted"]
    summary = json.loads((running.folder / "out" / "summary.json").read_text())
    assert summary["steps"] >= 3
    assert not summary["complete"]


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM])
def test_tests_end_with_the_command_that_runs_them(start, tmp_path, number):
    slow = tmp_path / "test_slow.py"
    slow.write_text(
        f"import pathlib, time\ndef test():\n    pathlib.Path({str(tmp_path / 'begun')!r}).touch()\n"
        "    time.sleep(1000)\n"
    )
    running = start(coilset("test", slow))
    running.until((tmp_path / "begun").exists)
    os.kill(running.process.pid, number)
    running.until(lambda: not running.alive())


@pytest.mark.parametrize(("ranks", "number"), [(1, signal.SIGINT), (1, signal.SIGTERM), (2, signal.SIGINT)])
def test_stopped_in_an_environment_without_a_root(start, example, ranks, number):
    running = start(coilset("-n", ranks, "solve", example, "--out", "out", *LONG))
    running.wait_for_a_step()
    os.kill(running.process.pid, number)
    running.process.wait(PATIENCE)
    judge_gentle_end(running, number)


@pytest.mark.parametrize(("ranks", "seconds"), [(1, 0.05), (1, 0.5), (2, 0.2), (2, 1.0)])
def test_ctrl_c_while_it_starts(start, example, ranks, seconds):
    """It is not lost: two thousand steps would go on for minutes, and end with 0."""
    running = start(coilset("-n", ranks, "solve", example, "--out", "out", *LONG))
    time.sleep(seconds)
    os.kill(running.process.pid, signal.SIGINT)
    code = running.process.wait(PATIENCE)
    if "init_import_site" in running.complaints.read_text():  # Python itself ends with 1 while it imports site
        assert code == 1
    else:
        assert code in (130, -signal.SIGINT)
    running.until(lambda: not running.alive())


def test_a_signal_that_mpirun_drops_reaches_the_ranks_it_starts(start, example, tmp_path):
    """Before it has ranks it passes none on; the ranks find the file then."""
    stopped = tmp_path / "stopped"
    stopped.touch()
    environment = {"COILSET_STOPPED": str(stopped), "COILSET_RANKS": "1", "COILSET_PYTHON": sys.executable}
    running = start(coilset("solve", example, "--out", "out", *LONG), **environment)
    assert running.process.wait(PATIENCE) == 130
    assert complaints_of(running) == ["coilset: interrupted"]
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    "environment", [{"COILSET_PYTHON": sys.executable}, pytest.param(PRIVATE, marks=in_private_root)]
)
def test_the_launcher_forgets_no_signal(start, tmp_path, environment):
    """It reaches the shell alone, or the Python that has taken its place; nothing goes on after it."""
    (tmp_path / "wait.py").write_text("import time\ntime.sleep(1000)\n")
    for milliseconds in range(4, 52, 4):
        number = signal.SIGTERM if milliseconds % 3 == 0 else signal.SIGINT
        running = start(coilset("python", tmp_path / "wait.py"), **environment)
        time.sleep(1e-3 * milliseconds)
        os.kill(running.process.pid, number)
        assert running.process.wait(PATIENCE) in (128 + number, -number), milliseconds
        running.until(lambda running=running: not running.alive())


def test_no_interrupt_is_held_when_the_shell_becomes_python(start, tmp_path):
    """Bash forgets a signal with a trap that comes while exec is prepared, in some microseconds that no test meets."""
    (tmp_path / "watch").write_text("set -T\ntrap '[[ $BASH_COMMAND != exec* ]] || trap -p > traps' DEBUG\n")
    for _ in range(2):  # the second time from the record of the first
        running = start(coilset("--version"), COILSET_PYTHON=sys.executable, BASH_ENV=str(tmp_path / "watch"))
        assert running.process.wait(PATIENCE) == 0
    assert "SIGINT" not in (tmp_path / "traps").read_text()
    assert "DEBUG" in (tmp_path / "traps").read_text()  # the watch was there


@pytest.mark.parametrize(
    "swallow",
    [
        "class Lost:\n    def __del__(self): wait()\nLost()",
        "import ctypes\nctypes.CFUNCTYPE(None)(wait)()",
    ],
)
def test_an_interrupt_that_python_cannot_pass_on_is_raised_again(swallow):
    """In a destructor and in a callback from C."""
    program = (
        "import os, signal, time\nfrom coilset.scripts.running import _listen\n_listen()\n"
        "def wait():\n    os.kill(os.getpid(), signal.SIGINT)\n    time.sleep(0.01)\n"
        f"try:\n    exec({swallow!r})\n    time.sleep(100)\nexcept KeyboardInterrupt:\n    print('heard')\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=PATIENCE, preexec_fn=hear_interrupts
    )
    assert (done.stdout, done.stderr) == ("heard\n", "")


def test_ctrl_c_while_the_environment_is_looked_for(start, example, tmp_path):
    """An empty cache folder: the shell waits for Python there, and hears of the signal afterwards."""
    running = start(
        coilset("solve", example, "--out", "out", *LONG),
        COILSET_CACHE=str(tmp_path / "cache"),
        COILSET_PYTHON=sys.executable,
    )
    running.until((tmp_path / "cache" / "checkouts").exists)
    os.kill(running.process.pid, signal.SIGINT)
    assert running.process.wait(PATIENCE) == 130
    running.until(lambda: not running.alive())


@pytest.mark.parametrize("number", range(4))
def test_ctrl_c_while_the_cache_folder_is_made(start, example, tmp_path, number):
    """Only the shell hears of it, which waits for mkdir there, and forgot it most of the time."""
    cache = tmp_path / "cache"
    running = start(
        coilset("solve", example, "--out", "out", *LONG), COILSET_CACHE=str(cache), COILSET_PYTHON=sys.executable
    )
    while not (cache / "checkouts").exists():
        pass
    time.sleep(3e-4 * number)
    os.kill(running.process.pid, signal.SIGINT)
    assert running.process.wait(PATIENCE) in (130, -signal.SIGINT)  # by its trap, or where it has none yet


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_closed_output_is_a_gentle_end(start, example, ranks):
    """`solve | head -3`."""
    solve = " ".join(coilset("-n", ranks, "solve", example, "--out", "out", *(f"'{word}'" for word in LONG)))
    running = start(["bash", "-c", f"{solve} | head -n 3; exit ${{PIPESTATUS[0]}}"])
    assert running.process.wait(PATIENCE) == 128 + signal.SIGPIPE
    assert set(complaints_of(running)) <= {"coilset: interrupted"}
    assert len(running.said.read_text().splitlines()) == 3
    assert not json.loads((running.folder / "out" / "summary.json").read_text())["complete"]


def test_errors_on_ranks_are_one_line(start):
    running = start(coilset("-n", 2, "solve", "nowhere.yaml"))
    assert running.process.wait(PATIENCE) == 2
    assert len(running.complaints.read_text().strip().splitlines()) == 1
    assert "nowhere.yaml" in running.complaints.read_text()


def test_ctrl_c_at_the_prompt_ends_the_run(start, example):
    command = coilset("solve", example, "--out", "out", "--interactive", *LONG)
    running = start(command, stdin=subprocess.PIPE)
    running.wait_for("coilset> ")
    os.kill(running.process.pid, signal.SIGINT)
    assert running.process.wait(PATIENCE) == 130
    assert json.loads((running.folder / "out" / "summary.json").read_text())["steps"] == 1


def test_an_interrupt_that_was_put_off_is_noted_by_the_solve():
    """It came during an import, just before the solve: its alarm is not taken for that of a step to be left."""
    said = []
    before = signal.signal(signal.SIGALRM, signal.SIG_IGN)
    signal.setitimer(signal.ITIMER_REAL, 60.0)
    try:
        with Interrupt(MPI.COMM_SELF, said.append) as interrupt:
            assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)
            assert interrupt.stopped()
            assert not interrupt.hurries
        with Interrupt(MPI.COMM_SELF, said.append) as interrupt:
            assert not interrupt.stopped()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    assert said == ["finishing this step; once more ends at once"]
