"""The solid between its two rigid heads as a SNES problem: steps, with cuts where one does not converge."""

import itertools
from dataclasses import dataclass

import numpy as np
from dolfinx import fem
from dolfinx.fem.petsc import apply_lifting, set_bc
from petsc4py import PETSc

from coilset.model.errors import SolveError
from coilset.model.solid.heads import Head, Motion
from coilset.model.solid.solid import Solid
from coilset.model.solid.solvers import choose

_prefix = itertools.count()


@dataclass(frozen=True)
class Step:
    """What it took to reach an equilibrium: Newton iterations (predictor included), linear iterations, and cuts."""

    iterations: int
    linear_iterations: int
    cuts: int


class SolidProblem:
    """Equilibrium of a solid whose heads move as prescribed.

    Args:
        wire: SolidMesh.
        points: the law at the points, as `MaterialPoints`.
        solver: ``direct``, ``multigrid`` or ``auto``.
        precision: ε of (6.3.1): out-of-balance forces over the change of the heads' forces in the step.
        options: further PETSc options, which replace those of the solver.

    Attributes:
        solid: Solid.
        bottom, top: Head.
    """

    def __init__(self, wire, points, solver="auto", precision=1e-7, options=None):
        blocks = wire.mesh.topology.index_map(0).size_global + wire.mesh.topology.index_map(0).size_global
        self.solver, chosen = choose(solver, 3 * blocks) if solver != "auto" else (solver, None)
        self.solid = Solid(wire, points)
        unknowns = 3 * self.solid.V.dofmap.index_map.size_global
        self.solver, chosen = choose(solver, unknowns)
        self.solid.symmetric = self.solver == "multigrid"
        self.unknowns, self.precision, self.comm = unknowns, precision, self.solid.comm
        self.bottom, self.top = Head(self.solid, "bottom"), Head(self.solid, "top")
        self._increment = fem.Function(self.solid.V)
        held = np.unique(np.concatenate([self.bottom.blocks, self.top.blocks]))
        self._held = held[held < self.solid.configuration.owned]
        self._conditions = [fem.dirichletbc(self._increment, held)]
        self._create_snes({**chosen, **(options or {})})
        self.forces = self.solid.internal_forces()
        self._start = self.forces.copy()
