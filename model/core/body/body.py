"""What equilibrium requires of a body: stresses for an increment, internal forces, a tangent."""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from contextlib import AbstractContextManager, nullcontext
from typing import NamedTuple

import numpy as np
from dolfinx import fem
from petsc4py import PETSc

from coilset.model.core.body.state import Field, State

SECONDS = 3600.0  # of an hour


class Moment(NamedTuple):
    """A point in time: hours since the start, and the temperature, K."""

    hours: float
    temperature: float


class Body(ABC):
    """A structure whose unknowns are the increments since the last equilibrium.

    What not every body has comes with a default: no rotations, no predicted forces and no dependence on time. A body
    with `element_dofs` gives its tangent by elements, any other one assembles it itself.

    Attributes:
        increment: the increments, mm and rad, a function of the body's space; ghosts are up to date for `update`.
        state: State with the body's own fields.
        extra: the field of its state that follows the layout's extra unknowns; None if it has none.
        axial_force: E A, the size of forces against which others are rounding, and of the spurious forces that finite
            rotations cause after a correction, N.
        rotation_dofs: local numbers of the nodes' rotations, shape (nodes, 3); ghosts come after all owned unknowns.
        element_dofs: local numbers of the owned elements' unknowns, shape (cells, k); None if it `assembles`.
        predicts: whether a Newton correction predicts the internal forces better than the state in which it ends.
    """

    increment: fem.Function
    state: State
    extra: Field | None = None
    axial_force: float = 0.0
    rotation_dofs: np.ndarray = np.empty((0, 3), np.int32)
    element_dofs: np.ndarray | None = None
    predicts: bool = False

    # ---- evaluation ------------------------------------------------------------------------------------------------

    @abstractmethod
    def update(self) -> bool:
        """Update the trial state to `increment`.

        Returns:
            True, or False if no stress is found at some point of this rank; then the step must be cut.
        """

    def advance(self) -> None:
        """Update what carries no load to the end of the increment, before that becomes the equilibrium."""

    @abstractmethod
    def internal_forces(self, vector: np.ndarray) -> None:
        """Add ∫ σ : δε of the owned cells at the trial state to a local array (owned and ghost unknowns), N, N mm."""

    @property
    @abstractmethod
    def constraint_weight(self) -> float:
        """Stiffness that converts a missed prescribed increment to a force, so that all residuals are forces, N/mm."""

    @abstractmethod
    def rounding(self, increments: np.ndarray) -> float:
        """Norm of the out-of-balance forces due to rounding, N; collective.

        Args:
            increments: this rank's part of the system's increments.
        """

    def to_charts(self, values: np.ndarray) -> None:
        """Convert the moments at the owned rotations of `values` from the fixed frame to the trial state's charts."""

    # ---- tangent ---------------------------------------------------------------------------------------------------

    @abstractmethod
    def create_matrix(self, rows: int) -> PETSc.Mat:
        """A new matrix for the tangent with `rows` rows on this rank; those after the body's own are extra ones.

        That of a body without `element_dofs` has room for all of its entries.
        """

    def element_tangents(self, share: float | None = None) -> Iterator[tuple[slice, np.ndarray]]:
        """Derivatives of the internal forces of some owned elements after others, shape (elements, k, k).

        The next ones may overwrite them. Rows of prescribed increments become those of `constraint_weight` times the
        identity. Columns stay, so that even a large correction meets them.

        Args:
            share: with the section forces predicted after this share of the correction; None: with the actual ones.
        """
        raise NotImplementedError

    def judged(self) -> AbstractContextManager[None]:
        """With the tangents by which the stability of the trial state is judged.

        A law that begins to flow abruptly has derivatives, of where in the step this is, that are of either sign and
        hundreds of times larger than moduli. They hold for changes of the whole step; a disturbance comes after it.
        """
        return nullcontext()

    def tangent(self, matrix: PETSc.Mat) -> None:
        """Add the derivative of the internal forces at the trial state to a matrix, without assembling it."""
        raise NotImplementedError

    def hold(self, matrix: PETSc.Mat, rows: np.ndarray) -> None:
        """Set the rows of prescribed increments (global numbers) to those of `constraint_weight` times the identity."""
        raise NotImplementedError

    # ---- mixed integration point (MIP) iteration -------------------------------------------------------------------

    def recall(self) -> bool:
        """Set the trial state and its forces to the last equilibrium as far as `predict` needs them.

        The increments are zero. The constitutive law is not evaluated.

        Returns:
            False, and nothing is done, if the forces at the last equilibrium were not kept; the same on every rank.
        """
        return False

    def predict(self, correction: np.ndarray) -> None:
        """Predict the section forces after a correction of the local unknowns, mm and rad, from the trial state."""

    def first_order_forces(self, vector: np.ndarray, share: float) -> None:
        """As `internal_forces`, without the contribution of strains of second order in the correction.

        Args:
            vector: as in `internal_forces`.
            share: of the predicted correction, after which the trial state is.
        """
        raise NotImplementedError

    # ---- time ------------------------------------------------------------------------------------------------------

    @property
    def clock(self) -> np.ndarray:
        """At the last equilibrium: hours since the start, temperature (K), hours at the constants' temperature."""
        return np.zeros(3)

    def pass_time(self, middle: Moment, end: Moment) -> None:
        """Let a step take time, from the last equilibrium through `middle` half way to `end`; call it before solving.

        Commit and restore end this.

        Raises:
            ValueError: if the material does not depend on time.
        """
        raise ValueError("this body's material is rate-independent")
