"""The thesis's convergence test (6.3.1), in one unit and with the balance of the whole body, and the outcome of a solve
in words."""

import math
from typing import NamedTuple

import numpy as np
from petsc4py import PETSc

from coilset.model.core.equilibrium.system.load import Load
from coilset.model.core.equilibrium.system.system import System
from coilset.model.core.runtime.kernels import njit

Reason = PETSc.SNES.ConvergedReason
REASONS = {value: name for name, value in vars(Reason).items() if isinstance(value, int)}
WORDS = {
    "DIVERGED_FNORM_NAN": "the residual is not a number, or the law found no stress",
    "DIVERGED_FUNCTION_NANORINF": "the residual is not a number, or the law found no stress",
    "DIVERGED_FUNCTION_DOMAIN": "the law found no stress",
    "DIVERGED_LINEAR_SOLVE": "the tangent is singular",
    "DIVERGED_MAX_IT": "no equilibrium within the maximum number of iterations",
    "DIVERGED_LINE_SEARCH": "the line search found no better state",
    "DIVERGED_DTOL": "the out-of-balance forces grow without bound",
    "DIVERGED_LOCAL_MIN": "the iteration stagnates: the out-of-balance forces no longer fall",
    "DIVERGED_TR_DELTA": "the iteration stagnates: the trust region has shrunk to nothing",
    "DIVERGED_INNER": "the preconditioning step found no state",
}

# Of what the supports carry: out-of-balance forces that no longer halve are in equilibrium up to here. Where points are
# at the yield surface or coils at the edge of contact, forces jump by some 1e-8, and a short step adds little more.
STALLED = 1e-7
# Where the iteration ends with more: some forces jump farther, as where a coil slips from one contact to the next.
LEFT = 1e-5


def reason_in_words(reason: int) -> str:
    """PETSc's reason for the end of a solve, in words."""
    name = REASONS.get(reason, str(reason))
    return WORDS.get(name, name)


class Imbalance(NamedTuple):
    """Distance of a state from equilibrium.

    Attributes:
        residual_norm: |r − f| of the out-of-balance forces, or their sum if that is larger, N. Moments count as forces
            at the end of an arm, the body's extent.
        change: norm of the change of loads and reactions since the step's start |²R − ²F|, N.
        carried: norm of the reactions at the supports, N.
        missed: part of the prescribed increments that is still missing.
    """

    residual_norm: float
    change: float
    carried: float
    missed: float

    @property
    def ratio(self) -> float:
        """Left side of (6.3.1)."""
        return self.residual_norm / self.change if self.change > 0.0 else np.inf


def imbalance(system: System, load: Load, F: PETSc.Vec) -> Imbalance:
    """Imbalance of the state evaluated last, which has the residual `F`; collective."""
    reactions, layout = system.state["reactions"], system.layout
    out, places = F.getArray(readonly=True), (layout.arms, layout.directions)
    sums = _sums(out, load.is_held, reactions.trial, reactions.equilibrium, load.supports, *places)
    if system.comm.size > 1:
        sums = system.comm.allreduce(sums)
    free, missed, change, carried = np.sqrt(sums[4:]).tolist()
    missed /= system.body.constraint_weight * (load.prescribed if load.prescribed > 0.0 else 1.0)
    whole = math.hypot(*sums[:3].tolist())
    return Imbalance(max(free, whole), change, carried, missed)


@njit(cache=True)
def _sums(
    F: np.ndarray,
    is_held: np.ndarray,
    reactions: np.ndarray,
    before: np.ndarray,
    supports: np.ndarray,
    arms: np.ndarray,
    directions: np.ndarray,
) -> np.ndarray:
    """Of the residual where nothing is held: x, y, z and all else; then squares: of the residual there, of that where
    something is held, of the reactions' change at the supports, and of these reactions."""
    sums = np.zeros(8)
    for i in range(len(F)):
        if is_held[i]:
            sums[5] += F[i] * F[i]
        else:
            sums[directions[i]] += F[i]
            sums[4] += (F[i] / arms[i]) ** 2
    for i in supports:
        sums[6] += ((reactions[i] - before[i]) / arms[i]) ** 2
        sums[7] += (reactions[i] / arms[i]) ** 2
    return sums


class EquilibriumTest:
    """(6.3.1): |r − f| / |²R − ²F| ≤ ε, and prescribed increments met; or the reason for giving up.

    Args:
        tolerance: ε.
        stagnation: number of iterations without a new minimum of the residual that count as stagnation.
    """

    def __init__(self, tolerance: float, stagnation: int) -> None:
        self.tolerance, self.stagnation = tolerance, stagnation
        self._first = self._least = self._last = np.inf
        self._least_at = 0

    def begin(self, norm: float, spurious: float = 0.0) -> None:
        """Begin a solve with the initial norm of the residual, and the size of spurious forces of corrections."""
        self._first, self._least, self._least_at = max(norm, spurious), norm, 0
        self._last = np.inf

    def is_met(self, found: Imbalance, tolerance: float, rounding: float) -> bool:
        """Whether it is an equilibrium to ε = `tolerance`, to `rounding`, N, or as near as the iteration comes."""
        residual, last = found.residual_norm, self._last
        self._last = residual
        if found.missed > self.tolerance:
            return False
        return residual <= max(tolerance * found.change, rounding) or 0.5 * last < residual <= STALLED * found.carried

    def is_near(self, found: Imbalance) -> bool:
        """Whether the last state of an iteration that has not converged may be taken for an equilibrium."""
        return found.missed <= self.tolerance and found.residual_norm <= LEFT * found.carried

    def is_lost(self, iteration: int, norm: float, divergence: float) -> int | None:
        """The reason to give up: a residual that has grown by the factor `divergence`, or no longer falls."""
        if norm > divergence * self._first:
            return Reason.DIVERGED_DTOL
        if norm < self._least:
            self._least, self._least_at = norm, iteration
        elif iteration - self._least_at >= self.stagnation:
            return Reason.DIVERGED_LOCAL_MIN
        return None
