"""`coilset compile`: compile the kernels of a first run in advance."""

import contextlib
from collections.abc import Callable, Sequence

from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.examples import EXAMPLES
from coilset.model.core.base.errors import InputError
from coilset.model.core.base.package import package
from coilset.model.core.case import Case, read_case
from coilset.model.core.material import library
from coilset.model.core.material.law.law import Law
from coilset.scripts.compiling import STAGES, compiled

LOADING = "loading=[{to: {travel: 16}, steps: 4}, {to: {force: 0}, steps: 1}]"
CREEPING = "loading=[{to: {force: 650}, steps: 2}, {hold: {hours: 1}, steps: 1}]"
PRESSED, HELD = ("ck15_presetting.yaml", LOADING), ("time/relaxation.yaml", CREEPING)


def short_case(example: str, loading: str) -> Case:
    """An example in few elements with a load program."""
    coarse = ("mesh.elements_per_turn=10", "mesh.section.radial=2", "mesh.section.angular=8")
    return read_case(EXAMPLES / example, (*coarse, loading))


def warm(names: Sequence[str] = STAGES, report: Callable[[str], object] = lambda line: None) -> None:
    """Compile stages, and mark them as compiled.

    `rod`: the example is compressed until coils touch and yield, and released; `creep`: a spring creeps; `uniform`: a
    uniform rod is pressed, as designs do; `point`: a point of steel is twisted, as for the page of a run. Nothing is
    kept.

    Args:
        names: of STAGES.
        report: called with a line before each stage: the stage and the number of stages.
    """
    stages: dict[str, tuple[str, Callable[[], object]]] = {
        "rod": ("a spring that yields", lambda: _run(short_case(*PRESSED))),
        "creep": ("a spring that creeps", lambda: _run(short_case(*HELD))),
        "uniform": ("the uniform rod", lambda: _uniform(short_case(*PRESSED))),
        "point": ("a point of material", lambda: _point(library.load("ck15"))),
    }
    for number, name in enumerate(names, 1):
        words, stage = stages[name]
        report(f"coilset: compiling {number} of {len(names)}: {words}")
        with contextlib.suppress(InputError):  # a package that is not installed
            stage()
        with contextlib.suppress(OSError):  # nothing can be stored
            compiled(name).touch()


def _run(case: Case) -> None:
    Analysis(case, MPI.COMM_SELF).run()


def _uniform(case: Case) -> None:
    package("coilset.model.tools.design.surrogate", "a design").guess(case, [])


def _point(law: Law) -> None:
    curves = package("coilset.model.tools.figures.panels.material_curves", "a page")
    curves.there_and_back(law, law.reference_temperature)
