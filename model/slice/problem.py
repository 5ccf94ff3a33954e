"""Equilibrium of the slice as a SNES problem in its displacements and the two numbers h̄ and λ."""

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from dolfinx import fem
from petsc4py import PETSc

from coilset.model.base.compat import NOT_A_NUMBER
from coilset.model.base.errors import SolveError
from coilset.model.equilibrium.newton.snes import solve
from coilset.model.slice.bordered import BorderedMatrix
from coilset.model.slice.contact import NoContact, SelfContact, SliceContact
from coilset.model.slice.forms import RISE, TURN, assemble
from coilset.model.slice.slice import Slice
from coilset.model.slice.watch import Watch

# PETSc's own factorisation: below a few thousand unknowns MUMPS costs several times as much. Minimum degree
# ordering eliminates the dense border last.
OPTIONS = {
    "snes_type": "newtonls",
    "snes_linesearch_type": "bt",
    "snes_max_it": 20,
    "ksp_type": "preonly",
    "pc_type": "lu",
    "pc_factor_mat_ordering_type": "qmd",
}
MAX_CUTS = 8
_numbers = itertools.count()


@dataclass(frozen=True)
class Effort:
    """Effort for an equilibrium: Newton iterations and cuts of the step."""

    iterations: int
    cuts: int


class SliceProblem:
    """Takes a slice from equilibrium to equilibrium.

    The two numbers are the last unknowns, h̄ and λ times the coil's radius, so that all unknowns are in mm and all
    residuals in N. If one of them is prescribed, its equation sets its value.

    Args:
        body: Slice.
        free_ends: the ends may turn about the coil's axis (no torque); otherwise they cannot (λ = 1).
        contact: SelfContact of the body; without it coils pass through each other. It becomes active in the first step
            in which coils would penetrate.
        precision: ε of (6.3.1): out-of-balance forces relative to those that the step applies to the slice.

    Attributes:
        force: axial force at the last equilibrium, compression positive, N; torque: about the axis, N mm.
        pressure: `Pressure` of the contact at the last equilibrium.
        touching: whether contact is active.
    """

    def __init__(
        self, body: Slice, free_ends: bool = False, contact: SelfContact | None = None, precision: float = 1e-8
    ):
        self.body, self.free_ends, self.precision = body, free_ends, precision
        self.contact: SliceContact = contact or NoContact()
        centre = int(np.argmin(np.linalg.norm(body.start - [body.coil.radius, 0.0, 0.0], axis=1)))
        # translation along the axis and rotation about it change nothing: they are fixed at the middle of the section
        self._gauge = np.array([3 * centre + 1, 3 * centre + 2])
        self._scale = np.array([1.0, body.coil.radius])
        self._n = body.u.size
        self.force, self.torque, self._direction = 0.0, 0.0, 0.0
        self.pressure = self.contact.evaluate()
        self._at, self._good = np.empty(0), True
        self._columns: list[np.ndarray | None] = [None, None]
        self._solvers: dict[bool, tuple[BorderedMatrix, PETSc.SNES]] = {}
        self._let_touch(False)

    def _let_touch(self, touching: bool) -> None:
        """Activate or deactivate contact and its entries in the matrix."""
        self.touching = touching
        if touching not in self._solvers:
            coupled = self.contact.blocks if touching else None
            matrix = BorderedMatrix(self.body.forms["tangent"], self._gauge, coupled)
            self._solvers[touching] = matrix, self._create_snes(matrix)
        self._matrix, self.snes = self._solvers[touching]
        self._X, self._b = self._matrix.petsc.createVecRight(), self._matrix.petsc.createVecLeft()

    def _create_snes(self, matrix: PETSc.Mat) -> PETSc.SNES:
        snes = PETSc.SNES().create(PETSc.COMM_SELF)
        prefix = f"slice{next(_numbers)}_"
        snes.setOptionsPrefix(prefix)
        database = PETSc.Options(prefix)
        for key, value in OPTIONS.items():
            database[key] = value
        snes.setFunction(self._residual, matrix.petsc.createVecLeft())
        snes.setJacobian(self._tangent, matrix.petsc)
        snes.setConvergenceTest(self._converged)
        snes.setFromOptions()
        for key in OPTIONS:
            database.delValue(key)
        return snes

    # ---- callbacks of SNES -----------------------------------------------------------------------------------------

    def _set(self, X: PETSc.Vec) -> bool:
        values = X.getArray(readonly=True)
        if not np.array_equal(values, self._at):
            self.body.u[:] = values[:-2].reshape(-1, 3)
            self.body.increment[:] = values[-2:] / self._scale
            self._good = self.body.update()
            if self.touching:
                self._pressure = self.contact.evaluate()
            self._at = values.copy()
        return self._good

    def resultants(self) -> np.ndarray:
        """Axial force, tension positive, N, and torque, N mm, at the increment, including the contact's share."""
        return self.body.resultants() + (self._pressure.numbers if self.touching else 0.0)

    def _residual_forces(self) -> np.ndarray:
        """Out-of-balance forces at the increment, shape (n + 2,), N."""
        residual = np.zeros(self._n + 2)
        residual[:-2] = (self.body.forces + (self._pressure.forces if self.touching else 0.0)).ravel()
        residual[self._gauge] = 0.0
        if self._force is not None or self.free_ends:
            driven = (self.resultants() - [-(self._force or 0.0), 0.0]) / self._scale
            residual[-2:] = np.where([self._force is not None, self.free_ends], driven, 0.0)
        return residual

    def _residual(self, snes: PETSc.SNES, X: PETSc.Vec, F: PETSc.Vec) -> None:
        if self._set(X):
            F.setArray(self._residual_forces())
        else:
            F.set(np.inf)

    def _tangent(self, snes: PETSc.SNES, X: PETSc.Vec, J: PETSc.Mat, P: PETSc.Mat) -> None:
        self._set(X)  # a line search may have evaluated another increment last
        self._assemble()

    def _assemble(self) -> None:
        forms, scale = self.body.forms, self._scale
        free, moves = [self._force is not None, self.free_ends], [True, self._turns]
        columns = self._columns = [assemble(forms["column", k]) / scale[k] if moves[k] else None for k in (RISE, TURN)]
        rows = [assemble(forms["row", k]) / scale[k] if free[k] else None for k in (RISE, TURN)]
        corner = np.eye(2)
        for i, j in itertools.product((RISE, TURN), repeat=2):
            if free[i]:
                corner[i, j] = fem.assemble_scalar(forms["corner", i, j]) / (scale[i] * scale[j]) if moves[j] else 0.0
        self._matrix.assemble(columns, rows, corner, self._of_contact(free, moves))

    def _of_contact(self, free: list[bool], moves: list[bool]) -> Any:
        """Positions and values of the contact stiffness in the matrix, without the equations of prescribed numbers."""
        if not self.touching:
            return None
        pressure, n = self._pressure, self._n
        i, j, scales = pressure.rows, pressure.columns, np.ones(n + 2)
        scales[n:] = self._scale
        used = np.append(np.ones(n, bool), free)[i] & np.append(np.ones(n, bool), moves)[j]
        i, j = i[used], j[used]
        return self._matrix.places(i, j), pressure.values[used] / (scales[i] * scales[j])

    def _converged(self, snes: PETSc.SNES, iteration: int, norms: tuple[float, float, float]) -> Any:
        norm, reason = norms[2], PETSc.SNES.ConvergedReason
        if not np.isfinite(norm):
            return NOT_A_NUMBER
        return reason.CONVERGED_FNORM_RELATIVE if norm <= max(self.precision * self._load, self._floor) else 0

    # ---- steps -----------------------------------------------------------------------------------------------------

    def go_to_rise(
        self, rise: float, turn: float | None = None, hours: float = 0.0, temperature: float | None = None
    ) -> Effort:
        """Find the equilibrium at a rise h̄, mm/rad; a step that does not converge is halved.

        Args:
            rise: h̄ at the end of the step.
            turn: λ at the end of the step if the ends are turned; not with free ends.
            hours: that it takes; temperature: at its end, K, by default as it is.

        Raises:
            SolveError: if none is found even after `MAX_CUTS` cuts; the last equilibrium is kept.
        """
        return self._go(lambda: self.body.rise, rise, False, turn, (hours, temperature))

    def go_to_force(self, force: float, hours: float = 0.0, temperature: float | None = None) -> Effort:
        """Find the equilibrium under an axial force, compression positive, N; otherwise as `go_to_rise`."""
        return self._go(lambda: self.force, force, True, None, (hours, temperature))

    def probe(self, rise: float, watch: Watch) -> tuple[float, np.ndarray]:
        """Linear response to a small change of the rise from the last equilibrium, which is kept.

        Returns:
            Axial force, compression positive, N, and the stress at the points of the watch in the section's axes, MPa.
        """
        self._linear_answer(rise, by_force=False)
        self._set(self._X)
        force, stress = -float(self.resultants()[RISE]), watch.section_stress(watch.evaluate())
        self.body.restore()
        return force, stress

    def _go(
        self,
        where: Callable[[], float],
        target: float,
        by_force: bool,
        turn: float | None,
        moment: tuple[float, float | None],
    ) -> Effort:
        begin, done, part, iterations, cuts = where(), 0.0, 1.0, 0, 0
        (hours, hottest), cold = moment, float(self.body.clock[1])
        turned = 0.0 if turn is None else turn - self.body.turn
        while done < 1.0:
            end = min(done + part, 1.0)
            value = target if end >= 1.0 else begin + end * (target - begin)
            direction = np.sign(value - self.force) if by_force else np.sign(self.body.rise - value)
            if direction * self._direction < 0.0:
                self.body.start_elastic()
            self.body.pass_time((end - done) * hours, cold + end * ((cold if hottest is None else hottest) - cold))
            converged = self._attempt(value, by_force, (end - done) * turned)
            iterations += 1 + self.snes.getIterationNumber()
            if converged and self._sinks_in():
                self.body.restore()
                self._let_touch(True)
                continue
            if converged:
                self._accept()
                self._direction, done = direction or self._direction, end
                continue
            self.body.restore()
            part, cuts = 0.5 * part, cuts + 1
            if cuts > MAX_CUTS:
                kind = f"{target:g} N" if by_force else f"a pitch of {2 * np.pi * target:g} mm"
                raise SolveError(
                    f"no equilibrium of the slice beyond {self.force:.6g} N and a pitch of "
                    f"{2 * np.pi * self.body.rise:.6g} mm on the way to {kind}"
                )
        return Effort(iterations, cuts)

    def _sinks_in(self) -> bool:
        """Whether coils penetrate at an equilibrium that was found without contact."""
        return not self.touching and self.contact.evaluate().free < 0.0

    def _accept(self) -> None:
        axial, torque = self.resultants()
        pressure = self._pressure if self.touching else self.contact.evaluate()
        try:
            self.body.commit()
        except SolveError:
            self.body.restore()
            raise
        self.force, self.torque, self.pressure = -axial, torque, pressure
        if self.touching and not self.pressure.bearing:
            self._let_touch(False)

    def _attempt(self, value: float, by_force: bool, turning: float) -> bool:
        """Newton's method from the linear response at the last moduli, K Δu = −R − ∂R/∂h̄ Δh̄; whether it converged."""
        self._linear_answer(value, by_force, turning)
        if by_force and not self.touching:
            self._hold_back(value)
        solve(self.snes, None, self._X)
        return self.snes.getConvergedReason() > 0 and self._set(self._X)

    def _hold_back(self, value: float) -> None:
        """Start where coils have just touched, if a force without their contact would make them penetrate deeper."""
        falls = -2.0 * np.pi * self._X.getArray(readonly=True)[-2] / self.body.turn
        reach = self.pressure.free + 2.0 * self.contact.onset
        if falls > reach:
            self._let_touch(True)
            self._linear_answer(value, by_force=True)
            self._X.scale(reach / falls)

    def _linear_answer(self, value: float, by_force: bool, turning: float = 0.0) -> None:
        self._force, self._turns = value if by_force else None, self.free_ends or turning != 0.0
        self._at, self._good = np.zeros(self._n + 2), True
        if self.touching:
            self._pressure = self.contact.evaluate()
        if self.body.time_passes:  # what is out of balance then drives the step
            self.body.update()
        residual = self._residual_forces()
        self._assemble()
        b, self._load = -residual, np.linalg.norm(residual)
        if not by_force:
            b[-2] = value - self.body.rise
            self._load = self._column_norm(RISE) * abs(b[-2]) + (self._load if self.body.time_passes else 0.0)
        if turning:
            b[-1] = turning * self._scale[TURN]
            self._load += self._column_norm(TURN) * abs(b[-1])
        diagonal = self._matrix.petsc.getDiagonal().array[:-2]
        self._floor = 0.5 * np.finfo(float).eps * np.linalg.norm(diagonal * self.body.x.ravel())
        ksp = self.snes.getKSP()
        ksp.setOperators(self._matrix.petsc)
        self._b.setArray(b)
        ksp.solve(self._b, self._X)

    def _column_norm(self, k: int) -> float:
        column = self._columns[k]
        return 0.0 if column is None else float(np.linalg.norm(column))
