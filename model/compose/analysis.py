"""From a case to its records: the load program, the working states after it, and the errors of the numbers."""

from collections.abc import Callable

from mpi4py import MPI

from coilset.model.compose.load_history import FurtherContacts, LoadHistory, Save
from coilset.model.compose.parts import installed
from coilset.model.core.base.package import package
from coilset.model.core.case import Case
from coilset.model.core.equilibrium.path.step_sizes import StepSizes
from coilset.model.core.material.law.law import Law
from coilset.model.core.results.records.record import Result, Step

WORKING = "coilset.model.tools.further_runs.working"  # the door to what a case asks for beyond its load program


class Analysis(LoadHistory):
    """A spring with all that is computed of it, ready to run.

    Args:
        estimates: estimate the errors of mesh, section and contact at the end of a run, see
            coilset.model.tools.further_runs.error_estimates; never with `accuracy: none` or further contacts.
        case, comm, detailed, threads, law, contacts, steps: as in LoadHistory.
    """

    def __init__(
        self,
        case: Case,
        comm: MPI.Comm = MPI.COMM_WORLD,
        detailed: bool = True,
        threads: int = 1,
        estimates: bool = True,
        law: Law | None = None,
        contacts: FurtherContacts | None = None,
        steps: type[StepSizes] = StepSizes,
    ) -> None:
        super().__init__(case, comm, detailed, threads, law, contacts, steps)
        wanted = estimates and case.steps_error is not None and contacts is None
        further = installed("tools.further_runs.error_estimates") if wanted else None
        self._estimated = None if further is None else further.estimated
        self._working = package(WORKING, "a working state", "working").working_states if case.working else None

    def run(
        self,
        report: Callable[[Step], object] = lambda step: None,
        save: Save | None = None,
        touched: Callable[[], object] = lambda: None,
    ) -> Result:
        """The load program, as `LoadHistory.run`, then the working states and the errors; collective."""
        super().run(report, save, touched)
        if self._working is not None:
            self.recorder.add_working(self._working(self))
        self.recorder.end(self.result if self._estimated is None or not self.result.steps else self._estimated(self))
        return self.result


def run_within_accuracy(first: Analysis, run: Callable[[Analysis, str], object]) -> Analysis:
    """Run an analysis, and again finer until its errors are within its accuracy, where that is installed; collective.

    Args:
        first: Analysis.
        run: runs one; the words say how the finer one differs, and are empty of the first.

    Returns:
        The last Analysis.
    """
    refinement = installed("tools.further_runs.refinement")
    if refinement is None:
        run(first, "")
        return first
    last: Analysis = refinement.within_accuracy(first, run)
    return last
