"""Forces that a correction foresees, between Newton's method and a body that Foresees them.

Where nothing touches, and after a correction that increases only the spurious forces of finite rotations, the next
tangent is built with the forces that the correction foresees, see coilset.model.rod.prediction. The line search asks
what the residual is without these spurious forces.
"""

from functools import partial

import numpy as np
from petsc4py import PETSc

from coilset.model.body.body import Foresees
from coilset.model.equilibrium.load import Load
from coilset.model.equilibrium.matrix import TangentMatrix
from coilset.model.equilibrium.system import System


class Foreseeing:
    """What the last correction of a solve foresees, and whether the next tangent is built with it.

    Args:
        system: System.
        body: its body.
        always: whether all tangents after a correction are built with the forces that this foresees.

    Attributes:
        axial_force: size of the spurious forces that finite rotations cause after a correction, N.
        used: whether a tangent of the present attempt has been built with foreseen forces.
    """

    def __init__(self, system: System, body: Foresees, always: bool) -> None:
        self.system, self.body, self.always = system, body, always
        self.axial_force, self.used = body.axial_force, False
        self._correction = body.correction.x.array
        self._length: float | None = None  # share of the prediction that led to the present state, if it is to be used

    @classmethod
    def of(cls, system: System, wanted: bool | None) -> "Foreseeing | None":
        """Of a system whose body Foresees, unless it is not wanted.

        Args:
            wanted: as `foreseen_forces` of NewtonControl.
        """
        body = system.body
        return cls(system, body, bool(wanted)) if wanted is not False and isinstance(body, Foresees) else None

    def begin(self) -> None:
        """An attempt begins."""
        self._length, self.used = None, False

    def start(self, guess: PETSc.Vec) -> None:
        """Take a start for a correction of the last equilibrium: its finite rotations cause spurious forces, too."""
        system = self.system
        if system.touches:
            return
        correction = guess.duplicate()
        correction.set(0.0)
        system.expire_at_equilibrium()
        if not self.body.stand():
            system.evaluate(correction)
        correction.axpy(-1.0, guess)
        self.predict(correction)
        self._length = 1.0

    def predict(self, correction: PETSc.Vec) -> None:
        """Predict the forces after the increments change by −correction; collective.

        The last evaluation is that of the increments before it, or the body stands at the last equilibrium.
        """
        owned = self.system.layout.owned
        np.negative(correction.getArray(readonly=True)[:owned], out=self._correction[:owned])
        if self.system.comm.size > 1:
            self.body.correction.x.scatter_forward()
        self.body.predict()

    def correct(self, length: float, only_spurious: bool) -> None:
        """The predicted correction is made.

        Args:
            length: share of it that is made.
            only_spurious: as in StepLength.
        """
        self._length = length if only_spurious or self.always or not self.system.touches else None

    def forget(self) -> None:
        """The next state is not that to which the last correction led."""
        self._length = None

    def residual_without_second_order(self, load: Load, load_factor: float, length: float, F: PETSc.Vec) -> None:
        """As System.residual at the last evaluation, `length` of the predicted correction away."""
        forces = partial(self.body.forces_without_second_order, length=length)
        self.system.residual_with(forces, load, load_factor, F)

    def tangent(self, increments: PETSc.Vec, load: Load, matrix: TangentMatrix, at_step_start: bool) -> None:
        """As System.tangent, with the foreseen forces where a correction has led here; collective."""
        if self._length is None:
            self.system.tangent(increments, load, matrix, at_step_start)
            return
        self.system.evaluate(increments)
        self.body.foresee(self._length)
        self.system.last_tangent(load, matrix, at_step_start)
        self.body.stop_foreseeing()
        self._length, self.used = None, True
