"""The solid body, a Body: moving configuration, state of the points, internal forces and tangent."""

import time

import numpy as np
from dolfinx import fem
from dolfinx.fem.petsc import assemble_matrix, create_matrix
from petsc4py import PETSc

from coilset.meshes.solids.solid import SolidMesh
from coilset.model.physics.solid.configuration import Configuration
from coilset.model.physics.solid.continuum import Continuum
from coilset.model.physics.solid.forms import SolidForms
from coilset.model.physics.solid.points import MaterialPoints, respond

# Cells whose points are processed at a time; bounds the memory for what is not kept between iterations.
CHUNK = 2048


class Solid(Continuum):
    """A wire as a 3D body, updated Lagrange: increments start at the last equilibrium, forms use the current mesh.

    Args:
        wire: SolidMesh; its mesh will move with the body.
        points: the law at the points.

    Attributes:
        symmetric: whether to keep only the symmetric part of the moduli, for solvers that require it.
        wire, configuration, forms: mesh, positions, UFL forms.
        increment: function of the displacement increment, mm; u are its coefficients, shape (blocks with ghosts, 3).
        seconds: time spent at the points (`points`) and in assembling the tangent (`assembly`).
    """

    def __init__(self, wire: SolidMesh, points: MaterialPoints) -> None:
        self.wire, self.symmetric = wire, False
        self.configuration = Configuration(wire.mesh)
        self.forms = SolidForms(self.configuration)
        self.comm, self.V = wire.mesh.comm, self.configuration.V
        self.increment = self.forms.u
        self.u = self.increment.x.array.reshape(-1, 3)
        self.n_cells = wire.mesh.topology.index_map(3).size_local
        self.n_points = len(self.forms.points)
        super().__init__(points, self.configuration.x, self.n_cells, self.n_points)
        self.seconds = {"points": 0.0, "assembly": 0.0}
        self.update()

    # ---- Body ------------------------------------------------------------------------------------------------------

    def update(self) -> bool:
        """Update mesh, stresses and moduli to the increment; see Body."""
        began = time.perf_counter()
        self._move()
        self.configuration.move(self.x)
        good = all(self._update_chunk(first) for first in range(0, self.n_cells, CHUNK))
        self.seconds["points"] += time.perf_counter() - began
        return good

    def _update_chunk(self, first: int) -> bool:
        cells = slice(first, min(first + CHUNK, self.n_cells))
        gradient = self.forms.evaluate_gradient(np.arange(cells.start, cells.stop))
        old, new = (rows[cells].reshape(len(gradient), -1) for rows in (self._rows.equilibrium, self._rows.trial))
        stress = self.forms.stress.x.array.reshape(-1, self.n_points, 6)[cells].reshape(-1, 6)
        moduli = self.forms.moduli.x.array.reshape(-1, self.n_points, 6, 6)[cells].reshape(-1, 6, 6)
        return respond(self.points, gradient, (old, new), (stress, moduli), self.symmetric)

    def internal_forces(self, vector: np.ndarray) -> None:
        """Add ∫ σ : δε of the owned cells; see Body."""
        began = time.perf_counter()
        fem.assemble_vector(vector, self.forms.residual)
        self.seconds["points"] += time.perf_counter() - began

    def create_matrix(self, rows: int) -> PETSc.Mat:
        """A matrix for the tangent, with room for all of it; see Body."""
        return create_matrix(self.forms.tangent)

    def tangent(self, matrix: PETSc.Mat) -> None:
        """Add the material and the initial-stress part; see Body."""
        began = time.perf_counter()
        assemble_matrix(matrix, self.forms.tangent)
        self.seconds["assembly"] += time.perf_counter() - began

    def hold(self, matrix: PETSc.Mat, rows: np.ndarray) -> None:
        """Rows and columns of prescribed increments, so that the matrix stays symmetric; see Body.

        Increments used with this matrix satisfy the prescribed values from the start, see `HeadPredictor`.
        """
        matrix.zeroRowsColumns(rows.astype(PETSc.IntType), diag=self.constraint_weight)
        diagonal = matrix.getDiagonal()
        diagonal.array[:] *= 0.5 * np.finfo(float).eps * self.x[: self.configuration.owned].ravel()
        self._rounding = diagonal.norm()
