"""Damping of Newton's corrections along weak modes, where contacts or yielding stop them.

A correction is solved for with K + c M; docs/theory/equilibrium.md derives c from the shares of corrections that were
made. The forces have no damping, so that the equilibrium is the same.
"""

import math

import numpy as np
from petsc4py import PETSc

from coilset.model.core.base.agreement import sum_of_ranks
from coilset.model.core.equilibrium.system.layout import Layout
from coilset.model.core.equilibrium.system.load import Drag, Load

SHORT = 0.3  # share of a correction below which the next one is damped
RELAX = 0.3  # factor on the damping after a correction of which more was made
NOTHING = 1e-2  # of κ: damping below it is left out


class Damping:
    """The damping of an iteration.

    Args:
        layout: Layout of the unknowns.

    Attributes:
        value: c, N/mm; 0: none.
    """

    def __init__(self, layout: Layout) -> None:
        self.layout, self.value = layout, 0.0

    def begin(self) -> None:
        """No damping yet."""
        self.value = 0.0

    def add_stiffness(self, matrix: PETSc.Mat, load: Load) -> None:
        """Add c M of the free unknowns to a tangent; collective."""
        if self.value > 0.0:
            weights = np.where(load.is_held, 0.0, self.layout.weights)
            Drag(self.value * weights, np.zeros_like(weights)).add_stiffness(matrix)

    def adjust(self, y: PETSc.Vec, F: PETSc.Vec, load: Load, share: float) -> None:
        """Set the damping of the next correction.

        Args:
            y: correction, F: residual before it.
            load: of the step.
            share: of the correction that is made.
        """
        if self.value == 0.0 and share >= SHORT:
            return
        along = np.where(load.is_held, 0.0, y.getArray(readonly=True))
        comm = self.layout.comm
        work = sum_of_ranks(comm, along @ F.getArray(readonly=True))
        square = sum_of_ranks(comm, along @ (self.layout.weights * along))
        stiffness = abs(work) / square if square > 0.0 and math.isfinite(work) else 0.0
        if share < SHORT:
            self.value += stiffness * (1.0 / share - 1.0)
        else:
            self.value *= RELAX
            if self.value < NOTHING * stiffness:
                self.value = 0.0
