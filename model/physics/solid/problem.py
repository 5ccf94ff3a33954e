"""The solid between its two rigid heads: equilibrium under prescribed motion of the heads."""

from collections.abc import Iterator, Mapping
from functools import partial
from typing import Any

import numpy as np
from dolfinx import fem, la
from petsc4py import PETSc

from coilset.meshes.solids.solid import SolidMesh
from coilset.model.core.base.errors import SolveError
from coilset.model.core.body.body import Moment
from coilset.model.core.equilibrium.newton.iteration import Iteration
from coilset.model.core.equilibrium.newton.methods import MULTIGRID, SYMMETRIC, solid_method
from coilset.model.core.equilibrium.newton.newton import Newton, Start
from coilset.model.core.equilibrium.newton.outcome import Outcome
from coilset.model.core.equilibrium.path.continuation import Continuation
from coilset.model.core.equilibrium.path.step_sizes import Path
from coilset.model.core.equilibrium.settings import NewtonControl, StepControl
from coilset.model.core.equilibrium.system.layout import Layout
from coilset.model.core.equilibrium.system.load import Load
from coilset.model.core.equilibrium.system.system import System
from coilset.model.physics.solid.heads import Head, Motion, Reaction
from coilset.model.physics.solid.multigrid import VertexMultigrid, any_free_vertex
from coilset.model.physics.solid.points import MaterialPoints
from coilset.model.physics.solid.solid import Solid

STEPS = StepControl(smallest=2.0**-6)


class SolidProblem:
    """Equilibrium of a solid under prescribed motion of its heads.

    Args:
        points: the law at the points.
        solver: ``direct``, ``multigrid``, ``multigrid-cg`` or ``auto``, see `equilibrium/newton/methods.py`.
        precision: ε of (6.3.1): out-of-balance forces relative to the change of the heads' forces in the step.
        options: further PETSc options, which override those of the solver.

    Attributes:
        solid: Solid.
        bottom, top: Head.
        unknowns: number of degrees of freedom, including those of the heads.
        newton: Newton.
    """

    def __init__(
        self,
        wire: SolidMesh,
        points: MaterialPoints,
        solver: str = "auto",
        precision: float = 1e-7,
        options: Mapping[str, Any] | None = None,
        steps: StepControl = STEPS,
    ) -> None:
        self.solid = solid = Solid(wire, points)
        layout = Layout(solid.V)
        self.unknowns, self.comm = layout.size, solid.comm
        self.bottom, self.top = Head(solid, "bottom"), Head(solid, "top")
        held = np.unique(np.concatenate([self.bottom.blocks, self.top.blocks]))
        method = solid_method(solver, self.unknowns, options, free_vertices=any_free_vertex(solid.V, held))
        self.solver, solid.symmetric = method.name, method.name in SYMMETRIC
        self.system = System(solid, layout)
        self.newton = Newton(self.system, method, precision, NewtonControl(), prepare=self._prepare)
        self._multigrid: VertexMultigrid | None = None
        if self.solver.startswith(MULTIGRID):
            self._multigrid = VertexMultigrid(solid.configuration, held, self.newton.iteration.snes.getKSP().getPC())
            self.newton.iteration.snes.setFromOptions()  # now that the preconditioner's levels exist
        self.predictor = HeadPredictor(self.newton.iteration, solid, held)
        self._held = held[held < solid.configuration.owned]
        self.continuation = Continuation(self.newton, steps, starts=self._starts)
        self.system.restore()

    @property
    def forces(self) -> np.ndarray:
        """Internal forces at the last equilibrium, shape (owned blocks, 3), N."""
        return self.solid.state["reactions"].equilibrium.reshape(-1, 3)

    def step(self, top: Motion, bottom: Motion | None = None, hours: float = 0.0) -> tuple[Outcome, int]:
        """Move the heads as prescribed and find the equilibrium there; the step is cut if it is not found.

        Args:
            top, bottom: Motion from the start; by default the bottom stays.
            hours: that it takes; 0: no time.

        Returns:
            Total Outcome, in which a predictor counts as an iteration, and the number of cuts.

        Raises:
            SolveError: if no equilibrium is found down to the smallest step; the last equilibrium is kept.
        """
        targets = (self.bottom.motion if bottom is None else bottom, top)
        origin, continuation = (self.bottom.motion, self.top.motion), self.continuation
        path = Path(
            lambda done: self.load(*self._between(origin, targets, done)),
            target=str(top),
            place=lambda: f"{self.top.motion}",
            moment=partial(self._moment, float(self.solid.clock[0]), hours) if hours > 0.0 else None,
        )
        continuation.begin()
        total, cuts = None, 0
        while continuation.steps.position.done < 1.0:
            outcome, more = continuation.advance(path)
            self.bottom.motion, self.top.motion = self._between(origin, targets, continuation.steps.position.done)
            total, cuts = outcome if total is None else total + outcome, cuts + more
        assert total is not None
        return total, cuts

    def _moment(self, start: float, hours: float, done: float) -> Moment:
        return Moment(start + done * hours, float(self.solid.clock[1]))

    def _between(self, origin: tuple[Motion, Motion], targets: tuple[Motion, Motion], part: float) -> list[Motion]:
        return [a.between(b, min(part, 1.0)) for a, b in zip(origin, targets, strict=True)]

    def let_go(self) -> None:
        """Go to the wire whose top end nothing holds, its bottom end as it is, so without a force; within an excursion.

        Raises:
            SolveError: if there is no equilibrium.
        """
        bottom, top = (self._unknowns(head.blocks) for head in (self.bottom, self.top))
        load = Load(self.system.layout, bottom, np.zeros(len(bottom)), top, np.zeros(len(top)))
        outcome = self.continuation.attempt(load)
        if not outcome.converged:
            raise SolveError(f"the solid finds no equilibrium when nothing holds its top end: {outcome.reason}")

    def _unknowns(self, blocks: np.ndarray) -> np.ndarray:
        """This rank's places of the unknowns of blocks."""
        return np.asarray((3 * blocks[blocks < self.solid.configuration.owned, None] + np.arange(3)).ravel())

    def load(self, bottom: Motion, top: Motion) -> Load:
        """The load that takes the heads from the last equilibrium to the prescribed motions."""
        increment = np.zeros_like(self.solid.u)
        for head, motion in ((self.bottom, bottom), (self.top, top)):
            increment[head.blocks] = head.positions(motion) - self.solid.state["x"].equilibrium[head.blocks]
        places = self._unknowns(self._held)
        none = np.empty(0)
        return Load(self.system.layout, places, increment[self._held].ravel(), none.astype(np.int64), none)

    def _starts(self, load: Load, size: float) -> Iterator[Start]:
        yield self.predictor(load)

    def _prepare(self, matrix: PETSc.Mat) -> None:
        if self._multigrid is not None:
            self._multigrid.update(matrix, self.solid.x)

    def reactions(self, point: np.ndarray) -> tuple[Reaction, Reaction]:
        """Reactions of the bottom and top heads at the last equilibrium, with moments about a point, mm."""
        return self.bottom.reaction(self.forces, point), self.top.reaction(self.forces, point)


class HeadPredictor:
    """The linear response to the heads' motion g, K_ff u = −K_fh g − r: the start of Newton's method.

    It does not tear the elements at the ends, and the body stays at the last equilibrium.

    Args:
        iteration: the solid's Iteration.
        held: blocks of the heads, ghosts included.
    """

    def __init__(self, iteration: Iteration, solid: Solid, held: np.ndarray) -> None:
        self.iteration, self.solid = iteration, solid
        self._prescribed = fem.Function(self.solid.V)
        self._conditions = [fem.dirichletbc(self._prescribed, held)]
        self._start, self._residual_forces = (iteration.system.layout.vector() for _ in range(2))

    def __call__(self, load: Load) -> Start:
        """Solve for it; counts as one iteration; collective."""
        system, iteration, solid = self.iteration.system, self.iteration, self.solid
        system.last_tangent(load, iteration.matrix)
        iteration.prepare(iteration.matrix.mat)
        prescribed = self._prescribed.x.array
        prescribed[: system.layout.owned][load.held] = load.increments
        self._prescribed.x.scatter_forward()
        b = la.vector(solid.V.dofmap.index_map, 3)
        fem.apply_lifting(b.array, [solid.forms.tangent], [self._conditions])  # −K_fh g
        b.scatter_reverse(la.InsertMode.add)
        residual = b.array[: system.layout.owned] - system.state["reactions"].equilibrium
        residual[load.held] = load.increments
        self._residual_forces.setArray(residual)
        ksp = iteration.snes.getKSP()
        ksp.setOperators(iteration.matrix.mat)
        ksp.solve(self._residual_forces, self._start)
        self._start.getArray()[load.held] = load.increments  # exactly, even if the solve is iterative
        return Start(self._start, 1, ksp.getIterationNumber())
