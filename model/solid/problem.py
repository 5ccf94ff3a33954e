"""The solid between its two rigid heads as a SNES problem: steps, cut where one does not converge."""

import itertools
import time
from dataclasses import astuple, dataclass

import numpy as np
from dolfinx import fem, la
from petsc4py import PETSc

from coilset.model.compat import NOT_A_NUMBER
from coilset.model.errors import SolveError
from coilset.model.solid.heads import Head
from coilset.model.solid.multigrid import VertexMultigrid
from coilset.model.solid.solid import Solid
from coilset.model.solid.solvers import SYMMETRIC, choose

MAX_CUTS = 6
_numbers = itertools.count()


@dataclass(frozen=True)
class Step:
    """What it took to reach an equilibrium: linear solves, iterations inside them, and cuts of the step."""

    iterations: int
    linear_iterations: int
    cuts: int = 0

    def __add__(self, other):
        """The effort of both."""
        return Step(*(a + b for a, b in zip(astuple(self), astuple(other), strict=True)))


class SolidProblem:
    """Equilibrium of a solid whose heads move as prescribed.

    Args:
        wire: SolidMesh.
        points: the law at the points, as `MaterialPoints`.
        solver: ``direct``, ``multigrid``, ``multigrid-cg`` or ``auto``, see `solvers`.
        precision: ε of (6.3.1): out-of-balance forces over the change of the heads' forces in the step.
        options: further PETSc options, which replace those of the solver.

    Attributes:
        solid: Solid.
        bottom, top: Head.
        unknowns: number of degrees of freedom, those of the heads included.
        forces: internal forces at the last evaluation, shape (owned blocks, 3), N.
        seconds: time spent at the points (``points``), in assembling the tangent (``assembly``), in all (``all``).
    """

    def __init__(self, wire, points, solver="auto", precision=1e-7, options=None):
        self.solid = solid = Solid(wire, points)
        self.comm, self.precision = solid.comm, precision
        self.unknowns = 3 * solid.V.dofmap.index_map.size_global
        self.solver, chosen = choose(solver, self.unknowns)
        solid.symmetric = self.solver in SYMMETRIC
        self.bottom, self.top = Head(solid, "bottom"), Head(solid, "top")
        held = np.unique(np.concatenate([self.bottom.blocks, self.top.blocks]))
        self._held = held[held < solid.configuration.owned]
        self._multigrid = None
        self._prescribed = fem.Function(solid.V)  # increment of the heads in the step
        self._conditions = [fem.dirichletbc(self._prescribed, held)]
        self.seconds = dict.fromkeys(("points", "assembly", "all"), 0.0)
        self._create_snes({**chosen, **(options or {})}, held)
        self.forces = solid.internal_forces()
        self._start = self.forces.copy()

    def _create_snes(self, options, held):
        comm, owned = self.comm, 3 * self.solid.configuration.owned
        self._A = self.solid.create_matrix()
        self._x, self._f = (PETSc.Vec().createMPI((owned, None), bsize=3, comm=comm) for _ in range(2))
        self.snes = PETSc.SNES().create(comm)
        prefix = f"solid{next(_numbers)}_"
        self.snes.setOptionsPrefix(prefix)
        database = PETSc.Options(prefix)
        for key, value in options.items():
            database[key] = value  # stays there: the coarse levels read theirs when they are first set up
        self.snes.setFunction(self._residual, self._f)
        self.snes.setJacobian(self._tangent, self._A)
        self.snes.setConvergenceTest(self._converged)
        if self.solver.startswith("multigrid"):
            self._multigrid = VertexMultigrid(self.solid.configuration, held, self.snes.getKSP().getPC())
        self.snes.setFromOptions()

    # ---- callbacks of SNES -----------------------------------------------------------------------------------------

    def _set(self, X):
        """Bring the solid to the increment X; False if some point has no stress."""
        u = self.solid.forms.u
        u.x.array[: 3 * self.solid.configuration.owned] = X.getArray(readonly=True)
        u.x.scatter_forward()
        began = time.perf_counter()
        good = self.solid.update()
        if good:
            self.forces = self.solid.internal_forces()
        self.seconds["points"] += time.perf_counter() - began
        return good

    def _residual(self, snes, X, F):
        if self._set(X):
            rest = self.forces.copy()
            rest[self._held] = 0.0
            F.setArray(rest.ravel())
        else:
            F.set(np.inf)

    def _tangent(self, snes, X, J, P):
        mine = np.array_equal(X.getArray(readonly=True), self.solid.u[: self.solid.configuration.owned].ravel())
        if self.comm.allreduce(int(mine)) != self.comm.size:  # a line search may have looked elsewhere last
            self._set(X)
        self._assemble()

    def _assemble(self):
        began = time.perf_counter()
        self.solid.assemble_tangent(self._A, self._conditions)
        self.seconds["assembly"] += time.perf_counter() - began
        diagonal = self._A.getDiagonal()
        diagonal.array[:] *= 0.5 * np.finfo(float).eps * self.solid.x[: self.solid.configuration.owned].ravel()
        self._rounding = diagonal.norm()
        if self._multigrid:
            self._multigrid.update(self._A, self.solid.x)

    def _converged(self, snes, iteration, norms):
        """(6.3.1): out-of-balance forces against the change of the heads' forces since the step's start.

        A tiny step cannot ask for more than arithmetic gives: what rounding positions does to the forces is allowed.
        """
        norm = norms[2]
        if not np.isfinite(norm):
            return NOT_A_NUMBER
        change = (self.forces - self._start)[self._held]
        scale = np.sqrt(self.comm.allreduce(float(np.sum(change**2))))
        converged = norm <= max(self.precision * scale, self._rounding)
        return PETSc.SNES.ConvergedReason.CONVERGED_FNORM_RELATIVE if converged else 0

    # ---- steps -----------------------------------------------------------------------------------------------------

    def step(self, top, bottom=None):
        """Move the heads to where the motions say and find the equilibrium there.

        A step that does not converge is cut in halves.

        Args:
            top, bottom: Motion from the start; default for the bottom is to stay.

        Returns:
            Step.

        Raises:
            SolveError: if there is no equilibrium even after `MAX_CUTS` cuts; the last equilibrium is kept.
        """
        targets = (self.bottom.motion if bottom is None else bottom, top)
        origin = (self.bottom.motion, self.top.motion)
        done, part, effort, cuts, began = 0.0, 1.0, Step(0, 0), 0, time.perf_counter()
        while done < 1.0:
            motions = [a.between(b, min(done + part, 1.0)) for a, b in zip(origin, targets, strict=True)]
            effort += self._attempt(*motions)
            if self.snes.getConvergedReason() > 0:
                self.solid.commit()
                self._start = self.forces.copy()
                self.bottom.motion, self.top.motion = motions
                done += part
                continue
            self.solid.restore()
            self.forces = self.solid.internal_forces()
            part, cuts = 0.5 * part, cuts + 1
            if cuts > MAX_CUTS:
                raise SolveError(f"no equilibrium of the solid within {part:g} of the step towards {top}")
        self.seconds["all"] += time.perf_counter() - began
        return effort + Step(0, 0, cuts)

    def _attempt(self, bottom, top):
        predictor = self.predict(top, bottom)
        self.snes.solve(None, self._x)
        return Step(1 + self.snes.getIterationNumber(), predictor + self.snes.getLinearSolveIterations())

    def predict(self, top, bottom=None):
        """Solve for the linear answer to the heads' motion g, K_ff u = −K_fh g − r: where Newton's method begins.

        It tears no end element, and the body stays at the last equilibrium.

        Args:
            top, bottom: as in `step`.

        Returns:
            Iterations of the linear solver.
        """
        increment = self._prescribed.x.array.reshape(-1, 3)
        for head, motion in ((self.bottom, bottom or self.bottom.motion), (self.top, top)):
            increment[head.blocks] = head.positions(motion) - self.solid.configuration.x[head.blocks]
        ksp, owned = self.snes.getKSP(), self.solid.configuration.owned
        self._assemble()
        b = la.vector(self.solid.V.dofmap.index_map, 3)
        fem.apply_lifting(b.array, [self.solid.forms.tangent], [self._conditions])  # −K_fh g
        b.scatter_reverse(la.InsertMode.add)
        rest = b.array.reshape(-1, 3)[:owned] - self.forces
        rest[self._held] = increment[self._held]
        self._f.setArray(rest.ravel())
        ksp.setOperators(self._A)
        ksp.solve(self._f, self._x)
        self._x.array.reshape(-1, 3)[self._held] = increment[self._held]  # exactly, also if the solve is iterative
        return ksp.getIterationNumber()

    def reactions(self, point):
        """Reactions of bottom and top head at the last equilibrium, with moments about a point, mm."""
        return self.bottom.reaction(self.forces, point), self.top.reaction(self.forces, point)
