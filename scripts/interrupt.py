"""Ctrl-C during a solve: the step in progress is finished, then the run ends; a second Ctrl-C ends it at once."""

import os
import signal

from mpi4py import MPI


class Interrupt:
    """Context in which Ctrl-C (or a batch system's SIGTERM) is noted; `check` raises KeyboardInterrupt on all ranks.

    PETSc's callbacks are no place for an exception out of nowhere: between steps the state is whole.
    """

    def __init__(self, comm, say):
        self.comm, self.say, self.noted = comm, say, False

    def _note(self, number, frame):
        if self.noted:
            os._exit(128 + number)  # the last checkpoint is whole whatever happens
        self.noted = True
        self.say("finishing this step; once more ends at once")

    def __enter__(self):
        self.before = {number: signal.signal(number, self._note) for number in (signal.SIGINT, signal.SIGTERM)}
        return self

    def __exit__(self, *_):
        for number, handler in self.before.items():
            signal.signal(number, handler)

    def check(self):
        """Raise KeyboardInterrupt if any rank was interrupted; collective."""
        noted = self.noted if self.comm.size == 1 else self.comm.allreduce(self.noted, op=MPI.LOR)
        if noted:
            raise KeyboardInterrupt
