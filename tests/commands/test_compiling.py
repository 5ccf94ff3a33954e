"""A cold start says so, a warm one does not."""

import fcntl
import logging
import os
import re
import subprocess
import sys
import threading

import numba
import pytest
from mpi4py import MPI

from coilset.model.core.base.errors import InputError
from coilset.model.core.runtime.processes import mpi_environment, mpirun
from coilset.scripts import compiling, precompile
from coilset.scripts.commands.solve import solve
from coilset.scripts.compiling import NOTICE, NOTICE_OF_PART, announce_compiling, compile_first, compiled

COARSE = "loading=[{to: {travel: 2}, steps: 1}]", "mesh.elements_per_turn=8", "accuracy=none"
SMALL = [*(word for entry in COARSE for word in ("--set", entry)), "--no-pictures"]


@pytest.fixture
def announced():
    """An announcement, and what it says; FFCx's logger is as before afterwards."""
    logger, said = logging.getLogger("ffcx"), []
    before = (list(logger.handlers), logger.level, logger.propagate)
    yield announce_compiling(said.append), said
    del logger.setLevel
    logger.handlers, logger.propagate = before[0], before[2]
    logger.setLevel(before[1])


def test_numba_compiling_is_said_once(announced):
    _, said = announced
    kernels = [numba.njit(lambda x: x + 1.0), numba.njit(lambda x: x + 2.0)]
    assert said == []
    assert [kernel(1.0) for kernel in kernels] == [2.0, 3.0]
    assert said == [NOTICE_OF_PART]


def test_ffcx_is_heard_whatever_level_it_sets(announced):
    _, said = announced
    logger = logging.getLogger("ffcx")
    logger.setLevel(logging.WARNING)
    logger.info("Final option values")  # said for forms from its cache, too
    assert said == []
    logger.info("Compiler stage 1: Analyzing UFL objects")
    assert said == [NOTICE_OF_PART]
    logger.warning("what a user should read")
    assert said == [NOTICE_OF_PART, "what a user should read"]


@pytest.fixture
def cold(monkeypatch, tmp_path):
    """A folder of kernels that is empty; COMPILE leaves lines in `log`, and the file that ends it."""
    folder = tmp_path / "none"
    script = 'echo compiled >> "$1/log"; env >> "$1/log"; file=$2; shift 2; for stage; do touch "$file-$stage"; done'
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(folder))
    monkeypatch.setattr(compiling, "COMPILE", ["sh", "-c", script, "sh", str(folder), str(compiled("rod"))[:-4]])
    monkeypatch.setenv("OMPI_COMM_WORLD_RANK", "0")
    monkeypatch.setenv("OMPI_ALLOW_RUN_AS_ROOT", "1")
    return folder


def test_kernels_are_compiled_by_a_process_of_its_own(cold):
    """Once, and not as a rank, but it may start some; it is said before, and how long it took afterwards."""
    said = []
    for _ in range(2):
        compile_first(say=said.append)
    notice, time = said
    assert notice == NOTICE
    assert re.fullmatch(r"coilset: compiled in \d+ s", time)
    log = (cold / "log").read_text()
    assert log.count("compiled\n") == 1
    assert "OMPI_COMM_WORLD" not in log
    assert "OMPI_ALLOW_RUN_AS_ROOT=1" in log  # or it could start no ranks that compile theirs


def test_another_that_compiles_is_waited_for(cold):
    cold.mkdir()
    with open(compiled("rod").with_suffix(".lock"), "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        waits = threading.Thread(target=compile_first, kwargs={"say": lambda line: None, "stages": ("rod",)})
        waits.start()
        waits.join(0.3)
        assert waits.is_alive()
        compiled("rod").touch()
    waits.join(10.0)
    assert not waits.is_alive()
    assert not (cold / "log").exists()


def test_a_command_compiles_only_the_stages_that_it_needs(cold):
    compile_first(say=lambda line: None, stages=("rod",))
    assert [stage for stage in compiling.STAGES if compiled(stage).exists()] == ["rod"]
    compile_first(say=lambda line: None)
    assert all(compiled(stage).exists() for stage in compiling.STAGES)


def test_wrong_input_is_refused_before_anything_is_compiled(cold):
    def check():
        raise InputError("is wrong", "place")

    with pytest.raises(InputError):
        compile_first(check, pytest.fail)
    assert not cold.exists()


def test_a_folder_that_cannot_be_made_hinders_nobody(monkeypatch, tmp_path):
    (tmp_path / "file").touch()
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "file" / "none"))
    compile_first(say=lambda line: None)


USED = """
import gc, sys
from mpi4py import MPI
from numba.core.dispatcher import Dispatcher
from coilset.model.compose.analysis import Analysis
from coilset.model.core.case import read_case
from coilset.model.tools.design.surrogate import guess
from coilset.scripts.precompile import PRESSED, _run, short_case, warm

def used():
    kernels = [thing for thing in gc.get_objects() if issubclass(type(thing), Dispatcher)]  # no proxy is asked
    return {f"{kernel.py_func.__qualname__} {signature}" for kernel in kernels for signature in kernel.overloads}

"""
KERNELS = """
from coilset.scripts.commands.report import report
warm()
compiled = used()
run, *files = sys.argv[1:]
for file in files:
    case = read_case(file, [])
    phases = [f"loading.{number}.steps={2 if 'time' in file else 6}" for number in range(len(case.loading))]
    coarse = ["mesh.elements_per_turn=8", "mesh.section={radial: 2, angular: 8}"]
    Analysis(read_case(file, [*coarse, *phases]), MPI.COMM_SELF).run()
guess(read_case(files[0], []), [])
report(run)
print(len(compiled), sorted(used() - compiled))
"""


def test_shipped_examples_and_a_page_need_no_kernel_that_is_not_compiled_before(example, tmp_path):
    solve(example, tmp_path / "run", False, COARSE, comm=MPI.COMM_SELF)
    springs, time = (example.parent / name for name in ("springs", "time"))
    files = [example, springs / "closed_and_ground.yaml", time / "relaxation.yaml"]
    command = [sys.executable, "-c", USED + KERNELS, str(tmp_path / "run"), *files]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    count, missing = done.stdout.splitlines()[-1].split(maxsplit=1)
    assert int(count) > 8  # those that are called by Python; the others are in them
    assert missing == "[]"
    assert (tmp_path / "run" / "report.html").is_file()


KERNELS_OF_RANKS = """
_run(short_case(*PRESSED))
compiled = used()
steps = ["loading.0.steps=6", "loading.1.steps=3"]
Analysis(read_case(sys.argv[1], ["mesh.section={radial: 2, angular: 8}", *steps]), MPI.COMM_WORLD).run()
missing = MPI.COMM_WORLD.gather(sorted(used() - compiled))
if missing is not None:
    print(len(compiled), missing)
"""


def test_ranks_need_no_kernel_that_is_not_compiled_before(example):
    command = [*mpirun(2), sys.executable, "-c", USED + KERNELS_OF_RANKS, str(example)]
    done = subprocess.run(command, env=mpi_environment(), capture_output=True, text=True, check=True)
    count, missing = done.stdout.strip().split(maxsplit=1)
    assert int(count) > 8
    assert missing == "[[], []]"


def test_a_warm_solve_does_not_say_it(example, tmp_path):
    """The first solve may; the second finds everything compiled."""
    command = [sys.executable, "-m", "coilset.scripts", "solve", str(example), "--overwrite", "--out", "out", *SMALL]
    first, second = (
        subprocess.run(command, cwd=tmp_path, env=dict(os.environ), capture_output=True, text=True, check=True)
        for _ in range(2)
    )
    assert first.stderr.splitlines()[:1] in ([], [NOTICE])
    assert second.stderr == ""


def test_the_stages_of_compiling_are_shown(monkeypatch, tmp_path, capfd):
    """What is compiled, and how many stages there are, while the command waits for it."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    said = "for k in 1 2 3; do echo coilset: compiling $k of 3: kernels; done; touch " + str(compiled("creep"))
    monkeypatch.setattr(compiling, "COMPILE", ["sh", "-c", said])
    lines = []
    compile_first(say=lines.append, stages=("creep",))
    assert capfd.readouterr().err.splitlines() == [f"coilset: compiling {k} of 3: kernels" for k in (1, 2, 3)]
    assert lines[0] == NOTICE
    assert lines[-1].startswith("coilset: compiled in ")


def test_the_warming_names_each_stage_once(monkeypatch, tmp_path):
    monkeypatch.setattr(precompile, "compiled", lambda stage: tmp_path / stage)
    done, lines = [], []
    for work in ("_run", "_uniform", "_point"):
        monkeypatch.setattr(precompile, work, lambda *_: done.append(len(lines)))
    precompile.warm(report=lines.append)
    assert done == [1, 2, 3, 4]
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(compiling.STAGES)
    numbers = [f" compiling {k} of {len(lines)}" for k in range(1, len(lines) + 1)]
    assert [line.split(":")[1] for line in lines] == numbers
    assert len(lines) == 4
