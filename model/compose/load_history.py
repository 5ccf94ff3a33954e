"""A spring goes through the load program of its case: the parts made by coilset.model.compose.build, step by step."""

import logging
import math
import weakref
from collections.abc import Callable, Sequence
from typing import Any, Protocol

import numpy as np
from mpi4py import MPI

from coilset.model.compose.build import (
    build_continuation,
    build_control,
    build_heat,
    build_method,
    build_newton,
    build_past,
    build_wire,
)
from coilset.model.compose.contacts import build_contacts, seats_at
from coilset.model.compose.parts import installed
from coilset.model.compose.recorder import Recorder
from coilset.model.compose.setup import build_setup
from coilset.model.compose.shape import LeastRise
from coilset.model.core.base.agreement import max_of_ranks
from coilset.model.core.base.entry import check_entries, shortened
from coilset.model.core.base.errors import InputError, SolveError
from coilset.model.core.base.package import package
from coilset.model.core.base.warning import Warning
from coilset.model.core.body.state import State
from coilset.model.core.case import Case
from coilset.model.core.case.material import case_law
from coilset.model.core.case.phases import AnyPhase, Phase, heads_of
from coilset.model.core.case.stages import stage_of
from coilset.model.core.case.targets import check_own_law, check_steps, check_targets, check_times, check_working
from coilset.model.core.contact.base import Contact
from coilset.model.core.contact.curve import CentreLine, WirePoints
from coilset.model.core.equilibrium.path.free_ends import FreeEnds
from coilset.model.core.equilibrium.path.program import LoadProgram, ProgramPosition, Stage, StepTaken
from coilset.model.core.equilibrium.path.step_sizes import StepSizes
from coilset.model.core.equilibrium.system.layout import LineLayout
from coilset.model.core.equilibrium.system.system import System
from coilset.model.core.material.law.law import Law
from coilset.model.core.results.files.checkpoint import Saved
from coilset.model.core.results.records.record import Result, Snapshot, Step
from coilset.model.core.results.records.releases import is_released

log = logging.getLogger("coilset.steps")
BALANCE = "coilset.model.physics.reactions.balance"
FurtherContacts = Callable[[WirePoints, np.ndarray], Sequence[Contact]]


class Save(Protocol):
    """Keeps the state after each step, as coilset.model.core.results.files.checkpoint.Checkpoint.save."""

    def __call__(self, state: State, layout: LineLayout, position: ProgramPosition, result: Result) -> object:
        """Keep it; collective."""
        ...


class LoadHistory:
    """A spring with its load program, ready to run; `Analysis` goes on where that ends.

    Args:
        case: Case (`coilset.model.core.case.read_case`, or built in Python).
        comm: MPI communicator.
        detailed: also record the seats' reactions and the wire after every step.
        threads: of each rank, see coilset.model.core.runtime.threads.
        law: in the place of the case's material; None: that.
        contacts: from the wire's points and the positions of the stations, shape (n, 3), mm, further kinds of contact.
        steps: how long steps are, StepSizes.

    Raises:
        InputError: if the spring or the material cannot be built.

    Attributes:
        setup: Setup of the records.
        result: Result up to now.
        threads: of each rank.
        further: law, contacts and steps as given, by their names.
        system, newton, control, program: the System of the Rod `rod`, its Newton, Heads and LoadProgram.
    """

    def __init__(
        self,
        case: Case,
        comm: MPI.Comm = MPI.COMM_WORLD,
        detailed: bool = True,
        threads: int = 1,
        law: Law | None = None,
        contacts: FurtherContacts | None = None,
        steps: type[StepSizes] = StepSizes,
    ) -> None:
        self.case, self.comm, self.threads = case, comm, threads
        self.further: dict[str, Any] = {"law": law, "contacts": contacts, "steps": steps}
        self.spring = spring = case.spring.build()
        self.law = case_law(case, spring) if law is None else law
        if self.law.keeps_direction is not None:
            check_own_law(case, self.law.keeps_direction)
        check_steps(case)
        check_targets(case, spring, self.law.G)
        check_working(case, spring, self.law.G)
        check_times(case, self.law)
        wire = build_wire(case, spring, self.law, comm, threads)
        self.rod = wire.rod
        self.heat = build_heat(case, self.rod)
        past = build_past(case, self.rod)
        seats = case.seats if case.ends == "seats" else None
        moving = frozenset(end for phase in case.loading for end in heads_of(phase))
        kinds = build_contacts(case.contact, seats, spring, wire.turns, self.rod.line.stations, self.law.E, moving)
        if contacts is not None:
            radius, lengths = 0.5 * spring.wire_diameter(wire.turns), np.diff(spring.arc_length(wire.turns))
            points = CentreLine(wire.turns, radius, lengths).points()
            kinds.extend(_contacts(contacts(points, self.rod.line.stations)))
        self.layout = LineLayout(self.rod)
        self.system = System(self.rod, self.layout, kinds, seats_at(spring.free_length))
        least_radius = float(wire.radius.min())
        self.newton = build_newton(case, self.system, least_radius)
        self.control = build_control(case, spring, self.system, wire.turns)
        judging = installed("physics.stability.stability")
        self.stability = None if judging is None else judging.Stability(self.newton.iteration)
        self.continuation = build_continuation(case, self.newton, self.control, self.stability, least_radius)
        me = weakref.proxy(self)  # that the end of an analysis frees it at once
        self.continuation.refusal, self.continuation.cause = lambda: me._passed(), lambda: me._gives_way()
        self.continuation.steps = steps(self.continuation.control)
        self.free_ends = FreeEnds(self.control, self.continuation, wire.turns, spring.turns)
        self.program = LoadProgram(self.control, self.continuation)
        self.setup = build_setup(case, spring, wire, kinds, past)
        self.recorder = Recorder(
            self.setup, LeastRise(wire.turns, spring), self.rod, self.system, self.control, self.stability, detailed
        )
        self.continuation.overshoots = self.recorder.overshoots

    @property
    def result(self) -> Result:
        """Results of the run so far."""
        return self.recorder.result

    def snapshot(self, name: str) -> Snapshot:
        """The spring in its present state, gathered on rank 0; collective."""
        return self.recorder.snapshot(name)

    def _passed(self) -> str | None:
        """The reason why the trial state is impossible (the heads have passed each other), or None; collective."""
        height, wire = self.control.trial_height, 2.0 * self.rod.largest_radius
        if height >= wire:
            return self.program.opened_too_far(self.control.trial_force)
        return f"the heads would be {height:.4g} mm apart, less than the wire's {wire:.4g} mm"

    def _gives_way(self) -> str:
        """Where and how the wire gives way most easily at the last equilibrium, in words; collective."""
        self.system.restore()
        where = "" if self.stability is None else self.stability.in_words(self.setup.turns)
        return "; ".join(reason for reason in (where, self._law_to_try()) if reason)

    def _law_to_try(self) -> str:
        """What else to try where the law may be why there is no equilibrium, in words; collective.

        κ Ť begins at once with flow: an increment along the yield surface meets another stiffness just outside of it.
        """
        work = self.rod.point_state[..., self.rod.sections.components.index("b")].max(initial=0.0)
        if not self.law.data.deviates_from_normality or max_of_ranks(self.rod.comm, work) == 0.0:
            return ""
        return (
            f"{self.law.name} deviates from normality, abruptly where wire is loaded along its yield surface: "
            "see whether it comes further with non_normality: none in a copy of the material"
        )

    def use_method(self, name: str) -> None:
        """Switch to another iteration method.

        Raises:
            InputError: if there is no such method, or PETSc rejects an option; the method is then unchanged.
        """
        self.newton.iteration.use(build_method(self.case, self.layout, name))

    # ---- the run ---------------------------------------------------------------------------------------------------

    def run(
        self,
        report: Callable[[Step], object] = lambda step: None,
        save: Save | None = None,
        touched: Callable[[], object] = lambda: None,
    ) -> Result:
        """Run the load program; a resumed analysis continues from its checkpoint; collective.

        Args:
            report: called with each converged Step.
            save: keeps the state after each step, see Checkpoint.save.
            touched: called after the first touch, which gives the initial rate.

        Returns:
            Result, also available as `self.result`, with all steps so far if the run is interrupted.

        Raises:
            SolveError: no equilibrium was found; the state is that of the last converged step.
        """
        try:
            if not self.result.snapshots:
                self.settle_coils()
                self.recorder.begin(self.initial_rate())
            touched()
            for number in range(self.program.number, len(self.case.loading)):
                for taken in self.program.run(self.stage(number)):
                    settled = self._flow_of_heat(number, taken)
                    step = self.recorder.record(number, settled, self.case.loading)
                    self._keep(save)
                    report(step)
                self._end_phase(self.program.stage.label)
                self.program.begin(number + 1)
                self._keep(save)
        except (SolveError, KeyboardInterrupt):
            self.system.restore()
            self.recorder.add_snapshot("last equilibrium")
            raise
        return self.result

    def _end_phase(self, name: str) -> None:
        """Record the spring at the end of a phase; one that is released is let go by its ends, too; collective."""
        if self.case.release == "held" or not is_released(self.setup, self.result.steps):
            self.recorder.add_snapshot(name)
            return
        with self.continuation.excursion():
            try:
                self.recorder.add_finished(name, self.free_ends.let_go())
                return
            except SolveError as error:
                log.info("the ends of the spring cannot be let go: %s", error)
        warning = Warning("held", name, "the spring finds no equilibrium when nothing holds it: its ends stay held")
        self.recorder.add_warning(warning)
        self.recorder.add_snapshot(name)

    def settle_coils(self) -> None:
        """Let coils that are wound onto each other carry the tension of their wire, without a load on the spring.

        Raises:
            SolveError: if they find no equilibrium.
        """
        if "initial_tension" not in self.case.past:
            return
        outcome = self.continuation.attempt(self.control.to_force(0.0))
        if not outcome.converged:
            raise SolveError(f"the wound coils find no equilibrium without load: {outcome.reason}")
        self.control.begin_here()
        self.program.begin(0)

    def _flow_of_heat(self, number: int, taken: StepTaken) -> StepTaken:
        """Let heat flow for the time that the last step took; the step, with what that cost."""
        phase = self.case.loading[number]
        if self.heat is not None and self.heat.creeps:
            self.heat.catch_up()
            return self.program.settle(taken)
        if self.heat is not None and isinstance(phase, Phase) and phase.seconds is not None:
            self.heat.advance(taken.part * phase.seconds)
        return taken

    def redirect(self, phase: Phase) -> None:
        """Change the target of the phase in progress; the case holds the new one from now on.

        Raises:
            InputError: if no spring can reach it, its steps are automatic and errors are not estimated, or it takes no
                time although heat flows; then nothing changes.
        """
        number = min(self.program.number, len(self.case.loading) - 1)
        loading = [phase if k == number else other for k, other in enumerate(self.case.loading)]
        case = check_entries(dict(self.case) | {"loading": loading}, Case)
        check_steps(case)
        check_targets(case, self.spring, self.law.G)
        self.case = case
        self.program.redirect(self.stage(number))

    def resume(self, saved: Saved) -> None:
        """Restore the state of a checkpoint; collective.

        Raises:
            InputError: if its arrays are not those of this analysis; then nothing changes.
        """
        self._check(saved)
        for name, field in self.system.state.items():
            self.layout.take(field, saved.arrays[name])
        self.system.restore()
        steps, continuation = saved.result.steps, self.continuation
        continuation.number, continuation.negative_pivots = len(steps), steps[-1].negative_pivots if steps else 0
        self.program.position = saved.position
        if saved.changed:
            self.program.begin(saved.position.stage)
        self.recorder.resume(saved.result)

    def _check(self, saved: Saved) -> None:
        """Reject arrays that are missing, of another shape, or not finite; collective."""
        expected = {name: self.layout.natural(field) for name, field in self.system.state.items()}
        problem, like = None, self.snapshot("like")
        if self.comm.rank == 0:
            pairs = [(name, saved.arrays.get(name), values) for name, values in expected.items()]
            pairs += [
                (f"{shot.name}: {name}", getattr(shot, name), values)
                for shot in saved.result.snapshots
                for name, values in vars(like).items()
                if isinstance(values, np.ndarray)
            ]
            problem = next(
                (
                    name
                    for name, found, values in pairs
                    if found is None or found.shape != values.shape or not np.isfinite(found).all()
                ),
                None,
            )
        problem = self.comm.bcast(problem)
        if problem:
            raise InputError(
                "the checkpoint's array is missing or not of this spring; use --overwrite instead of "
                "--resume to start again",
                problem,
            )

    def stage(self, number: int, loading: Sequence[AnyPhase] = ()) -> Stage:
        """A phase of the case, or of another `loading`, by its number, in the form that the load program expects."""
        timeless = self.heat is not None and not self.heat.creeps  # heat flows after each step
        return stage_of(loading or self.case.loading, number, self.spring, timeless)

    def _keep(self, save: Save | None) -> None:
        if save is not None:
            save(self.system.state, self.layout, self.program.position, self.result)

    def initial_rate(self) -> float:
        """Force over the shortening of the wire from tip to tip, at a thousandth of the free length, N/mm; collective.

        NaN if no equilibrium is found there: the load program uses other steps and may still succeed.
        """
        x = self.system.state["x"]
        travel = self.continuation.control.probe * self.spring.free_length
        tips = [station for station, _ in self.control.tips.values()]
        before = np.ptp(self.layout.gather(x.equilibrium)[tips, 2])
        outcome, (force, after) = self.continuation.probe(
            self.control.to_height(self.control.height - travel),
            lambda: (self.control.trial_force, np.ptp(self.layout.gather(x.trial)[tips, 2])),
        )
        if not outcome.converged:
            log.warning("the initial rate is unknown: no equilibrium at the first touch (%s)", outcome.reason)
            return math.nan
        return float(force / (before - after))

    def imbalance(self) -> tuple[float, float]:
        """Largest imbalance over all cuts now, N and N mm; see coilset.model.physics.reactions.balance; collective."""
        balance = package(BALANCE, "the balance of forces")
        found: tuple[float, float] = balance.imbalance(self.snapshot("balance"), self.system, self.control)
        return found


def _contacts(made: object) -> list[Contact]:
    """What a function has made of kinds of contact.

    Raises:
        InputError: it is no list of them.
    """
    if not isinstance(made, Sequence):
        raise InputError(f"gives a {type(made).__name__}; it must give a list of kinds of Contact", "contacts")
    other = [one for one in made if not isinstance(one, Contact)]
    if other:
        raise InputError(f"gives a list with {shortened(repr(other[0]))}, which is no kind of Contact", "contacts")
    return list(made)
