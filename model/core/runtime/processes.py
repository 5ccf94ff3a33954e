"""Processes that a command starts: they end with it, however it ends."""

import contextlib
import ctypes
import functools
import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

PR_SET_PDEATHSIG = 1  # of Linux's prctl


def end_with_parent() -> None:
    """Have the kernel kill this process (SIGKILL) when the one that started it is gone; does nothing but on Linux.

    A killed process cannot end the processes that it started, so each has to watch its parent. The setting survives
    `exec`, and it refers to the thread that started this process.
    """
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


def mpirun(ranks: int) -> list[str]:
    """The words before a command that is to run on some ranks: the mpirun that belongs to this Python."""
    beside = Path(sys.executable).parent / "mpirun"
    return [str(beside) if beside.exists() else "mpirun", "-n", str(ranks)]


@functools.cache
def _open_mpi() -> int:
    """The version of this mpirun, where it is Open MPI's; else 0."""
    said = subprocess.run([*mpirun(1)[:1], "--version"], capture_output=True, text=True, check=False).stdout
    version = re.search(r"Open MPI\) (\d+)", said)
    return 0 if version is None else int(version[1])


@functools.cache
def mpi_settings() -> dict[str, str]:
    """Variables for Open MPI; other kinds of MPI allow more ranks than cores by themselves and read none of these."""
    loopback = {"PMIX_MCA_ptl_base_if_include": "lo"} if Path("/sys/class/net/lo").exists() else {}
    return loopback | {
        "OMPI_MCA_btl": "self,sm",  # ranks of one machine communicate through memory
        # A rank that waits gives its core away: where other programs run, the one that it waits for would else not be
        # served meanwhile.
        "OMPI_MCA_mpi_yield_when_idle": "1",
        f"PRTE_MCA_{'mapby' if _open_mpi() >= 6 else 'rmaps_default_mapping_policy'}": ":oversubscribe",
    }  # version 6 warns of the earlier name of the last


def stay_on_this_machine() -> None:
    """A process that is no rank of a job has Open MPI open no port; by itself it would on all interfaces."""
    if not any(name in os.environ for name in ("OMPI_COMM_WORLD_SIZE", "PMI_RANK", "PMI_SIZE", "PMIX_RANK")):
        os.environ.setdefault("OMPI_MCA_btl", "^tcp")


def mpi_environment() -> dict[str, str]:
    """Environment for `mpirun`: this process's own, with `mpi_settings` unless the user has set them.

    mpirun gives the ranks terminals of its own, on which they print colours; where these would go into a file, none.
    """
    return mpi_settings() | os.environ | ({} if sys.stdout.isatty() else {"TERM": "dumb"})


@contextlib.contextmanager
def folder_of_mpirun() -> Iterator[dict[str, str]]:
    """A folder for an mpirun's own files, removed afterwards, named in a variable of Open MPI.

    By itself it names that folder by its process number, and fails where a killed one has left a folder of that name.
    """
    import tempfile  # which commands on one rank need not load

    with tempfile.TemporaryDirectory(prefix="coilset-", ignore_cleanup_errors=True) as folder:
        yield {"PRTE_MCA_prte_tmpdir_base" if _open_mpi() >= 5 else "OMPI_MCA_orte_tmpdir_base": folder}


def first_rank() -> bool:
    """Whether this is rank 0 of a job, or no job at all; known before MPI is started, from what mpirun has set."""
    return _variable(("OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK"), 0) == 0


def number_of_ranks() -> int:
    """Ranks of the job, 1 where there is none; known before MPI is started, from what mpirun has set."""
    return _variable(("OMPI_COMM_WORLD_SIZE", "PMI_SIZE"), 1)


def _variable(names: tuple[str, ...], otherwise: int) -> int:
    """The number in the first of these variables of the environment that there is."""
    return int(next((os.environ[name] for name in names if name in os.environ), otherwise))


def usable_cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
