"""One step to equilibrium: SNES with the convergence test of the thesis (6.3.1)."""

from dataclasses import dataclass

import numpy as np
from petsc4py import PETSc

from coilset.model.solvers.methods import options

REASONS = {value: name for name, value in vars(PETSc.SNES.ConvergedReason).items() if isinstance(value, int)}
WORDS = {
    "DIVERGED_FNORM_NAN": "the residual is not a number, or the law found no stress",
    "DIVERGED_FUNCTION_DOMAIN": "the law found no stress",
    "DIVERGED_LINEAR_SOLVE": "the tangent is singular",
    "DIVERGED_MAX_IT": "no equilibrium within the greatest number of iterations",
    "DIVERGED_LINE_SEARCH": "the line search found no better state",
    "DIVERGED_DTOL": "the out-of-balance forces grow without bound",
}


@dataclass(frozen=True)
class Outcome:
    """How a step ended: converged or not, iterations, factorisations, reason in words, ratio of (6.3.1)."""

    converged: bool
    iterations: int
    reason: str
    ratio: float


class Solver:
    """SNES for a System.

    Args:
        system: System.
        method: a key of coilset.model.solvers.methods.METHODS.
        tolerance: ε of (6.3.1).
        greatest: greatest number of iterations.
        extra: PETSc options of the user.
    """

    prefix = "coilset_"

    def __init__(self, system, method="newton", tolerance=1e-7, greatest=30, extra=None):
        self.system, self.tolerance, self.ratio = system, tolerance, np.inf
        self.X, self.F, self.A = system.vector(), system.vector(), system.matrix()
        self.snes = snes = PETSc.SNES().create(system.comm)
        snes.setOptionsPrefix(self.prefix)
        database = PETSc.Options(self.prefix)
        for key, value in options(method, system.comm.size, extra).items():
            database[key] = value
        snes.setFunction(system.residual, self.F)
        snes.setJacobian(system.tangent, self.A)
        snes.setFromOptions()
        snes.setTolerances(max_it=greatest)
        snes.setConvergenceTest(self._test)

    def _test(self, snes, iteration, norms):
        """|r − f| / |²R − ²F(step start)| ≤ ε (6.3.1): the change of loads and reactions is the measure."""
        if not np.isfinite(norms[2]):
            return PETSc.SNES.ConvergedReason.DIVERGED_FNORM_NAN
        rest, change, missed = self.system.imbalance(self.F)
        self.ratio = rest / change if change > 0.0 else np.inf
        if missed <= self.tolerance and rest <= max(self.tolerance * change, self.system.rounding(self.X)):
            return PETSc.SNES.ConvergedReason.CONVERGED_FNORM_RELATIVE
        if iteration >= snes.getTolerances()[3]:
            return PETSc.SNES.ConvergedReason.DIVERGED_MAX_IT
        return PETSc.SNES.ConvergedReason.ITERATING

    def solve(self, guess=None):
        """Solve one step from the increments `guess` (zero if None); the system is left at the last iterate.

        Returns:
            Outcome.
        """
        if guess is None:
            self.X.set(0.0)
        else:
            guess.copy(self.X)
        self.ratio = np.inf
        self.snes.solve(None, self.X)
        reason = self.snes.getConvergedReason()
        name = REASONS.get(reason, str(reason))
        return Outcome(reason > 0, self.snes.getIterationNumber(), WORDS.get(name, name), self.ratio)
