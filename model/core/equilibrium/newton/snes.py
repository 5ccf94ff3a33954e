"""PETSc's SNES with the options of a method, under a prefix of its own that leaves no trace in PETSc's database."""

import itertools
import weakref
from collections.abc import Callable, Collection, Mapping
from typing import Any

from mpi4py import MPI
from petsc4py import PETSc

from coilset.model.core.base.errors import InputError

numbers = itertools.count()


class SnesFactory:
    """Makes SNES solvers for one residual and tangent.

    Args:
        comm: MPI communicator.
        residual: SNES callback (snes, X, F).
        tangent: SNES callback (snes, X, J, P).
        F: vector of the residual.
        matrix: of the tangent.

    PETSc keeps its callbacks out of Python's sight, so they should hold their owner weakly.
    """

    def __init__(
        self, comm: MPI.Comm, residual: Callable[..., Any], tangent: Callable[..., Any], F: PETSc.Vec, matrix: PETSc.Mat
    ) -> None:
        self.comm, self.residual, self.tangent, self.F, self.matrix = comm, residual, tangent, F, matrix
        self.prefix = f"coilset_{next(numbers)}_"
        self._keys: dict[str, set[str]] = {}  # of each part, in PETSc's database
        weakref.finalize(self, _forget_all, self._keys).atexit = False

    def make(self, part: str, settings: Mapping[str, Any], of_the_user: Collection[str] = ()) -> PETSc.SNES:
        """A SNES with PETSc's options `settings`, in place of the one that was made for this `part` before.

        Raises:
            InputError: if PETSc refuses an option.
        """
        database, keys = PETSc.Options(), self._keys.setdefault(part, set())
        forget(keys)  # of the one before: it had options that this one leaves to PETSc
        for key, value in settings.items():
            database[self.prefix + part + key] = value
            if key not in of_the_user:  # those stay, so that PETSc reports at its end which it has not used
                keys.add(self.prefix + part + key)
        snes = PETSc.SNES().create(self.comm)
        snes.setOptionsPrefix(self.prefix + part)
        snes.setFunction(self.residual, self.F)
        snes.setJacobian(self.tangent, self.matrix)
        try:
            snes.setFromOptions()
        except PETSc.Error as error:
            raise InputError(f"PETSc refuses an option: {str(error).splitlines()[-1]}", "solver.options") from None
        return snes


def solve(snes: PETSc.SNES, b: PETSc.Vec | None, x: PETSc.Vec) -> None:
    """Solve; an interruption that came during a callback stays one, where PETSc makes an error of it.

    Raises:
        KeyboardInterrupt: on Ctrl-C.
    """
    try:
        snes.solve(b, x)
    except PETSc.Error as error:
        cause: BaseException | None = error
        while cause is not None:
            if isinstance(cause, KeyboardInterrupt):
                raise KeyboardInterrupt from None
            cause = cause.__cause__ or cause.__context__
        raise


def forget(keys: set[str]) -> None:
    """Take options out of PETSc's database."""
    database = PETSc.Options()
    while keys:
        database.delValue(keys.pop())


def _forget_all(parts: Mapping[str, set[str]]) -> None:
    for keys in parts.values():
        forget(keys)
