"""`coilset compile`: compile in advance what a first run would compile."""

from collections.abc import Callable
from functools import partial

from mpi4py import MPI

from coilset.model.case import Case, read_case
from coilset.model.design.surrogate import guess
from coilset.model.figures.panels.material_curves import there_and_back
from coilset.model.material import library
from coilset.model.run.analysis import Analysis
from coilset.model.run.examples import EXAMPLES

LOADING = "loading=[{to: {travel: 16}, steps: 4}, {to: {force: 0}, steps: 1}]"
CREEPING = "loading=[{to: {force: 650}, steps: 2}, {hold: {hours: 1}, steps: 1}]"
PRESSED, HELD = ("ck15_presetting.yaml", LOADING), ("time/relaxation.yaml", CREEPING)


def short_case(example: str, loading: str) -> Case:
    """An example in few elements, and what it goes through."""
    return read_case(EXAMPLES / example, ("mesh.elements_per_turn=16", loading))


def warm(report: Callable[[str], object] = lambda line: None) -> None:
    """Compress an example until coils touch and yield, release it, let one creep, press a uniform rod; keep nothing.

    One point of steel is twisted, too, as for the page of a run.

    What several threads do is compiled beside what one does: there are points enough for two, on the surface too.

    Args:
        report: called with a line before each stage: what is compiled, and how many stages there are.
    """
    cases = {"a spring that yields": short_case(*PRESSED), "a spring that creeps": short_case(*HELD)}
    law = library.load("ck15")
    stages: dict[str, Callable[[], object]] = {
        f"{name}, {threads} thread{'s' * (threads > 1)}": partial(_run, case, threads)
        for name, case in cases.items()
        for threads in (1, 2)
    }
    stages["the uniform rod"] = partial(guess, next(iter(cases.values())), [])
    stages["a point of material"] = partial(there_and_back, law, law.reference_temperature)
    for number, (name, stage) in enumerate(stages.items(), 1):
        report(f"coilset: compiling {number} of {len(stages)}: {name}")
        stage()


def _run(case: Case, threads: int) -> None:
    Analysis(case, MPI.COMM_SELF, threads=threads).run()
