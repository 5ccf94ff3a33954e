"""`coilset -n`: which ranks are refused, and whose lines are kept."""

import io
import os
import subprocess
import sys
from pathlib import Path

import pytest

from coilset.model.core.base.errors import InputError
from coilset.model.core.runtime.processes import mpi_environment, mpirun, stay_on_this_machine
from coilset.scripts.ranks import RULER, MpirunMessages, check


def test_more_ranks_than_make_sense_are_refused(monkeypatch):
    monkeypatch.delenv("COILSET_MAX_RANKS", raising=False)
    cores = len(os.sched_getaffinity(0))
    check(4 * cores, "solve")
    with pytest.raises(InputError, match=f"{4 * cores + 1} ranks on {cores} cores; give at most {4 * cores}"):
        check(4 * cores + 1, "solve")
    monkeypatch.setenv("COILSET_MAX_RANKS", "5000")
    check(5000, "sweep")
    with pytest.raises(InputError, match="at most 5000"):
        check(5001, "sweep")


def test_commands_of_one_rank_are_refused_on_more():
    for command in ("mesh", "material", "verify", "bench", "test"):
        check(1, command)
        with pytest.raises(InputError, match=f"'{command}' works on one rank"):
            check(2, command)


def test_mpirun_s_own_words_are_kept_apart():
    target = io.BytesIO()
    messages = MpirunMessages(target)
    own = b"coilset: case.yaml: wrong\n"
    theirs = RULER + b"\nprterun detected that one or more processes exited\n   Exit code:    2\n" + RULER + b"\n"
    for piece in (own[:9], own[9:] + theirs[:100], theirs[100:], b"[vm:1] PMIX ERROR: lost\n", own):
        messages.write(piece)
    assert target.getvalue() == 2 * own
    messages.show()
    assert target.getvalue() == 2 * own + theirs + b"[vm:1] PMIX ERROR: lost\n"


def test_more_ranks_than_cores_start_without_a_word():
    """The setting that allows them is known to this mpirun, and is not an earlier name of which it would warn."""
    ranks = len(os.sched_getaffinity(0)) + 1
    done = subprocess.run(
        [*mpirun(ranks), "echo", "here"], env=mpi_environment(), capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "here\n" * ranks, "")


def test_each_mpirun_has_a_folder_of_its_own(tmp_path):
    """By itself it takes one named by its process number, and fails if a killed one has left that."""
    (tmp_path / "where.py").write_text(
        "import os\n"
        "from coilset.model.core.runtime.processes import first_rank\n"
        "if first_rank(): print(os.environ.get('PMIX_SERVER_TMPDIR', ''))\n"
    )
    (tmp_path / "own").mkdir()
    command = [sys.executable, "-m", "coilset.scripts", "-n", "2", "python", str(tmp_path / "where.py")]
    environment = os.environ | {"TMPDIR": str(tmp_path / "own")}
    found = [
        subprocess.run(command, capture_output=True, text=True, check=True, env=environment).stdout.strip()
        for _ in range(2)
    ]
    if not all(found):
        pytest.skip("another kind of MPI")
    folders = [Path(where).relative_to(tmp_path / "own").parts[0] for where in found]
    assert folders[0] != folders[1]
    assert all(folder.startswith("coilset-") for folder in folders)
    assert not list((tmp_path / "own").iterdir())


def test_ranks_print_colours_on_a_terminal_only(tmp_path):
    """mpirun gives them terminals of its own, whatever the command's own output is."""
    (tmp_path / "shout.py").write_text("from rich.console import Console\nConsole().print('[bold red]here[/]')\n")
    command = [sys.executable, "-m", "coilset.scripts", "-n", "2", "python", str(tmp_path / "shout.py")]
    seen = os.environ | {"TERM": "xterm-256color"}
    done = subprocess.run(command, capture_output=True, text=True, check=True, env=seen)
    assert done.stdout.split() == ["here", "here"]


LISTENING = """
from coilset.model.core.runtime.processes import stay_on_this_machine
stay_on_this_machine()
from mpi4py import MPI
import os
from pathlib import Path
MPI.COMM_WORLD.barrier()
mine = set()
for number in Path("/proc/self/fd").iterdir():
    try:
        mine.add(os.readlink(number).removeprefix("socket:[").removesuffix("]"))
    except OSError:
        pass
for kind in ("tcp", "tcp6"):
    rows = [row.split() for row in Path(f"/proc/net/{kind}").read_text().splitlines()[1:]]
    print(*(row[1] for row in rows if row[3] == "0A" and row[9] in mine), end="")
"""


@pytest.mark.parametrize("ranks", [1, 2])
def test_no_rank_listens(ranks, monkeypatch):
    """By itself Open MPI waits for other machines, on all interfaces, also with one rank."""
    monkeypatch.delenv("OMPI_MCA_btl", raising=False)
    start = mpirun(ranks) if ranks > 1 else []
    environment = mpi_environment() if ranks > 1 else os.environ
    command = [*start, sys.executable, "-c", LISTENING]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert done.stdout == ""


def test_a_job_of_the_users_own_mpirun_keeps_its_network(monkeypatch):
    """It may have ranks on other machines; so may a program that `coilset python` runs."""
    monkeypatch.delenv("OMPI_MCA_btl", raising=False)
    monkeypatch.setenv("OMPI_COMM_WORLD_SIZE", "2")
    stay_on_this_machine()
    assert "OMPI_MCA_btl" not in os.environ
