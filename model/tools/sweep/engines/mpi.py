"""Cases on the ranks of an MPI job, by mpi4py.futures: rank 0 leads, the others solve, one or several per case."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager

from mpi4py import MPI
from mpi4py.futures import MPICommExecutor

from coilset.model.core.base.errors import InputError
from coilset.model.tools.sweep.engines.pool import Pool, Record, Task
from coilset.model.tools.sweep.evaluate import evaluate_in_worker

_group: MPI.Comm = None  # communicator of the ranks that share a case with this one


def solve_in_group(tasks: list[Task]) -> list[Record]:
    """On the first rank of a group: pass the tasks to the group's other ranks, and solve them with these."""
    _group.bcast(tasks)
    return evaluate_in_worker(tasks, _group)


@contextmanager
def mpi_pool(comm: MPI.Comm, ranks_per_case: int) -> Iterator[Pool | None]:
    """A pool over the ranks of `comm`.

    Args:
        comm: communicator of the whole job.
        ranks_per_case: ranks that share a case.

    Yields:
        Pool on rank 0; None on the other ranks, and only after the sweep has ended.

    Raises:
        InputError: if the ranks cannot be divided in this way.
    """
    global _group
    groups = (comm.size - 1) // ranks_per_case
    if groups < 1:
        need = f"one leads, and {ranks_per_case} share a case"
        raise InputError(f"{comm.size} ranks are too few: {need}", "--ranks-per-case")
    if comm.rank:
        for number in (signal.SIGINT, signal.SIGUSR1):  # mpirun passes the former on as the latter
            signal.signal(number, signal.SIG_IGN)  # Ctrl-C is handled by the leading rank
    number = (comm.rank - 1) // ranks_per_case  # of this rank's group; -1 for the leading rank
    idle = number >= groups
    _group = comm.Split(number + 1 if not idle else groups + 1, comm.rank)
    first = _group.rank == 0 and not idle
    leaders = comm.Split(0 if first else 1, comm.rank)
    if first:
        with MPICommExecutor(leaders, root=0) as executor:
            yield None if executor is None else Pool(lambda tasks: executor.submit(solve_in_group, tasks), groups)
        _group.bcast(None)
    else:
        while not idle and (tasks := _group.bcast(None)) is not None:
            evaluate_in_worker(tasks, _group)
        yield None
