"""Collective error handling and reductions: an error on one rank is raised on all, which would wait otherwise."""

from collections.abc import Callable
from typing import TYPE_CHECKING, TypeVar

from coilset.model.core.base.errors import CoilsetError

if TYPE_CHECKING:  # a solve loads MPI in another thread meanwhile
    from mpi4py import MPI

Found = TypeVar("Found")


def on_first_rank(comm: "MPI.Comm", action: Callable[[], Found]) -> Found | None:
    """What `action` gives on rank 0, None elsewhere; collective.

    Raises:
        CoilsetError: that of the action, on every rank.
    """
    found, error = None, None
    if comm.rank == 0:
        try:
            found = action()
        except CoilsetError as problem:
            error = problem
    shared = comm.bcast(error and (type(error), str(error)))
    if error is not None:
        raise error
    if shared is not None:
        kind, text = shared
        raise kind(text)
    return found


def sum_of_ranks(comm: "MPI.Comm", value: float) -> float:
    """Sum of a value over all ranks; collective."""
    return comm.allreduce(float(value)) if comm.size > 1 else float(value)


def max_of_ranks(comm: "MPI.Comm", value: float) -> float:
    """Maximum of a value over all ranks; collective."""
    from mpi4py import MPI

    return comm.allreduce(float(value), op=MPI.MAX) if comm.size > 1 else float(value)
