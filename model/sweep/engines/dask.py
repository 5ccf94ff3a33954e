"""Cases on a Dask cluster: one that is running, named by its scheduler, or processes of this machine."""

import logging
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from coilset.model.base.errors import InputError
from coilset.model.sweep.engines.pool import Pool, Record, Task

CONNECT_SECONDS = 30
NO_PAGES: dict[str, list[str]] = {"distributed.scheduler.http.routes": [], "distributed.worker.http.routes": []}
"""Scheduler and workers have servers of pages, which cannot be turned off; these have no pages."""
MAKE_KEY = "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 30 -subj /CN=coilset"


@contextmanager
def dask_pool(scheduler: str | None, jobs: int) -> Iterator[Pool]:
    """A pool over the workers of a Dask cluster. Each must have coilset and see the files that the sweep names.

    Args:
        scheduler: address such as `tls://host:8786`; None starts a cluster on this machine.
        jobs: number of its processes, if one is started.

    Raises:
        InputError: Dask is not installed, or the scheduler does not answer or has no workers.
    """
    try:
        import dask
        from distributed import Client, LocalCluster
    except ImportError:
        raise InputError("needs the package distributed (Dask)", "--engine") from None
    if scheduler is None:
        # nothing of a case can be shared by threads: PETSc and the compiled kernels use one per process
        own = {"n_workers": jobs, "threads_per_worker": 1, "dashboard_address": None, "silence_logs": logging.ERROR}
        with (
            dask.config.set(NO_PAGES),
            LocalCluster(protocol="tls://", security=_own_key(), **own) as cluster,
            Client(cluster) as client,
        ):
            client.wait_for_workers(jobs)
            yield _pool(client)
        return
    try:
        client = Client(scheduler, timeout=CONNECT_SECONDS)
    except (OSError, ValueError) as error:
        raise InputError(f"no scheduler answers: {error}", "--scheduler", scheduler) from None
    with client:
        yield _pool(client)


def _own_key() -> Any:
    """Dask's Security with a key and its certificate of this sweep's alone: who has them not is refused.

    Whoever reaches a scheduler can have it run code, and its port is open to all users of the machine.

    Raises:
        InputError: if there is no openssl to make them.
    """
    from distributed.security import Security

    with TemporaryDirectory() as folder:
        key, certificate = Path(folder, "key"), Path(folder, "certificate")
        try:
            command = [*MAKE_KEY.split(), "-keyout", str(key), "-out", str(certificate)]
            subprocess.run(command, check=True, capture_output=True)
        except (OSError, subprocess.CalledProcessError):
            raise InputError(
                "dask needs the program openssl, to make a key; give --engine processes", "--engine"
            ) from None
        parts = {"key": key.read_text(encoding="ascii"), "cert": certificate.read_text(encoding="ascii")}
    of_roles = {
        f"tls_{role}_{part}": text for role in ("client", "scheduler", "worker") for part, text in parts.items()
    }
    return Security(require_encryption=True, tls_ca_file=parts["cert"], **of_roles)


def _pool(client: Any) -> Pool:
    workers = sum(client.nthreads().values())
    if not workers:
        raise InputError("this cluster has no workers yet; start some, then run the sweep again", "--scheduler")
    executor = client.get_executor(pure=False)
    return Pool(lambda tasks: executor.submit(evaluate_tasks, tasks), workers)


def evaluate_tasks(tasks: list[Task]) -> list[Record]:
    """In a Dask worker: the records of tasks, each solved on one rank."""
    from mpi4py import MPI

    from coilset.model.sweep.evaluate import evaluate_in_worker

    return evaluate_in_worker(tasks, MPI.COMM_SELF)
