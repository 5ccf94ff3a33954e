"""One step to equilibrium: SNES with the convergence test of the thesis (6.3.1)."""

import itertools
import logging
import weakref
from dataclasses import dataclass, replace

import numpy as np
from petsc4py import PETSc

from coilset.model.compat import NOT_A_NUMBER
from coilset.model.errors import InputError
from coilset.model.solvers.damping import Damping
from coilset.model.solvers.methods import ONE_STEP, check_method, options

log = logging.getLogger("coilset.steps")

Reason = PETSc.SNES.ConvergedReason
REASONS = {value: name for name, value in vars(Reason).items() if isinstance(value, int)}
WORDS = {
    "DIVERGED_FNORM_NAN": "the residual is not a number, or the law found no stress",
    "DIVERGED_FUNCTION_NANORINF": "the residual is not a number, or the law found no stress",
    "DIVERGED_FUNCTION_DOMAIN": "the law found no stress",
    "DIVERGED_LINEAR_SOLVE": "the tangent is singular",
    "DIVERGED_MAX_IT": "no equilibrium within the greatest number of iterations",
    "DIVERGED_LINE_SEARCH": "the line search found no better state",
    "DIVERGED_DTOL": "the out-of-balance forces grow without bound",
    "DIVERGED_LOCAL_MIN": "the iteration stagnates: the out-of-balance forces no longer fall",
    "DIVERGED_TR_DELTA": "the iteration stagnates: the trust region has shrunk to nothing",
    "DIVERGED_INNER": "the preconditioning step found no state",
}
PATIENCE = 25  # iterations without a new least residual: that is stagnation
ON_THE_WAY = 0.2  # ε of (6.3.1) for a part of a step
AUGMENTATIONS = 40  # of a step, at most
SMALLEST_PART = 0.1  # of a step; smaller ones are left to the step control
FIRST = {**ONE_STEP, "snes_linesearch_type": "basic"}
ARC = "newtonal"
FORGETFUL = ("newtonls", "newtontr")  # SNES types that keep nothing from one step to the next
numbers = itertools.count()


@dataclass(frozen=True)
class Outcome:
    """How a step ended.

    Attributes:
        converged: is it in equilibrium?
        iterations: new states; a first one that only meets the prescribed increments counts too.
        reason: in words.
        ratio: left side of (6.3.1).
        factorisations: tangents set up and factorised.
        evaluations: residuals evaluated.
    """

    converged: bool
    iterations: int
    reason: str
    ratio: float
    factorisations: int
    evaluations: int

    def __add__(self, following):
        """The outcome of two solves, one after the other."""
        counts = ("iterations", "factorisations", "evaluations")
        return replace(following, **{name: getattr(self, name) + getattr(following, name) for name in counts})


class Solver:
    """SNES for a System.

    Args:
        system: System.
        method: a key of coilset.model.solvers.methods.METHODS.
        tolerance: ε of (6.3.1).
        penetration: greatest penetration of guarded contacts, mm, that is let be; a greater one is worked off by
            augmented Lagrange: contacts are pressed harder by what they have sunk in, and the step is solved on.
        extra: PETSc options of the user, without a leading hyphen; they win over the method's. With
            `snes_convergence_test` PETSc's own test takes the place of (6.3.1).

    Raises:
        InputError: if there is no such method, or PETSc refuses an option.
    """

    def __init__(self, system, method="newton", tolerance=1e-7, extra=None, penetration=np.inf):
        self.system, self.tolerance, self.extra = system, tolerance, dict(extra or {})
        self.penetration = penetration
        self.X, self.F, self.load, self._balance = (system.vector() for _ in range(4))
        self.A = system.matrix()
        self.prefix, self._keys, self.snes = f"coilset_{next(numbers)}_", set(), None
        self.ratio, self.evaluations, self.factorisations = np.inf, 0, 0
        weakref.finalize(self, forget, self._keys).atexit = False
        # one Newton step that does nothing but meet the prescribed increments
        self._first = self._build("first_", options("newton", system.comm.size, FIRST))
        self.use(method)

    def use(self, method):
        """Go on with another method.

        Raises:
            InputError: as on construction; the method stays what it was.
        """
        check_method(method)
        # an arc by which every node moves by about the wire's radius
        arc = self.system.largest_radius * np.sqrt(len(self.system.station_dofs))
        step = {"snes_newtonal_step_size": arc} if method == "arc-length" else {}
        self._settings = options(method, self.system.comm.size, step | self.extra)
        self.method = method
        self._renew()

    def _renew(self):
        if self.snes is not None:
            self.snes.destroy()
        self.snes = self._build("", self._settings)
        if self.damped:
            self.snes.setLineSearchPreCheck(Damping(self.system, self.F))
        if "snes_convergence_test" not in self.extra:
            me = weakref.proxy(self)  # PETSc keeps its callbacks out of Python's sight: no cycle through them
            self.snes.setConvergenceTest(lambda *arguments: me._test(*arguments))

    @property
    def damped(self):
        """Are corrections scaled by Damping? They are not where the user names a line search of his own."""
        return self.method == "newton" and "snes_linesearch_type" not in self.extra

    def _start_at_rest(self, guess):
        """Go along the guess only as far as the contacts allow."""
        guess.copy(self.X)
        self.system.bring_to(self.X)
        if self.system.depth > self.system.allowed_depth(0.0):
            self.X.set(0.0)
            share = self.system.free_way(self.X, guess)
            guess.copy(self.X)
            self.X.scale(share)

    def _set_load(self):
        """What the step adds to loads and prescribed values: minus the residual at its start."""
        self.system.residual(self.snes, self.X, self.load)
        self.load.scale(-1.0)
        return self.load

    def _build(self, part, settings):
        """A SNES for the system's residual and tangent with the PETSc options `settings`."""
        prefix, me = self.prefix + part, weakref.proxy(self)
        database = PETSc.Options()
        for key, value in settings.items():
            database[prefix + key] = value
            if key not in self.extra:  # the user's stay, so that PETSc names those at its end which it did not know
                self._keys.add(prefix + key)
        snes = PETSc.SNES().create(self.system.comm)
        snes.setOptionsPrefix(prefix)
        snes.setFunction(lambda *arguments: me._residual(*arguments), self.F)
        snes.setJacobian(lambda *arguments: me._tangent(*arguments), self.A)
        try:
            snes.setFromOptions()
        except PETSc.Error as error:
            raise InputError(f"PETSc refuses an option: {str(error).splitlines()[-1]}", "solver.options") from None
        return snes

    def _residual(self, snes, X, F):
        self.evaluations += 1
        self.system.residual(snes, X, F)
        if snes.getType() == ARC:  # SNES takes its share of the load off: F(x) − λ load
            F.axpy(1.0, self.load)

    def _tangent(self, snes, X, J, P):
        self.factorisations += 1
        patterns = self.system.patterns
        done = self.system.tangent(snes, X, J, P)
        if self.system.patterns != patterns:  # PETSc may take the new matrix for one with the old pattern
            for each in (self.snes, self._first, *([self.snes.getNPC()] if self.snes.hasNPC() else [])):
                each.ksp.reset()
        return done

    def _test(self, snes, iteration, norms):
        """|r − f| / |²R − ²F(step start)| ≤ ε (6.3.1): the change of loads and reactions is the measure."""
        norm = norms[2]
        if iteration == 0:
            self._start, self._least = norm, (norm, 0)
        if not np.isfinite(norm):
            return NOT_A_NUMBER
        if iteration == 0 and snes.getType() == ARC:
            return Reason.ITERATING  # at the load share 0 every step is in equilibrium
        balance = self.F
        if snes.getType() != ARC:  # some methods call a preconditioned step their function: judge the forces themselves
            self.system.bring_to(self.X)
            balance = self._balance
            self.system.balance(self.X, balance)
        rest, change, missed = self.system.imbalance(balance)
        self.ratio = rest / change if change > 0.0 else np.inf
        tolerance = self.tolerance if self.system.share == 1.0 else ON_THE_WAY
        if missed <= self.tolerance and rest <= max(tolerance * change, self.system.rounding(self.X)):
            return Reason.CONVERGED_FNORM_RELATIVE
        if iteration >= snes.getTolerances()[3]:
            return Reason.DIVERGED_MAX_IT
        if snes.getType() != ARC:
            if norm > snes.getDivergenceTolerance() * self._start:
                return Reason.DIVERGED_DTOL
            if norm < self._least[0]:
                self._least = norm, iteration
            elif iteration - self._least[1] >= PATIENCE:
                return Reason.DIVERGED_LOCAL_MIN
        return Reason.ITERATING

    def solve(self, guess=None):
        """Solve one step from the increments `guess` (zero if None); the system is left at the last iterate.

        Returns:
            Outcome; its counts are those of all solves where contacts are augmented.
        """
        self.system.forget()
        outcome = self._solve(guess)
        for _attempt in range(AUGMENTATIONS):
            if not outcome.converged or self.system.depth <= self.penetration:
                return outcome
            self.system.augment()
            outcome = outcome + self._solve(self.X.copy())
        reason = f"a penetration of {self.system.depth:.3g} mm is left after {AUGMENTATIONS} augmentations"
        return replace(outcome, converged=False, reason=reason)

    def _solve(self, guess):
        self.ratio, self.evaluations, self.factorisations = np.inf, 0, 0
        self.system.share, self.system.fresh = 1.0, True
        kind, first, load = self.snes.getType(), 0, None
        if guess is None or kind == ARC:
            self.X.set(0.0)
        else:
            guess.copy(self.X)
            if self.damped:
                self._start_at_rest(guess)
        if kind not in FORGETFUL:
            self._renew()
        if kind == ARC:
            load = self._set_load()
        elif kind not in FORGETFUL and self.system.misses(self.X):
            # Quasi-Newton vectors belong to the free unknowns: a start that meets the prescribed increments keeps the
            # rows of these, and their weights, at zero.
            self._first.solve(None, self.X)
            first = 1
        iterations = first + (self._in_parts() if self.damped else self._once(load))
        reason = self.snes.getConvergedReason()
        self.system.bring_to(self.X)
        name = REASONS.get(reason, str(reason))
        return Outcome(reason > 0, iterations, WORDS.get(name, name), self.ratio, self.factorisations, self.evaluations)

    def _once(self, load=None):
        self.snes.solve(load, self.X)
        return self.snes.getIterationNumber()

    def _in_parts(self):
        """Solve the step whole; or balance it roughly on the way where contacts or a failure stop it.

        The law is integrated over the whole step in any case: parts change how a state is found, not the state.

        Returns:
            Number of iterations.
        """
        system, good, reached, iterations = self.system, self.X.duplicate(), 0.0, 0
        good.set(0.0)
        while True:
            iterations += self._once()
            if self.snes.getConvergedReason() > 0:
                if system.share == 1.0:
                    return iterations
                self.X.copy(good)
                reached, system.share = system.share, 1.0
            else:
                part = 0.5 * (system.share - reached)
                if part < SMALLEST_PART:
                    return iterations
                good.copy(self.X)
                system.share = reached + part
                log.info("no equilibrium of the whole step yet: first %.3g of it", system.share)


def forget(keys):
    """Take options out of PETSc's database."""
    database = PETSc.Options()
    for key in keys:
        database.delValue(key)
