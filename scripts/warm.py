"""`coilset compile`: what a first run would compile, compiled before it."""

from mpi4py import MPI

from coilset.model.analysis import Analysis
from coilset.model.case import read_case
from coilset.model.examples import EXAMPLES

SHORT = ("mesh.elements_per_turn=8", "loading=[{to: {travel: 14}, steps: 4}, {to: {force: 0}, steps: 1}]")


def warm() -> None:
    """Press the example until coils touch and the wire yields, and release it; nothing of it is kept."""
    Analysis(read_case(EXAMPLES / "ck15_presetting.yaml", SHORT), MPI.COMM_SELF).run()
