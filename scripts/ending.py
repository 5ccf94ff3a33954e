"""The end of the command, without Python taking itself apart.

Python frees each module and each object before it ends, which takes half a second after a solve and frees nothing that
the system would not. What matters is done as ever: functions that libraries have registered, PETSc's word on options
that it did not know, the end of MPI.
"""

import atexit
import os
import sys

from coilset.model.runtime.switches import enabled


class Ending:
    """Ends the process once all else that is registered has run.

    Attributes:
        status: exit code.
    """

    def __init__(self) -> None:
        self.status = 1
        atexit.register(self._end)  # those registered first run last

    def _end(self) -> None:
        sys.stdout.flush()
        sys.stderr.flush()
        if not enabled("ending"):
            return
        if "petsc4py.PETSc" in sys.modules:
            sys.modules["petsc4py.PETSc"]._finalize()
        if "mpi4py.MPI" in sys.modules:
            MPI = sys.modules["mpi4py.MPI"]
            if MPI.Is_initialized() and not MPI.Is_finalized():
                MPI.Finalize()
        os._exit(self.status)
