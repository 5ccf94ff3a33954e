"""Motion of a spring in time: implicit dynamics of the rod by the generalised-α method.

J. Chung and G. M. Hulbert, J. Appl. Mech. 60 (1993) 371: with the spectral radius ρ at infinite frequency,
αm = (2ρ − 1)/(ρ + 1), αf = ρ/(ρ + 1), β = ¼ (1 − αm + αf)², γ = ½ − αm + αf, a step Δt from the state 0 to 1 solves

    M [(1 − αm) a₁ + αm a₀] + (1 − αf) f₁ + αf f₀ = 0,
    x = Δt v₀ + Δt² [(½ − β) a₀ + β a₁],   v₁ = v₀ + Δt [(1 − γ) a₀ + γ a₁],

for the increments x of the step, with f the internal forces and those of contacts, as in statics. Divided by 1 − αf, it
is the equilibrium of a static step that the inertia resists with the forces c M (x − x₀) + αf/(1 − αf) f₀. All that
statics has (yield, contact, friction, large rotations) is therefore as it is there.

M is that of the last state: it changes with the rotations of the sections only. Gyroscopic moments, of the order of the
wire's over the coil's radius squared, are left out.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from petsc4py import PETSc

from coilset.model.core.base.errors import SolveError
from coilset.model.core.equilibrium.newton.newton import Newton, Start
from coilset.model.core.equilibrium.system.load import Load
from coilset.model.core.equilibrium.system.system import System
from coilset.model.physics.vibration.mass import Mass

SPECTRAL_RADIUS = 0.8  # what is left in a step of an oscillation that the steps do not resolve
CUTS = 6  # how often a step is halved


@dataclass(frozen=True)
class Inertia:
    """Resistance of the mass in a step: the forces stiffness · x + constant.

    Attributes:
        mass: M; factor: of it, 1/s²; constant: this rank's part, N and N mm.
    """

    mass: PETSc.Mat
    factor: float
    constant: np.ndarray

    def forces(self, increments: np.ndarray) -> np.ndarray:
        """Forces at given increments, this rank's part, N and N mm."""
        return self.factor * _times(self.mass, increments) + self.constant

    def add_stiffness(self, matrix: PETSc.Mat) -> None:
        """Add c M to the tangent, which has places for all of it; collective."""
        matrix.axpy(self.factor, self.mass, PETSc.Mat.Structure.SUBSET_NONZERO_PATTERN)


@dataclass(frozen=True)
class Energies:
    """Since the beginning, N mm.

    Attributes:
        kinetic: at this time; at the beginning: of the initial velocities.
        stored: work done on the wire and against contacts, in part dissipated if these yield or rub.
        supplied: work of what is prescribed.
    """

    kinetic: float
    stored: float
    supplied: float

    @property
    def lost(self) -> float:
        """What the time steps have taken away: supplied less stored and kinetic energy."""
        return self.supplied - self.stored - self.kinetic


class Motion:
    """A rod in motion, from its last equilibrium on.

    Args:
        system: System of a rod.
        density: kg/mm³.
        velocities: initial ones of the unknowns, this rank's part, shape (size_local,), mm/s and rad/s; None: at rest.
        spectral_radius: ρ, from 0 to 1; 1: no energy is taken from the motion.

    Attributes:
        time: s; energies: Energies.
        velocities, accelerations: of the unknowns, 1/s and 1/s²; of those without mass zero.
        steps, iterations: so far.
    """

    def __init__(
        self,
        system: System,
        newton: Newton,
        density: float,
        velocities: np.ndarray | None = None,
        spectral_radius: float = SPECTRAL_RADIUS,
    ) -> None:
        self.system, self.newton, self.mass = system, newton, Mass(system.line, density)
        ρ = spectral_radius
        self.αm, self.αf = (2.0 * ρ - 1.0) / (ρ + 1.0), ρ / (ρ + 1.0)
        self.β, self.γ = 0.25 * (1.0 - self.αm + self.αf) ** 2, 0.5 - self.αm + self.αf
        n = system.layout.size_local
        self.velocities = np.zeros(n) if velocities is None else velocities.copy()
        self.accelerations, self.time, self.steps, self.iterations = np.zeros(n), 0.0, 0, 0
        self._matrix = self.mass.matrix()
        diagonal = self._matrix.getDiagonal().getArray()
        self._moves = diagonal > 0.0
        kinetic = self._kinetic()
        self.energies = Energies(kinetic, 0.0, kinetic)

    def go(self, load: Callable[[float], Load], end: float, cuts: int = CUTS) -> None:
        """One step to a time; if it is not found, in halves; collective.

        Args:
            load: what is held and prescribed at a time, from the last equilibrium, whichever that is.
            end: s.
            cuts: how often it may be halved.

        Raises:
            SolveError: if no equilibrium was found; the last one is kept.
        """
        outcome = self._step(load(end), end - self.time)
        if outcome is None:
            return
        if cuts == 0:
            raise SolveError(f"no motion was found beyond {1e3 * self.time:.6g} ms: {outcome}")
        for until in (0.5 * (self.time + end), end):
            self.go(load, until, cuts - 1)

    def _step(self, load: Load, Δt: float) -> str | None:
        """A step; the reason if it was not found."""
        system, v, a = self.system, self.velocities, self.accelerations
        before = system.state["reactions"].equilibrium.copy()
        self._matrix = self.mass.matrix()
        share = (1.0 - self.αm) / (1.0 - self.αf)
        a_of_x = 1.0 / (self.β * Δt**2)  # a₁ = a_of_x x + a_at_rest
        a_at_rest = -v / (self.β * Δt) - (0.5 / self.β - 1.0) * a
        constant = _times(self._matrix, share * a_at_rest + self.αm / (1.0 - self.αf) * a)
        inertia = Inertia(self._matrix, share * a_of_x, constant + self.αf / (1.0 - self.αf) * before)
        start = Δt * v + 0.5 * Δt**2 * a
        start[load.held] = load.increments
        outcome = self.newton.solve(load.resisted(inertia), Start(system.layout.vector(start)))
        self.iterations += outcome.iterations
        if not outcome.converged:
            system.restore()
            return outcome.reason
        x, after = system.increments.getArray(readonly=True).copy(), system.state["reactions"].trial.copy()
        a_now = np.where(self._moves, a_of_x * x + a_at_rest, 0.0)
        self.velocities = np.where(self._moves, v + Δt * ((1.0 - self.γ) * a + self.γ * a_now), 0.0)
        held, mean = load.held, 0.5 * (before + after)
        inert = 0.5 * (_times(self._matrix, a + a_now))[held]
        self.accelerations = a_now
        works = system.comm.allreduce(np.array([mean @ x, (mean[held] + inert) @ x[held]]))
        stored, supplied = map(float, works)
        so_far = self.energies
        self.energies = Energies(self._kinetic(), so_far.stored + stored, so_far.supplied + supplied)
        system.commit()
        self.time, self.steps = self.time + Δt, self.steps + 1
        return None

    def _kinetic(self) -> float:
        """½ v·M v, N mm."""
        work = 0.5 * float(self.velocities @ _times(self._matrix, self.velocities))
        return float(self.system.comm.allreduce(work))

    def inertia_at(self, dof: int) -> float:
        """Force of inertia at an unknown, N or N mm, which a head adds to the internal force there; collective."""
        forces, layout = _times(self._matrix, self.accelerations), self.system.layout
        mine = float(forces[dof - layout.start]) if layout.start <= dof < layout.stop else 0.0
        return float(layout.comm.allreduce(mine))


def _times(matrix: PETSc.Mat, values: np.ndarray) -> np.ndarray:
    """Matrix times a vector, this rank's parts."""
    vector, product = matrix.createVecs()
    vector.setArray(values)
    matrix.mult(vector, product)
    return product.getArray().copy()
