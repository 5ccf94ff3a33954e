"""What equilibrium asks of a body: stresses for an increment, internal forces, a tangent."""

from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np
from dolfinx import fem
from petsc4py import PETSc

from coilset.model.state import State


class Moment(NamedTuple):
    """When: hours since the start, and the temperature, K."""

    hours: float
    temperature: float


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


@runtime_checkable
class Foresees(Protocol):
    """A body of which a Newton correction foresees inner forces better than the state tells in which it ends.

    Attributes:
        correction: the correction, mm and rad, a function of the body's space; ghosts are up to date at `predict`.
        axial_force: size of the forces that finite turns feign after a correction, N.
    """

    correction: fem.Function
    axial_force: float

    def predict(self) -> None:
        """Foresee the forces after `correction`, from the trial state."""
        ...

    def foresee(self, length: float) -> None:
        """Build the tangents with the forces foreseen after `length` of the correction, until `stop_foreseeing`."""
        ...

    def stop_foreseeing(self) -> None:
        """Build the tangents with the forces of the trial state."""
        ...

    def forces_without_turning(self, vector: np.ndarray, length: float) -> None:
        """Add the internal forces at the trial state, which lies `length` of the correction away.

        They are as in Body, but without what strains of second order in the correction add.
        """
        ...


@runtime_checkable
class EstimatesErrors(Protocol):
    """A body that can say what a step's length has left wrong in its inner forces."""

    def estimate_errors(self) -> None:
        """Be ready for it from now on; adds fields to the state, so before anything is saved."""
        ...

    def error_works(self, ratio: float, kinked: bool) -> tuple[float, float, float, float]:
        """To be called once at a step's end, before it is committed.

        Args:
            ratio: size of the step over that of the one before it on the same path, 0 if there is none.
            kinked: is the path of strains kinked within the step, in its middle at worst?

        Returns:
            Work of the error of the inner forces on the step's deformation; of that share of the error which came in
            with the step, the work on the step's deformation and on that of the first step of all; the work of the
            whole error on the latter. Of this rank's cells, N mm; not a number where the error is not known.
        """
        ...

    def rejoin_finer_path(self) -> None:
        """Estimate from the last equilibrium on: it was reached by steps that were not judged."""
        ...


@runtime_checkable
class HasRotations(Protocol):
    """A body with rotations among its unknowns.

    Attributes:
        rotation_dofs: local numbers of the nodes' rotations, shape (nodes, 3); ghosts come after all owned unknowns.
    """

    rotation_dofs: np.ndarray

    def to_charts(self, values: np.ndarray) -> None:
        """Make of moments of the fixed frame, at the owned rotations of `values`, those of the trial state's charts."""
        ...


@runtime_checkable
class PassesTime(Protocol):
    """A body whose material knows time."""

    @property
    def clock(self) -> np.ndarray:
        """At the last equilibrium: hours since the start, temperature (K), hours at the constants' temperature."""
        ...

    def pass_time(self, middle: Moment, end: Moment) -> None:
        """Let a step take time, from the last equilibrium to `end`, by `middle` half way; before it is solved.

        It is forgotten when the step is committed or given up.

        Raises:
            ValueError: if the material does not know time.
        """
        ...
