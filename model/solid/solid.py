"""The solid body, a Body: moving configuration, state of the points, internal forces and tangent."""

import time
from collections.abc import Mapping
from typing import Protocol

import numpy as np
from dolfinx import fem
from dolfinx.fem.petsc import assemble_matrix, create_matrix
from petsc4py import PETSc

from coilset.meshes.solid import SolidMesh
from coilset.model.body.body import Body, Moment
from coilset.model.body.state import State, Where
from coilset.model.material.creep.in_time import RateLaw
from coilset.model.material.creep.law import CreepLaw
from coilset.model.solid.configuration import Configuration
from coilset.model.solid.forms import SolidForms
from coilset.model.solid.kinematics import push_forward, stretches

# Cells whose points are processed at a time; bounds the memory for what is not kept between iterations.
CHUNK = 2048


class PointLaw(Protocol):
    """A material law at points, as coilset.model.solid.points.MaterialPoints."""

    in_time: CreepLaw | RateLaw | None
    temperature: float

    def initial_state(self, points: int) -> np.ndarray:
        """Rows of unstressed points, shape (points, n_state); stress and back stress come first, 6 entries each."""
        ...

    def pass_time(self, start: Mapping[str, np.ndarray], end: Mapping[str, np.ndarray]) -> None:
        """Let increments from now on lead from one state to another, with the times in their `clock` entries."""
        ...

    def update(self, old: np.ndarray, strain: np.ndarray, new: np.ndarray, C: np.ndarray) -> bool:
        """Write new rows and moduli; returns False if the law found no solution."""
        ...


class Solid(Body):
    """A wire as a 3D body, updated Lagrange: increments start at the last equilibrium, forms use the current mesh.

    Args:
        wire: SolidMesh; its mesh will move with the body.
        points: the law at the points.
        symmetric: keep only the symmetric part of the moduli, for solvers that require it.

    Attributes:
        wire, configuration, forms: mesh, positions, UFL forms.
        increment: function of the displacement increment, mm; u are its coefficients, shape (blocks with ghosts, 3).
        state: State with the position coefficients `x`, mm, and the rows `point_state` of the owned cells, shape
            (cells, points, n_state), in the current frame.
        seconds: time spent at the points (`points`) and in assembling the tangent (`assembly`).
    """

    def __init__(self, wire: SolidMesh, points: PointLaw, symmetric: bool = False) -> None:
        self.wire, self.points, self.symmetric = wire, points, symmetric
        self.configuration = Configuration(wire.mesh)
        self.forms = SolidForms(self.configuration)
        self.comm, self.V = wire.mesh.comm, self.configuration.V
        self.increment = self.forms.u
        self.u = self.increment.x.array.reshape(-1, 3)
        self.n_cells = wire.mesh.topology.index_map(3).size_local
        self.n_points = len(self.forms.points)
        rows = points.initial_state(self.n_cells * self.n_points)
        rows = rows.reshape(self.n_cells, self.n_points, rows.shape[1])  # a rank may have no cells
        self.state = State()
        self._x = self.state.add("x", self.configuration.x.copy(), Where.STATION)
        self._points = self.state.add("point_state", rows, Where.CELL)
        if points.in_time is not None:
            self.state.add("clock", points.in_time.clock(0.0, points.temperature), Where.SHARED)
        self.seconds = {"points": 0.0, "assembly": 0.0}
        self._rounding = 0.0
        self.update()

    @property
    def x(self) -> np.ndarray:
        """Trial coefficients of the position, shape (blocks with ghosts, 3), mm."""
        return self._x.trial

    @property
    def point_state(self) -> np.ndarray:
        """Trial rows of the owned cells' points, shape (cells, points, n_state), MPa."""
        return self._points.trial

    # ---- Body ------------------------------------------------------------------------------------------------------

    def update(self) -> bool:
        """Update mesh, stresses and moduli to the increment; see Body."""
        began = time.perf_counter()
        np.add(self._x.equilibrium, self.u, out=self._x.trial)
        self.configuration.move(self.x)
        if "clock" in self.state:
            clock = self.state["clock"]
            self.points.pass_time({"clock": clock.equilibrium}, {"clock": clock.trial})
        good = all(self._update_chunk(first) for first in range(0, self.n_cells, CHUNK))
        self.seconds["points"] += time.perf_counter() - began
        return good

    def _update_chunk(self, first: int) -> bool:
        cells = slice(first, min(first + CHUNK, self.n_cells))
        gradient = self.forms.evaluate_gradient(np.arange(cells.start, cells.stop))
        old, trial = self._points.equilibrium, self._points.trial
        n, rows = len(gradient), old.shape[-1]
        strain, log_stretch = np.empty((n, 6)), np.empty((n, 3))
        axes, rotation = np.empty((n, 3, 3)), np.empty((n, 3, 3))
        if stretches(gradient, strain, axes, rotation, log_stretch) != 0:
            return False
        C, new = np.empty((n, 6, 6)), trial[cells].reshape(n, rows)
        if not self.points.update(old[cells].reshape(n, rows), strain, new, C):
            return False
        stress = self.forms.stress.x.array.reshape(-1, self.n_points, 6)[cells].reshape(n, 6)
        moduli = self.forms.moduli.x.array.reshape(-1, self.n_points, 6, 6)[cells].reshape(n, 6, 6)
        push_forward(new, C, axes, rotation, log_stretch, stress, moduli, self.symmetric)
        return True

    @property
    def clock(self) -> np.ndarray:
        """Hours since the start, temperature (K) and warm hours at the last equilibrium; see Body."""
        if "clock" in self.state:
            return self.state["clock"].equilibrium
        return np.array([0.0, self.points.temperature, 0.0])

    def pass_time(self, middle: Moment, end: Moment) -> None:
        """Set the clock of the trial state; see Body."""
        if self.points.in_time is None:
            raise ValueError("the material neither creeps nor depends on the rate, so time has no effect on it")
        start = self.state["clock"].equilibrium
        self.state["clock"].trial[:] = self.points.in_time.clock(*end, self.points.in_time.clock(*middle, start))

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

    @property
    def constraint_weight(self) -> float:
        """The rows and columns of the heads are those of the identity, N/mm; see Body."""
        return 1.0

    def hold(self, matrix: PETSc.Mat, rows: np.ndarray) -> None:
        """Rows and columns of prescribed increments, so that the matrix stays symmetric; see Body.

        Increments used with this matrix satisfy the prescribed values from the start, see `HeadPredictor`.
        """
        matrix.zeroRowsColumns(rows.astype(PETSc.IntType), diag=self.constraint_weight)
        diagonal = matrix.getDiagonal()
        diagonal.array[:] *= 0.5 * np.finfo(float).eps * self.x[: self.configuration.owned].ravel()
        self._rounding = diagonal.norm()

    def rounding(self, increments: np.ndarray) -> float:
        """Effect of rounding the positions on the forces, from the diagonal of the last tangent; see Body."""
        return self._rounding
