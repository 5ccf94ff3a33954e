"""What equilibrium asks of a body: stresses for an increment, internal forces, a tangent."""

from typing import Protocol

import numpy as np
from dolfinx import fem
from petsc4py import PETSc

from coilset.model.state import State


class Body(Protocol):
    """A structure whose unknowns are the increments since the last equilibrium.

    Attributes:
        increment: the increments, mm and rad, a function of the body's space; ghosts are up to date at `update`.
        state: State with the body's own fields.
    """

    increment: fem.Function
    state: State

    @property
    def row_entries(self) -> np.ndarray | None:
        """Entries in the tangent's row of each owned unknown; None where `create_matrix` makes the room."""
        ...

    def update(self) -> bool:
        """Bring the trial state to `increment`.

        Returns:
            True, or False if some point of this rank has no stress; then the step must be cut.
        """
        ...

    def follow(self) -> None:
        """Bring to the end of the increment what bears no load, before it becomes the equilibrium."""
        ...

    def internal_forces(self, vector: np.ndarray) -> None:
        """Add ∫ σ : δε of the owned cells at the trial state to a local array (owned and ghost unknowns), N, N mm."""
        ...

    def create_matrix(self, rows: int) -> PETSc.Mat:
        """A new matrix for the tangent with so many rows on this rank, those behind the body's own being extra ones."""
        ...

    def tangent(self, matrix: PETSc.Mat) -> None:
        """Add the derivative of the internal forces at the trial state to a matrix; values stay unassembled."""
        ...

    def hold(self, matrix: PETSc.Mat, rows: np.ndarray) -> None:
        """Make the rows of prescribed increments (global numbers) those of `constraint_weight` times the identity."""
        ...

    @property
    def constraint_weight(self) -> float:
        """Stiffness by which a missed increment counts as a force, so that residuals are of one kind, N/mm."""
        ...

    def rounding(self, increments: np.ndarray) -> float:
        """Norm of the out-of-balance forces that rounding leaves, N; collective.

        Args:
            increments: this rank's part of the system's increments.
        """
        ...
