"""`coilset compile`: compile in advance what a first run would compile."""

from mpi4py import MPI

from coilset.model.analysis import Analysis
from coilset.model.case import read_case
from coilset.model.design.surrogate import guess
from coilset.model.examples import EXAMPLES

LOADING = "loading=[{to: {travel: 16}, steps: 4}, {to: {force: 0}, steps: 1}]"
CREEPING = "loading=[{to: {force: 650}, steps: 2}, {hold: {hours: 1}, steps: 1}]"
SHORT = {"ck15_presetting.yaml": LOADING, "time/relaxation.yaml": CREEPING}  # examples, and what they go through


def warm() -> None:
    """Compress an example until coils touch and yield, release it, let one creep, press a uniform rod; keep nothing.

    What several threads do is compiled beside what one does: there are points enough for two, on the surface too.
    """
    mesh = "mesh.elements_per_turn=16"
    cases = [read_case(EXAMPLES / example, (mesh, loading)) for example, loading in SHORT.items()]
    for case in cases:
        for threads in (1, 2):
            Analysis(case, MPI.COMM_SELF, threads=threads).run()
    guess(cases[0], [])
