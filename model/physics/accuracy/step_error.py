"""What the length of the steps leaves wrong: an estimate after each step, and the size that the next one may have.

A finer path of the rod's sections gives the works of the error of their forces on the step's deformation, from which
the errors of the driven head's force and height follow, and on the first step's, which is elastic: what will be wrong
when the spring is released, the set. docs/theory/equilibrium.md ("Step size") derives them. What all steps together
leave shall not exceed the required accuracy: where more than half of it is used up, a step may bring in less, in
proportion to the rest.
"""

import math

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from coilset.model.core.body.state import Where
from coilset.model.core.equilibrium.newton.outcome import Estimate
from coilset.model.core.equilibrium.path.guess import Guess
from coilset.model.core.equilibrium.path.step_sizes import Path, Position
from coilset.model.core.equilibrium.settings import StepControl
from coilset.model.core.equilibrium.system.heads import Heads
from coilset.model.core.results import surface
from coilset.model.core.rod.section_states import CLOCKS
from coilset.model.physics.accuracy.finer_path import FinerPath
from coilset.model.physics.accuracy.next_touch import CROSSING, NEAR, SHORT, NextTouch

ORDER = 3
LEAST_REST = 0.2  # of what a step may bring in: it may do so even if nothing of the accuracy is left
CAUTION = 0.9  # factor on the size that the estimated error allows
LEAST_FACTOR = 0.25  # smallest factor on the length of a step after a large error, or when it is cut because of one
# what is remembered: maximum force, N, travel of the first step of all, mm, and how many contact elements are closed
GREATEST, FIRST, CLOSED = range(3)
# A spring is held where its height, over its free length, or its force, over the maximum, changes by no more; it
# is held to the accuracy of the equilibrium only.
STILL, STILL_FORCE = 1e-12, 1e-6
ELASTIC = 1e-6  # of what a step may bring in: the error of one in which no wire flows is rounding
ROUNDING = 1e-12  # of E A: forces up to there are none, as those of a free spring that is heated


class StepError:
    """Estimates for a spring between its heads.

    Args:
        control: Heads of the System of a rod.
        accuracy: required error of force, over the maximum force so far.
    """

    def __init__(self, control: Heads, accuracy: float, steps: StepControl) -> None:
        self.control, self.accuracy, self.steps, system = control, accuracy, steps, control.system
        self._rod = rod = system.line.rod
        self._touch = NextTouch(system)
        self._finer = FinerPath(rod.sections, rod.state, rod.points.bearing, rod.element, rod.comm)
        self._memory = system.state.add("step_error", np.zeros(3), Where.SHARED)
        system.state.add("rates", np.zeros(system.layout.size_local), Where.UNKNOWN)  # at the end of the last step

    def estimate(self, ratio: float, controls: bool, rate: PETSc.Vec | None = None) -> Estimate:
        """Judge the trial state, once, before it is committed or given up; collective.

        Args:
            ratio: size of the step over that of the one before it on the same path, 0 if there is none.
            controls: whether the step size is controlled by it. A kink then counts. In equal steps the errors of many
                kinks would not add up as those of the worst case.
            rate: of the increments at the end of the step, see `Newton.rate`; None if it is not known.
        """
        control, comm = self.control, self.control.system.comm
        memory, last = self._memory.trial, self._memory.equilibrium
        memory[CLOSED] = control.system.last.closed
        kinked = controls and memory[CLOSED] != last[CLOSED]
        along = None if rate is None else control.system.with_ghosts(rate.getArray(readonly=True))
        works = self._works(ratio, bool(kinked), not controls, along)
        if comm.size > 1:
            works = tuple(comm.allreduce(np.array(works)).tolist())
        (start, before), (end, force) = control.measured("equilibrium"), control.measured("trial")
        travel = end - start
        memory[GREATEST] = greatest = max(float(last[GREATEST]), abs(force))
        still, none = abs(travel) <= STILL * control.free_length, greatest <= ROUNDING * self._rod.axial_force
        if still or none or (self.takes_time() and abs(force - before) <= STILL_FORCE * greatest):
            return self._in_time(works, greatest, float(last[FIRST]))
        memory[FIRST] = last[FIRST] or travel
        error, new = works[0] / travel, works[1] / travel
        stiffness = (force - before) / travel
        share = self._share(new, works, float(memory[FIRST]), greatest)
        if math.isnan(share):
            return Estimate(math.nan, math.nan, 0.0, 1.0)
        return Estimate(error, error / stiffness if stiffness else math.nan, share, self._factor(share))

    def _works(self, ratio: float, kinked: bool, final: bool, rate: np.ndarray | None) -> tuple[float, ...]:
        """`FinerPath.works` of this rank at the end of a step; NaN if they are unknown."""
        rod = self._rod
        end = None if rate is None else rod.strain_rate(rate)
        if not self._finer.follow(rod.coefficients.s, ratio, kinked, final, end):
            return np.nan, np.nan, np.nan, np.nan
        return self._finer.works(np.linalg.norm(rod.state["chord"].trial, axis=1))

    def _share(self, new: float, works: tuple[float, ...], first: float, greatest: float) -> float:
        """The greater of the errors that the step brings in, at its height and what will be left, over what it may.

        Args:
            new: at its height, N.
            works: of `FinerPath.works`.
            first: travel of the first step of all, mm; greatest: maximum force so far, N.
        """
        left, before = works[2] / first, (works[3] - works[2]) / first
        rest = 2.0 * (1.0 - abs(before) / (self.accuracy * greatest))
        allowed = self.steps.step_share * self.accuracy * greatest
        return max(abs(new) / allowed, abs(left) / (allowed * min(max(rest, LEAST_REST), 1.0)))

    def takes_time(self) -> bool:
        """Does time pass in the trial step?"""
        state = self.control.system.state
        return "clock" in state and not np.array_equal(state["clock"].trial, state["clock"].equilibrium)

    def _in_time(self, works: tuple[float, ...], greatest: float, first: float) -> Estimate:
        """A held spring is deformed by no travel of its own; the first step of all shows what a travel does."""
        if greatest <= ROUNDING * self._rod.axial_force or first == 0.0 or not self.takes_time():
            return Estimate(math.nan, math.nan, 0.0, self.steps.growth)
        share = self._share(0.0, works, first, greatest)
        if math.isnan(share):
            return Estimate(math.nan, math.nan, 0.0, 1.0)
        error = works[3] / first if self._resolves_time(STILL_FORCE * greatest) else math.nan
        return Estimate(error, math.nan, share, self._factor(share))

    def _resolves_time(self, faint: float) -> bool:
        """Does the error of the step follow from its works? Forces up to `faint`, N, do not fall; collective."""
        comm = self.control.system.comm
        before, after = (max(abs(self.control.measured(when)[1]), faint) for when in ("equilibrium", "trial"))
        rod, fall = self._rod, max(math.log(before / after), 0.0)
        end, middle = (rod.state[name] for name in CLOCKS)
        stress = float(surface.equivalent(rod.surface_state, rod.sections.components).max(initial=0.0))
        resolves = rod.in_time.is_resolved((end.equilibrium, middle.trial, end.trial), stress, fall)
        return comm.allreduce(resolves, MPI.LAND) if comm.size > 1 else bool(resolves)

    def to_next_touch(self, guess: Guess, path: Path, position: Position, size: float) -> float:
        """Size of a step that ends just before something touches for the first time, or that crosses that; collective.

        It is where the guess shows it. Rotations are no straight path for a guess, and elastic wire needs no such step.

        Args:
            guess: of the last steps.
            path, position: where it begins.
            size: of the step if nothing touches, in regular steps.
        """
        if not position.share > ELASTIC:
            return size
        along = guess.along_path(path.load(position.done + size), position, path.step_length(position.done, size))
        if along is None or guess.carried:
            return size
        part = self._touch.part(along)
        if part == 1.0:
            return size
        short = SHORT * part * size
        return short if short > NEAR else min(size, CROSSING)

    def accept(self) -> None:
        """Go on from the end of the step that was judged, which is committed now."""
        self._finer.catch_up()

    def restart(self) -> None:
        """Go on from the last equilibrium, which was reached by steps that were not judged."""
        self._finer.restart()

    def _factor(self, share: float) -> float:
        steps = self.steps
        wanted = steps.growth if share == 0.0 else CAUTION * share ** (-1.0 / ORDER)
        return min(max(wanted, LEAST_FACTOR), steps.growth)
