"""The solid body: moving configuration, state of the points, internal forces and tangent."""

import numpy as np
from dolfinx import la
from dolfinx.fem import assemble_vector
from dolfinx.fem.petsc import assemble_matrix, create_matrix

from coilset.model.solid.configuration import Configuration
from coilset.model.solid.forms import SolidForms
from coilset.model.solid.kinematics import push_forward, stretches

# Cells whose points are worked on at a time; bounds the memory of what is not kept between iterations.
CHUNK = 2048


class Solid:
    """A wire as a 3D body, updated Lagrange: increments count from the last equilibrium, forms from where it is now.

    Args:
        wire: SolidMesh; its mesh will move with the body.
        points: the law at the points, as `MaterialPoints`: `initial_state(n)` and `update(old, strain, new, C)`.
        symmetric: keep only the symmetric part of the moduli, for solvers that need it.

    Attributes:
        wire, configuration, forms: mesh, positions, UFL forms.
        u: coefficients of the displacement increment, shape (blocks with ghosts, 3), mm; a view.
        state: history rows at the last equilibrium, shape (owned cells, points, n_state), in the current frame.
        trial: the same at the current increment.
    """

    def __init__(self, wire, points, symmetric=False):
        self.wire, self.points, self.symmetric = wire, points, symmetric
        self.configuration = Configuration(wire.mesh)
        self.forms = SolidForms(self.configuration)
        self.comm = wire.mesh.comm
        self.V = self.configuration.V
        self.u = self.forms.u.x.array.reshape(-1, 3)
        self.n_cells = wire.mesh.topology.index_map(3).size_local
        self.n_points = len(self.forms.points)
        state = points.initial_state(self.n_cells * self.n_points)
        self.state = state.reshape(self.n_cells, self.n_points, -1)
        self.trial = self.state.copy()
        self._internal = la.vector(self.V.dofmap.index_map, 3)
        self.update()

    @property
    def x(self):
        """Coefficients of the current position, shape (blocks with ghosts, 3), mm."""
        return self.configuration.x + self.u

    def update(self):
        """Bring mesh, stresses and moduli to the increment `u`.

        Returns:
            False, on every rank, if the increment turns a point inside out or the law finds no solution somewhere.
        """
        self.configuration.move(self.x)
        good = all(self._update_chunk(first) for first in range(0, self.n_cells, CHUNK))
        return self.comm.allreduce(int(good)) == self.comm.size

    def _update_chunk(self, first):
        cells = slice(first, min(first + CHUNK, self.n_cells))
        gradient = self.forms.evaluate_gradient(np.arange(cells.start, cells.stop))
        n, rows = len(gradient), self.state.shape[-1]
        strain, log_stretch = np.empty((n, 6)), np.empty((n, 3))
        axes, rotation = np.empty((n, 3, 3)), np.empty((n, 3, 3))
        if stretches(gradient, strain, axes, rotation, log_stretch) != 0:
            return False
        C = np.empty((n, 6, 6))
        trial = self.trial[cells].reshape(n, rows)
        if not self.points.update(self.state[cells].reshape(n, rows), strain, trial, C):
            return False
        stress = self.forms.stress.x.array.reshape(-1, self.n_points, 6)[cells].reshape(n, 6)
        moduli = self.forms.moduli.x.array.reshape(-1, self.n_points, 6, 6)[cells].reshape(n, 6, 6)
        push_forward(trial, C, axes, rotation, log_stretch, stress, moduli, self.symmetric)
        return True

    def commit(self):
        """Make the trial state the equilibrium."""
        self.configuration.x += self.u
        self.u[:] = 0.0
        self.state[:] = self.trial

    def restore(self):
        """Go back to the last equilibrium."""
        self.u[:] = 0.0
        self.update()

    def internal_forces(self):
        """Internal forces at the current increment, shape (owned blocks, 3), N."""
        self._internal.array[:] = 0.0
        assemble_vector(self._internal.array, self.forms.residual)
        self._internal.scatter_reverse(la.InsertMode.add)
        return self._internal.array.reshape(-1, 3)[: self.configuration.owned].copy()

    def create_matrix(self):
        """A PETSc matrix for the tangent."""
        return create_matrix(self.forms.tangent)

    def assemble_tangent(self, A, conditions):
        """Write the tangent at the current increment into A; constrained rows and columns are those of the identity."""
        A.zeroEntries()
        assemble_matrix(A, self.forms.tangent, bcs=conditions)
        A.assemble()
