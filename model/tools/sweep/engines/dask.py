"""Cases on a Dask cluster that is running, named by its scheduler."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from coilset.model.core.base.errors import InputError
from coilset.model.tools.sweep.engines.pool import Pool, Record, Task

CONNECT_SECONDS = 30


@contextmanager
def dask_pool(scheduler: str) -> Iterator[Pool]:
    """A pool over the workers of a Dask cluster. Each must have coilset and see the files that the sweep names.

    Args:
        scheduler: address such as `tls://host:8786`.

    Raises:
        ModuleNotFoundError: Dask is not installed.
        InputError: the scheduler does not answer or has no workers.
    """
    from distributed import Client

    try:
        client = Client(scheduler, timeout=CONNECT_SECONDS)
    except (OSError, ValueError) as error:
        raise InputError(f"no scheduler answers: {error}", "--scheduler", scheduler) from None
    with client:
        yield _pool(client)


def _pool(client: Any) -> Pool:
    workers = sum(client.nthreads().values())
    if not workers:
        raise InputError("this cluster has no workers yet; start some, then run the sweep again", "--scheduler")
    executor = client.get_executor(pure=False)
    return Pool(lambda tasks: executor.submit(evaluate_tasks, tasks), workers)


def evaluate_tasks(tasks: list[Task]) -> list[Record]:
    """In a Dask worker: the records of tasks, each solved on one rank."""
    from mpi4py import MPI

    from coilset.model.tools.sweep.evaluate import evaluate_in_worker

    return evaluate_in_worker(tasks, MPI.COMM_SELF)
