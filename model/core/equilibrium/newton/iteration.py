"""PETSc's SNES for one load: its callbacks, the choice of its factors, and the thesis's test (6.3.1)."""

import logging
import math
import weakref
from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np
from petsc4py import PETSc

from coilset.model.core.base.agreement import max_of_ranks
from coilset.model.core.base.compat import NOT_A_NUMBER
from coilset.model.core.equilibrium.newton.contact_limit import ContactLimit
from coilset.model.core.equilibrium.newton.convergence import EquilibriumTest, Reason, imbalance
from coilset.model.core.equilibrium.newton.damping import Damping
from coilset.model.core.equilibrium.newton.line_search import WorkSearch
from coilset.model.core.equilibrium.newton.methods import ARC_LENGTH, FIRST, Method
from coilset.model.core.equilibrium.newton.snes import SnesFactory, solve
from coilset.model.core.equilibrium.settings import NewtonControl
from coilset.model.core.equilibrium.system import factors
from coilset.model.core.equilibrium.system.load import Load
from coilset.model.core.equilibrium.system.matrix import TangentMatrix
from coilset.model.core.equilibrium.system.system import System

each_iteration = logging.getLogger("coilset.iterations")  # silent unless its level is set

PART_TOLERANCE = 0.2  # ε of (6.3.1) for a part of a step, whose state is only the start of the next part
CRAWL, CRAWLS = 0.01, 8  # part of a correction, and how many in a row


class Iteration:
    """Iterates a System's increments towards the equilibrium of a load, by one of the methods.

    Args:
        tolerance: ε of (6.3.1).
        limit: ContactLimit of the corrections.
        prepare: called with PETSc's matrix after each tangent, for preconditioners that are not PETSc's.

    Raises:
        InputError: if PETSc refuses an option.

    Attributes:
        snes: PETSc's solver.
        matrix: TangentMatrix.
        load: what the step requires.
        load_factor: share of it whose equilibrium is sought.
        ratio: out-of-balance forces at the last iterate, as (6.3.1) measures them.
        factorisations: number of tangents since `start`.
        predicted: whether a tangent of this attempt was built with predicted section forces, see Body.
    """

    # a step's load on an arc, and the forces where SNES's function is another one: made where a method needs them
    _arc_load = cached_property(lambda self: self.system.layout.vector())
    _balance = cached_property(lambda self: self.system.layout.vector())

    def __init__(
        self,
        system: System,
        method: Method,
        tolerance: float,
        control: NewtonControl,
        limit: ContactLimit,
        prepare: Callable[[PETSc.Mat], object],
    ) -> None:
        self.system, self.control, self.limit, self.prepare = system, control, limit, prepare
        self.test = EquilibriumTest(tolerance, control.stagnation)
        self.search, self.damping = WorkSearch(system, limit), Damping(system.layout)
        self.F = system.layout.vector()
        self.matrix = TangentMatrix(system.body, system.layout)
        self.load, self.load_factor = Load.of(system.layout, {}, {}), 1.0
        self._predicts, self.predicted = False, False
        self._share: float | None = None  # of the predicted correction, if the next tangent is to be built with it
        self.ratio, self.factorisations, self._at_step_start = np.inf, 0, True
        self._fitted = 0  # matrix version at the last reset of the linear solvers; a solid's never changes
        self._damped = False  # whether the last tangent was
        self._crawled = 0  # corrections in a row of which less than CRAWL was made
        self._step_length: float | None = None  # of the last correction; None where there is none, or PETSc's own
        me = weakref.proxy(self)
        self._factory = SnesFactory(
            system.comm, lambda *args: me._residual(*args), lambda *args: me._tangent(*args), self.F, self.matrix.mat
        )
        self.snes: PETSc.SNES = None  # until `use` makes it
        self._first: PETSc.SNES | None = None
        self.use(method)

    def use(self, method: Method) -> None:
        """Go on with another method.

        Raises:
            InputError: if PETSc refuses an option; the method is then unchanged.
        """
        before, self.snes = self.snes, self._factory.make("", method.options, method.of_the_user)
        if before is not None:
            before.destroy()
        self.method, self._fitted = method, 0
        me = weakref.proxy(self)
        if method.searches:
            self.snes.setLineSearchPreCheck(lambda *args: me._shorten(*args))
        if not method.own_test:
            self.snes.setConvergenceTest(lambda *args: me._judge(*args))

    # ---- what a solve requires -------------------------------------------------------------------------------------

    def begin(self, load: Load, predicts: bool) -> None:
        """An attempt begins.

        Args:
            load: what the step requires.
            predicts: whether tangents may be built with predicted section forces; else with the actual ones only.
        """
        self.load, self._predicts, self.predicted, self._share = load, predicts, False, None

    def start(self, guess: PETSc.Vec | None) -> int:
        """Set the increments from which to iterate; the number of iterations that it took; collective.

        Args:
            guess: increments that are near; None: those of the last equilibrium, which are zero.
        """
        method, X = self.method, self.system.increments
        self.ratio, self.factorisations = np.inf, 0
        self.load_factor, self._at_step_start = 1.0, True
        if guess is None or method.is_arc_length:
            X.set(0.0)
        elif method.searches:
            if self._predicts and not self.system.touches:  # a start is a correction of the last equilibrium
                self.system.predict_from_equilibrium(guess.getArray(readonly=True))
                self._share = 1.0
            self.limit.limit_start(guess, X)
        else:
            guess.copy(X)
        if method.remembers:
            self.use(method)
        if method.is_arc_length:
            self._set_arc_load()
        elif method.remembers and self.load.misses(X.getArray(readonly=True), 1.0):
            self._meet_prescribed()
            return 1
        return 0

    def run(self, load_factor: float) -> tuple[int, int]:
        """Iterate; numbers of iterations, and of linear ones in them; collective.

        Args:
            load_factor: share of the load whose equilibrium is sought. Where contacts stop a correction that would meet
                it, the iteration ends at a smaller one, `load_factor`.
        """
        self.load_factor = load_factor
        solve(self.snes, self._arc_load if self.method.is_arc_length else None, self.system.increments)
        self._share = None
        return self.snes.getIterationNumber(), self.snes.getLinearSolveIterations()

    @property
    def reason(self) -> int:
        """Why the last run ended, a Reason; positive where it converged."""
        return self.snes.getConvergedReason()

    @property
    def has_tangent(self) -> bool:
        """Are there factors of the tangent near the state that the last run has found?"""
        return bool(self.method.searches and self.factorisations and not self._damped)

    def negative_pivots(self) -> int | None:
        """Number of negative pivots of the last factors L U; None where they are not shown or not of the last solve."""
        pc = self.snes.getKSP().getPC()
        if not self.has_tangent:  # an equilibrium needs no factors
            return None
        return factors.negative_pivots(pc)

    def _set_arc_load(self) -> None:
        """What the step adds to loads and prescribed values: minus the residual at its start."""
        self.system.residual(self.system.increments, self.load, 1.0, self._arc_load)
        self._arc_load.scale(-1.0)

    def _meet_prescribed(self) -> None:
        """Let the start meet the prescribed increments.

        Quasi-Newton vectors belong to the free unknowns: such a start keeps the rows of the others, and their weights,
        at zero.
        """
        if self._first is None:
            self._fitted = 0
            self._first = self._factory.make("first_", FIRST | self.method.factorisation)
        solve(self._first, None, self.system.increments)

    # ---- callbacks of SNES -----------------------------------------------------------------------------------------

    def _residual(self, snes: PETSc.SNES, X: PETSc.Vec, F: PETSc.Vec) -> None:
        self.system.residual(X, self.load, self.load_factor, F)
        if snes.getType() == ARC_LENGTH:  # SNES subtracts its part of the load: F(x) − λ load
            F.axpy(1.0, self._arc_load)

    def _tangent(self, snes: PETSc.SNES, X: PETSc.Vec, J: PETSc.Mat, P: PETSc.Mat) -> None:
        self.factorisations += 1
        self.system.tangent(X, self.load, self.matrix, self._at_step_start, self._share)
        self.damping.add_stiffness(self.matrix.mat, self.load)
        self._damped = self.damping.value > 0.0
        self.predicted |= self._share is not None
        self._at_step_start, self._share = False, None
        self.prepare(P)
        if self.matrix.version != self._fitted:  # PETSc may take the new matrix for one with the old pattern
            self._fitted = self.matrix.version
            for each in (self.snes, self._first, self.snes.getNPC() if self.snes.hasNPC() else None):
                if each is not None:
                    each.ksp.reset()
                    self._fit(each.ksp.pc)

    def _fit(self, pc: PETSc.PC) -> None:
        """Let LU eliminate in an order that suits the contacts, unless the user has chosen one."""
        if not any("mat_ordering_type" in key for key in self.method.of_the_user):
            factors.order(pc, self.matrix.ordering)

    def _shorten(self, x: PETSc.Vec, y: PETSc.Vec) -> None:
        """Before a line search of type `basic`: scale the correction −y."""
        step = self.search(x, y, self.F, self.load, self.load_factor, self._predicts, self._damped)
        self._step_length = step.contact_limit * step.value
        if not step.ends_on_the_way:
            self.damping.adjust(y, self.F, self.load, self._step_length)
        always = bool(self.control.predicted_forces)
        use = self._predicts and (step.only_spurious or always or not self.system.touches)
        self._share = self._step_length if use else None
        for factor in (step.contact_limit, step.value):
            if factor != 1.0:
                y.scale(factor)
        if step.ends_on_the_way:
            reached = x.copy()
            reached.axpy(-1.0, y)
            self.load_factor = self.load.reached(reached.getArray(readonly=True))

    def _judge(self, snes: PETSc.SNES, iteration: int, norms: tuple[float, float, float]) -> Any:
        """SNES's convergence test."""
        # MPI does not promise the same sum to the bit on all ranks, and these are to go on alike
        norm, X = max_of_ranks(self.system.comm, norms[2]), self.system.increments
        if iteration == 0:
            self._step_length, self._crawled = None, 0
            self.damping.begin()
            self.test.begin(norm, self.system.body.axial_force if self._predicts else 0.0)
        if not math.isfinite(norm):
            return NOT_A_NUMBER
        if self.method.is_arc_length and iteration == 0:
            return Reason.ITERATING  # at the load factor 0 every step is in equilibrium
        if self.method.is_arc_length or self.method.searches:
            balance = self.F
        else:  # some methods call a preconditioned step their function: judge the forces themselves
            balance = self._balance
            self.system.residual(X, self.load, self.load_factor, balance)
        found = imbalance(self.system, self.load, balance)
        self.ratio = found.ratio
        self._report(iteration, norm)
        tolerance = self.test.tolerance if self.load_factor == 1.0 else PART_TOLERANCE
        if self.test.is_met(found, tolerance, self.system.body.rounding(X.getArray(readonly=True))):
            return Reason.CONVERGED_FNORM_RELATIVE
        lost = self._lost(snes, iteration, norm)
        if lost != Reason.ITERATING and self.method.searches and self.test.is_near(found):
            return Reason.CONVERGED_FNORM_RELATIVE
        return lost

    def _lost(self, snes: PETSc.SNES, iteration: int, norm: float) -> int:
        """The reason to give up, or to go on."""
        if iteration >= snes.getTolerances()[3]:
            return Reason.DIVERGED_MAX_IT
        if self.method.is_arc_length:
            return Reason.ITERATING
        lost = self.test.is_lost(iteration, norm, snes.getDivergenceTolerance())
        if lost is None and self._crawls():
            lost = Reason.DIVERGED_TR_DELTA
        return Reason.ITERATING if lost is None else lost

    def _crawls(self) -> bool:
        """Whether hardly anything of the last corrections was made: repeated however often, they lead nowhere.

        Where stiff contacts follow a weak mode round a curve, the search leaves some ten thousandths of each one.
        """
        short = self._step_length is not None and self._step_length < CRAWL
        self._crawled = self._crawled + 1 if short else 0
        return self._crawled >= CRAWLS

    def _report(self, iteration: int, norm: float) -> None:
        if not each_iteration.isEnabledFor(logging.DEBUG):
            return
        length = "" if self._step_length is None else f", step length {self._step_length:.3g}"
        part = "" if self.load_factor == 1.0 else f", at {self.load_factor:.3g} of the step"
        balance = f", out of balance {self.ratio:.2e}" if np.isfinite(self.ratio) else ""
        length += f", damping {self.damping.value:.3g} N/mm" if self.damping.value else ""
        each_iteration.debug("  iteration %d: residual %.3e N%s%s%s", iteration, norm, balance, length, part)
