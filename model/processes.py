"""Processes that a command starts: they end with it, however it ends."""

import ctypes
import os
import signal
import sys
from pathlib import Path

PR_SET_PDEATHSIG = 1  # of Linux's prctl
MPI_SETTINGS = {  # of Open MPI; other kinds of MPI allow more ranks than cores by themselves and read none of these
    "OMPI_MCA_btl": "self,sm",  # ranks of one machine talk through memory
    "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
}


def end_with_parent() -> None:
    """Have the kernel kill this process (SIGKILL) when the one that started it is gone; does nothing but on Linux.

    A process that is killed can tell nobody: whoever it started has to watch for itself. The wish outlives `exec`,
    and it is the thread that started this process whose end counts.
    """
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


def mpirun(ranks: int) -> list[str]:
    """The words before a command that is to run on some ranks: the mpirun that belongs to this Python."""
    beside = Path(sys.executable).parent / "mpirun"
    return [str(beside) if beside.exists() else "mpirun", "-n", str(ranks)]


def mpi_environment() -> dict[str, str]:
    """Environment for `mpirun`: this process's own, with MPI_SETTINGS unless the user has set them."""
    return MPI_SETTINGS | os.environ


def first_rank() -> bool:
    """Whether this is rank 0 of a job, or no job at all; known before MPI is started, from what mpirun has set."""
    return _told(("OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK"), 0) == 0


def number_of_ranks() -> int:
    """Ranks of the job, 1 where there is none; known before MPI is started, from what mpirun has set."""
    return _told(("OMPI_COMM_WORLD_SIZE", "PMI_SIZE"), 1)


def _told(names: tuple[str, ...], otherwise: int) -> int:
    """The number in the first of these variables of the environment that there is."""
    return int(next((os.environ[name] for name in names if name in os.environ), otherwise))
