"""Step length along a Newton correction when coils close and the wire yields.

Contacts and yielding make the residual non-smooth: its norm often grows over a full correction that is nevertheless
right, and a search for a smaller norm (PETSc's `bt`) then stalls. The criterion is instead the out-of-balance work
along the correction, s(λ) = y · F(x − λ y), as with Matthies and Strang: s falls from s(0) > 0 through zero at the
minimum of the energy.

A correction that presses coils deeply into each other is shortened to what the contacts allow, and the next one finds
them closed. If it was the one that meets the prescribed increments, equilibrium is found there first: the step is
solved in parts, see coilset.model.core.equilibrium.newton.newton.
"""

import math
from typing import NamedTuple

import numpy as np
from petsc4py import PETSc

from coilset.model.core.equilibrium.newton.contact_limit import ContactLimit
from coilset.model.core.equilibrium.system.load import Load
from coilset.model.core.equilibrium.system.system import System
from coilset.model.core.runtime.kernels import njit

ACCEPTED_WORK = 0.3  # |s(λ)/s(0)| up to which a full correction is accepted although the norm grows
SOUGHT_WORK = 0.7  # and at which the search for a zero of the work ends where something touches; else at ACCEPTED_WORK
SEARCH_TRIALS = 6  # maximum number of trials of that search
BRACKET_MARGIN = 0.15  # distance that a trial keeps from both ends of the bracket, of its width
BACKTRACK = 0.4  # factor on the step length where the work has no zero
STRESS_BACKTRACK = 0.25  # the same where the law finds no stress
SMALLEST_STEP_LENGTH = 0.05  # at which backtracking ends


class StepLength(NamedTuple):
    """Result of a line search.

    Attributes:
        contact_limit: factor of the correction that contacts allow.
        value: final factor of the correction, from the search for the zero of the work.
        ends_on_the_way: whether the step misses prescribed increments that the full correction would meet.
        only_spurious: whether it increases the spurious forces of finite rotations alone: without them, they decrease.
    """

    contact_limit: float
    value: float
    ends_on_the_way: bool
    only_spurious: bool


class WorkSearch:
    """Search for the zero of the out-of-balance work.

    Args:
        system: System; it is evaluated at the trial points.
        limit: ContactLimit.
    """

    def __init__(self, system: System, limit: ContactLimit) -> None:
        self.system, self.limit = system, limit
        # vectors around arrays, for it takes longer to ask a vector for its array than to go through it
        self._along, self._forces = (np.zeros(system.layout.size_local) for _ in range(2))
        self._direction, self._force = (system.layout.vector(values) for values in (self._along, self._forces))
        self._trial = system.layout.vector()

    def __call__(
        self, x: PETSc.Vec, y: PETSc.Vec, F: PETSc.Vec, load: Load, load_factor: float, predicts: bool, damped: bool
    ) -> StepLength:
        """Step length from `x` along −y, with the residual `F` at x; the three are not changed; collective.

        Args:
            x, y, F: increments, correction and residual.
            load, load_factor: the fraction of a load that is sought.
            predicts: whether the body predicts its section forces after the correction.
            damped: whether the correction is, see Damping: then any that goes downhill all along is right.
        """
        system = self.system
        self._x, self._load, self._load_factor, self._predicts = x, load, load_factor, predicts
        self._damped = damped
        system.evaluate(x)
        if predicts:
            system.predict(-y.getArray(readonly=True))
        allowed = self.limit.allowed(system.max_penetration)
        pending = load.misses(x.getArray(readonly=True), load_factor)
        y.copy(self._direction)
        limit, length, only_spurious = 1.0, 1.0, False
        work, norm = self._at(1.0)
        if system.max_penetration > allowed and (limit := self.limit.step_length(x, y, -1.0)) < 1.0:
            self._direction.scale(limit)
            work, norm = self._at(1.0)
        while work is None and length > SMALLEST_STEP_LENGTH:
            length *= STRESS_BACKTRACK
            work, norm = self._at(length)
        if work is not None and not pending:
            F.copy(self._force)
            start_work, start_norm = start = self._work_and_norm()
            if not self._is_right(start, work, norm):
                only_spurious = self._is_right(start, *self._without_second_order(limit, length))
                if not only_spurious:
                    crosses_zero = start_work > 0.0 > work
                    length = (
                        self._zero(start_work, length, work) if crosses_zero else self._back(start_norm, length, norm)
                    )
        return StepLength(limit, length, pending and limit * length < 1.0, only_spurious)

    def _is_right(self, start: tuple[float, float], work: float, norm: float) -> bool:
        """Whether norm or work of the forces have decreased."""
        downhill = self._damped and 0.0 < work <= start[0]
        return downhill or norm < start[1] or abs(work) <= ACCEPTED_WORK * abs(start[0])

    def _without_second_order(self, limit: float, length: float) -> tuple[float, float]:
        """Work and norm at the last evaluation, at `length`, without the spurious forces of finite rotations.

        In a slender rod these grow over a correction that is nevertheless right; the next one removes them.
        """
        if not self._predicts:
            return np.inf, np.inf
        self.system.first_order_residual(self._load, self._load_factor, limit * length, self._force)
        return self._work_and_norm()

    def _at(self, length: float) -> tuple[float | None, float]:
        """Work and norm of the forces on the free unknowns at `length`; None if the law finds no stress."""
        self._trial.waxpy(-length, self._direction, self._x)
        self.system.residual(self._trial, self._load, self._load_factor, self._force)
        if not self.system.last.has_stress:
            return None, np.inf
        return self._work_and_norm()

    def _work_and_norm(self) -> tuple[float, float]:
        """Work along the direction and norm of the forces on the free unknowns; collective."""
        found, comm = _work_and_square(self._forces, self._along, self._load.is_held), self.system.comm
        work, square = found if comm.size == 1 else comm.allreduce(np.array(found))
        return float(work), math.sqrt(square)

    def _zero(self, start_work: float, length: float, work: float) -> float:
        """Step length at which the work is near zero, by the Illinois rule.

        Where contacts close on the way, the work falls ever more steeply,
        and to find its zero well takes more states than it saves.
        """
        low, low_work, high, high_work, side = 0.0, start_work, length, work, 0
        sought = start_work * (SOUGHT_WORK if self.system.touches else ACCEPTED_WORK)
        for _trial in range(SEARCH_TRIALS):
            margin, secant = BRACKET_MARGIN * (high - low), (low * high_work - high * low_work)
            length = min(max(secant / (high_work - low_work), low + margin), high - margin)
            found, _ = self._at(length)
            if found is None:
                high, high_work = length, -start_work
                continue
            if abs(found) <= sought:
                break
            if found > 0.0:
                low, low_work, high_work, side = length, found, high_work * (0.5 if side > 0 else 1.0), 1
            else:
                high, high_work, low_work, side = length, found, low_work * (0.5 if side < 0 else 1.0), -1
        return length if found is not None else low or length  # where there is stress, if anywhere

    def _back(self, start_norm: float, length: float, norm: float) -> float:
        """Step length at which the norm is smaller than at the start, or the smallest that was found."""
        best = norm, length
        while length > SMALLEST_STEP_LENGTH and best[0] >= start_norm:
            length *= BACKTRACK
            best = min(best, (self._at(length)[1], length))
        return best[1]


@njit(cache=True)
def _work_and_square(forces: np.ndarray, direction: np.ndarray, is_held: np.ndarray) -> tuple[float, float]:
    """Of a rank's forces on the free unknowns: their work along a direction, and the sum of their squares."""
    work = square = 0.0
    for i in range(len(forces)):
        if not is_held[i]:
            work += forces[i] * direction[i]
            square += forces[i] * forces[i]
    return work, square
