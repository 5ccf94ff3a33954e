"""Records of a run: an entry for each step, and the spring at the ends of its phases."""

import logging
import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from coilset.model.compose.parts import installed
from coilset.model.compose.run_warnings import step_warnings
from coilset.model.compose.shape import LeastRise, clearance
from coilset.model.core.base.agreement import max_of_ranks
from coilset.model.core.base.warning import Warning
from coilset.model.core.case.phases import AnyPhase, TimePhase
from coilset.model.core.equilibrium.newton.outcome import Outcome
from coilset.model.core.equilibrium.path.free_ends import Change
from coilset.model.core.equilibrium.path.program import StepTaken
from coilset.model.core.equilibrium.system.heads import Heads
from coilset.model.core.equilibrium.system.system import System
from coilset.model.core.results import surface
from coilset.model.core.results.records.axis import axis_offset
from coilset.model.core.results.records.record import (
    BucklingMode,
    Frame,
    Result,
    Setup,
    Snapshot,
    Step,
    Working,
)
from coilset.model.core.rod.rod import Rod

log = logging.getLogger("coilset.steps")


class Recorder:
    """Reads the last equilibrium and adds it to the result.

    Args:
        setup: of the records.
        rise: LeastRise of the spring.
        rod, system, control: of the analysis.
        stability: the Stability that judges its states; None: nothing does.
        detailed: record SeatReactions and Frames, too, and log warnings as soon as a step shows them.

    Attributes:
        result: the Result so far.
    """

    def __init__(
        self,
        setup: Setup,
        rise: LeastRise,
        rod: Rod,
        system: System,
        control: Heads,
        stability: Any | None,
        detailed: bool,
    ) -> None:
        self.setup, self.rod, self.system, self.control = setup, rod, system, control
        self.layout, self._stability, self._detailed = system.line, stability, detailed
        self._reactions = installed("physics.reactions.seat_reactions") if detailed else None
        self.result, self._least_rise = Result(), rise
        self._warned: set[str] | None = None  # names of the steps' warnings so far; None until they are requested

    def begin(self, rate: float) -> None:
        """Record the unloaded spring and its initial rate, N/mm, NaN if unknown; collective."""
        warnings = self.result.warnings
        if math.isnan(rate):
            problem = "the initial rate is unknown: no equilibrium was found at the first touch"
            warnings = (*warnings, Warning("initial rate", "start", problem))
        self.result = replace(self.result, rate=rate, snapshots=(self.snapshot("start"),), warnings=warnings)

    def resume(self, result: Result) -> None:
        """Continue with the result of a checkpoint."""
        self.result, self._warned = result, None

    def add_working(self, working: Working | None) -> None:
        """Record the finished spring at its working lengths."""
        self.result = replace(self.result, working=working)

    def end(self, result: Result) -> None:
        """The load program is complete, with this result."""
        self.result = replace(result, complete=True)

    def record(self, phase: int, taken: StepTaken, loading: Sequence[AnyPhase]) -> Step:
        """Add the last equilibrium to the result; collective.

        Args:
            phase: number of the phase; taken: the step that led there; loading: all phases.
        """
        x = self.layout.gather(self.rod.x)
        weakest = None if self._stability is None else self._stability.weakest_now(self.setup, self.result)
        greatest = max(self.result.greatest_force, abs(self.control.force))
        step = self._as_wrong_as_before(self.step(phase, taken, loading, x, weakest))
        lowest = self.result.mode
        if self._stability and weakest and (lowest is None or weakest.value < lowest.eigenvalue):
            displacements = self._stability.displacements(weakest.mode)
            mode = BucklingMode(step.travel_mm, step.force_N, weakest.value, x, displacements)
            self.result = replace(self.result, mode=mode)
        before, seats, frames = self.result, self.result.seats, self.result.frames
        if self._detailed:
            frames = (*frames, self._frame(x))
        if self._reactions is not None:
            given = (self.system, self.control, self.setup.turns, step.number, greatest, self.setup.force_line)
            seats = (*seats, self._reactions.seat_reactions(*given))
        self.result = replace(before, steps=(*before.steps, step), seats=seats, frames=frames)
        if self._detailed:
            self._announce(before)
        return step

    def step(
        self,
        phase: int,
        taken: StepTaken,
        loading: Sequence[AnyPhase],
        x: np.ndarray | None = None,
        weakest: Any | None = None,
    ) -> Step:
        """The last equilibrium, which is not recorded yet; collective.

        Args:
            phase, taken, loading: as in `record`.
            x: positions of the stations, shape (n, 3), mm; None: to be gathered.
            weakest: of the tangent; None if it was not requested.
        """
        x = self.layout.gather(self.rod.x) if x is None else x
        greatest = max(self.result.greatest_force, abs(self.control.force))
        height, force, outcome = self.control.height, self.control.force, taken.outcome
        pulls = self.setup.ends == "seats" and force < -self.rod.faint_force(greatest)
        lift_off = max(clearance(self.system, x), 0.0) if pulls else 0.0
        force_error, height_error = self._errors(outcome)
        return Step(
            number=taken.number,
            phase=phase,
            progress=taken.progress,
            seat_height_mm=height,
            travel_mm=self.setup.spring.free_length - height,
            force_N=0.0 if lift_off else force + 0.0,  # the pull of the tip springs is ignored; and zero has no sign
            iterations=outcome.iterations,
            evaluations=outcome.evaluations,
            failed_solves=outcome.failed_solves,
            cuts=taken.cuts,
            contacts=self.system.last.closed,
            penetration_mm=self.system.max_penetration,
            negative_pivots=outcome.negative_pivots,
            left_branch=int(outcome.left_branch),
            released_energy_Nmm=outcome.released,
            axis_offset_mm=self._axis_offset(x),
            least_eigenvalue=weakest.value if weakest else None,
            plastic_work_max_N_per_mm2=self._greatest_plastic_work(),
            lift_off_mm=lift_off,
            least_rise=self._least_rise.of(x),
            steps_force_error_N=force_error,
            steps_height_error_mm=height_error,
            hours=float(self.rod.clock[0]),
            temperature_K=self.rod.hottest,
            load_loss_percent=self._load_loss(phase, force, loading),
            turn_deg=math.degrees(self.control.turn),
            torque_Nmm=self.control.torque,
        )

    def _axis_offset(self, x: np.ndarray) -> float:
        return axis_offset(x, self.rod.line.stations, self.setup.turns)

    def overshoots(self) -> str | None:
        """Why the step to the trial state shall be shorter: the spring buckles in it; None if not; collective."""
        if self._stability is None:
            return None
        travel = self.setup.spring.free_length - self.control.trial_height
        offset = self._axis_offset(self.layout.gather(self.rod.x))
        why: str | None = self._stability.overshoots(self.setup, self.result, travel, self.control.trial_force, offset)
        return why

    def _announce(self, before: Result) -> None:
        """Log the warnings that the last step has brought; `before` is the result without it."""
        if self._warned is None:
            self._warned = {warning.name for warning in step_warnings(self.setup, before)}
        for warning in step_warnings(self.setup, self.result):
            if warning.name not in self._warned:
                log.warning("warning: %s", warning.message)
                self._warned.add(warning.name)

    def _frame(self, x: np.ndarray) -> Frame:
        """The wire at the last equilibrium, stations at `x`; collective."""
        around = self.setup.inside.shear_around(self.rod.surface_state, self.rod.sections.components)
        mean = around.mean(axis=1)
        return Frame(x, self.rod.line.in_order(mean.astype(np.float32)))

    def _greatest_plastic_work(self) -> float:
        """Maximum b* on the wire's surface at the last equilibrium, N/mm²; collective."""
        work = surface.component(self.rod.surface_state, self.rod.sections.components, "b")
        return max_of_ranks(self.system.comm, work.max(initial=0.0))

    def _load_loss(self, phase: int, force: float, loading: Sequence[AnyPhase]) -> float | None:
        """Percentage of the force lost since time began to pass at constant height; None if it does not."""

        def stays(number: int) -> bool:
            return isinstance(one := loading[number], TimePhase) and one.duration.keep == "height"

        if not stays(phase):
            return None
        before = next((step.force_N for step in reversed(self.result.steps) if not stays(step.phase)), 0.0)
        if abs(before) <= self.rod.faint_force(self.result.greatest_force):
            return None
        return 100.0 * (1.0 - force / before)

    def _errors(self, outcome: Outcome) -> tuple[float | None, float | None]:
        """Estimated errors of force and height due to the step size, N and mm; None if unknown."""
        if outcome.estimate is None:
            return None, None
        force, height = (
            value if math.isfinite(value) else None for value in (outcome.estimate.force, outcome.estimate.height)
        )
        return force, height

    def _as_wrong_as_before(self, step: Step) -> Step:
        """The step; one that changes nothing has the errors by the step size of the one before."""
        steps, radius = (*self.result.steps, step), 0.5 * self.setup.spring.mean_diameter
        if len(steps) == 1 or not step.rests(steps[-2], max(one.load(radius) for one in steps), radius):
            return step
        names = "steps_force_error_N", "steps_height_error_mm"
        return replace(step, **{name: getattr(steps[-2], name) for name in names})

    def add_snapshot(self, name: str) -> None:
        """Record the spring in its current state; collective."""
        self.result = replace(self.result, snapshots=(*self.result.snapshots, self.snapshot(name)))

    def add_finished(self, name: str, change: Change) -> None:
        """Record the spring that nothing holds, as it is now after a change; collective."""
        shot, held = self.snapshot(name), self.result.steps[-1]
        tails = self.setup.spring.has_tails  # then its length is that from point to point
        height = held.seat_height_mm + change.rise if tails else self.setup.outer_length(shot.x)
        turn = held.turn_deg + math.degrees(change.turn)
        shot = replace(shot, height=height, force=0.0, turn=turn, free=True)
        self.result = replace(self.result, snapshots=(*self.result.snapshots, shot))

    def add_warning(self, warning: Warning) -> None:
        """Record what no other record shows."""
        self.result = replace(self.result, warnings=(*self.result.warnings, warning))

    def add_finer(self, words: str) -> None:
        """Record what became of a finer run."""
        self.result = replace(self.result, finer=words)

    def snapshot(self, name: str) -> Snapshot:
        """The current state of the spring, gathered on rank 0; its force is that of the last step; collective."""
        force = self.result.steps[-1].force_N if self.result.steps else self.control.force
        rod = self.rod
        parts = (rod.coefficients.E, rod.coefficients.s, rod.point_state, rod.surface_state)
        cells = [rod.line.in_order(values) for values in parts]
        x, components = self.layout.gather(rod.x), rod.sections.components
        triads, resultants, state, surface = cells
        turn = math.degrees(self.control.turn)
        return Snapshot(name, self.control.height, force, x, triads, resultants, state, surface, components, turn)
