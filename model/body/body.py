"""What equilibrium requires of a body: stresses for an increment, internal forces, a tangent."""

from collections.abc import Iterator
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np
from dolfinx import fem
from petsc4py import PETSc

from coilset.model.body.state import State


class Moment(NamedTuple):
    """A point in time: hours since the start, and the temperature, K."""

    hours: float
    temperature: float


class Body(Protocol):
    """A structure whose unknowns are the increments since the last equilibrium.

    Attributes:
        increment: the increments, mm and rad, a function of the body's space; ghosts are up to date for `update`.
        state: State with the body's own fields.
    """

    increment: fem.Function
    state: State

    def update(self) -> bool:
        """Update the trial state to `increment`.

        Returns:
            True, or False if no stress is found at some point of this rank; then the step must be cut.
        """
        ...

    def follow(self) -> None:
        """Update what carries no load to the end of the increment, before that becomes the equilibrium."""
        ...

    def internal_forces(self, vector: np.ndarray) -> None:
        """Add ∫ σ : δε of the owned cells at the trial state to a local array (owned and ghost unknowns), N, N mm."""
        ...

    def create_matrix(self, rows: int) -> PETSc.Mat:
        """A new matrix for the tangent with `rows` rows on this rank; those after the body's own are extra ones."""
        ...

    @property
    def constraint_weight(self) -> float:
        """Stiffness that converts a missed prescribed increment to a force, so that all residuals are forces, N/mm."""
        ...

    def rounding(self, increments: np.ndarray) -> float:
        """Norm of the out-of-balance forces due to rounding, N; collective.

        Args:
            increments: this rank's part of the system's increments.
        """
        ...


@runtime_checkable
class Foresees(Protocol):
    """A body whose internal forces a Newton correction predicts better than the state in which it ends does.

    Attributes:
        correction: mm and rad, a function of the body's space; ghosts are up to date for `predict`.
        axial_force: size of the spurious forces that finite rotations cause after a correction, N.
    """

    correction: fem.Function
    axial_force: float

    def stand(self) -> bool:
        """Bring the trial state to the last equilibrium and its forces, as far as `predict` needs them.

        The increments are zero. The material is not asked.

        Returns:
            False, and nothing is done, if the forces at the last equilibrium were not kept; the same on every rank.
        """
        ...

    def predict(self) -> None:
        """Predict the forces after `correction`, from the trial state."""
        ...

    def foresee(self, length: float) -> None:
        """Build the tangents with the forces predicted after `length` of the correction, until `stop_foreseeing`."""
        ...

    def stop_foreseeing(self) -> None:
        """Build the tangents with the forces of the trial state."""
        ...

    def forces_without_second_order(self, vector: np.ndarray, length: float) -> None:
        """Add the internal forces at the trial state, which lies `length` of the correction away.

        They are as in Body, but without the contribution of strains of second order in the correction.
        """
        ...


@runtime_checkable
class EstimatesErrors(Protocol):
    """A body that can estimate the error of its internal forces due to the step size.

    Attributes:
        axial_force: E A, the size of forces against which others are rounding, N.
    """

    axial_force: float

    def estimate_errors(self) -> None:
        """Prepare for estimates from now on; adds fields to the state, so call it before anything is saved."""
        ...

    def error_works(self, ratio: float, kinked: bool, stands: bool) -> tuple[float, float, float, float]:
        """Works of the errors; call it once at the end of a step, before the commit.

        Args:
            ratio: size of the step over that of the previous one on the same path, 0 if there is none.
            kinked: whether the path of strains has a kink within the step, in the worst case in its middle.
            stands: whether the step is committed in any case; else the next `restore` of the state may give it up.

        Returns:
            Four works: of the error of the internal forces on the step's deformation; of the share of the error that
            this step added, on the step's deformation and on that of the very first step; of the whole error on the
            latter. For this rank's cells, N mm; not a number if the error is unknown.
        """
        ...

    def resolves_time(self, fall: float) -> bool:
        """Whether the error of a step on trial, in which time passes at constant height, can be told from its works.

        Args:
            fall: of the logarithm of the force in the step. For this rank's cells.
        """
        ...

    def rejoin_finer_path(self) -> None:
        """Estimate from the last equilibrium on, which was reached by steps without an estimate."""
        ...


@runtime_checkable
class FillsMatrix(Protocol):
    """A body that assembles its tangent itself, in a matrix that has room for all of it from the start."""

    def tangent(self, matrix: PETSc.Mat) -> None:
        """Add the derivative of the internal forces at the trial state to a matrix, without assembling it."""
        ...

    def hold(self, matrix: PETSc.Mat, rows: np.ndarray) -> None:
        """Set the rows of prescribed increments (global numbers) to those of `constraint_weight` times the identity."""
        ...


@runtime_checkable
class OfElements(Protocol):
    """A body whose tangent is a sum over elements with equally many unknowns; other bodies FillsMatrix.

    Rows of prescribed increments are those of `constraint_weight` times the identity. Columns stay, so that even a
    large correction meets them.

    Attributes:
        element_dofs: local numbers of the owned elements' unknowns, shape (cells, k).
    """

    element_dofs: np.ndarray

    def element_tangents(self) -> Iterator[tuple[slice, np.ndarray]]:
        """Derivatives of the internal forces of some owned elements after others, shape (elements, k, k).

        The next ones may write over them.
        """
        ...


@runtime_checkable
class HasRotations(Protocol):
    """A body with rotations among its unknowns.

    Attributes:
        rotation_dofs: local numbers of the nodes' rotations, shape (nodes, 3); ghosts come after all owned unknowns.
    """

    rotation_dofs: np.ndarray

    def to_charts(self, values: np.ndarray) -> None:
        """Convert the moments at the owned rotations of `values` from the fixed frame to the trial state's charts."""
        ...


@runtime_checkable
class PassesTime(Protocol):
    """A body whose material depends on time."""

    @property
    def clock(self) -> np.ndarray:
        """At the last equilibrium: hours since the start, temperature (K), hours at the constants' temperature."""
        ...

    def pass_time(self, middle: Moment, end: Moment) -> None:
        """Let a step take time, from the last equilibrium through `middle` half way to `end`; call it before solving.

        This is forgotten when the step is committed or abandoned.

        Raises:
            ValueError: if the material does not depend on time.
        """
        ...
