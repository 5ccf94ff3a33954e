"""The slice as a body: its position, the state of its points, its forces and their derivatives."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from dolfinx import fem

from coilset.meshes.section import SectionMesh
from coilset.model.base.compat import geometry_dofs
from coilset.model.base.errors import InputError
from coilset.model.material.creep.in_time import LawOverTime
from coilset.model.material.law.law import Law
from coilset.model.slice.forms import RISE, TURN, SliceForms, assemble
from coilset.model.solid.kinematics import push_forward, stretches
from coilset.model.solid.points import update_points


class Follower(Protocol):
    """Something that follows a slice from equilibrium to equilibrium."""

    def evaluate(self) -> np.ndarray:
        """Point states at the slice's increment; raises SolveError if there are none."""
        ...

    def accept(self) -> None:
        """Make what was evaluated last the equilibrium."""


@dataclass(frozen=True)
class Coil:
    """The unloaded helix.

    Attributes:
        radius: of the centre line, R, mm.
        pitch: rise per turn, p, mm; 0 makes a ring, which may pass through itself.
    """

    radius: float
    pitch: float

    @property
    def rise(self) -> float:
        """h = p/2π, mm/rad."""
        return self.pitch / (2.0 * np.pi)

    @property
    def up(self) -> np.ndarray:
        """The direction η of the section, normal to the wire and upwards; e_x is outward, ξ."""
        speed = np.hypot(self.radius, self.rise)
        return np.array([0.0, -self.rise, self.radius]) / speed


class Slice:
    """One section of a uniform coil, updated Lagrange: increments start at the last equilibrium.

    Args:
        section: SectionMesh.
        coil: Coil.
        law: `coilset.model.material.law.law.Law`.
        temperature: K; default is the law's reference temperature.

    Attributes:
        section, coil, law, forms: as given; SliceForms.
        u: increment of x₀, shape (blocks, 3), mm; a view.
        increment: of h̄, mm/rad, and λ, shape (2,); a view.
        state: history rows at the last equilibrium, shape (points, n_state), in spatial axes; trial: at the increment.
        forces: virtual work of the displacements at the increment, shape (blocks, 3), N.
        gradient: of the increment at the points in its final configuration, shape (points, 3, 3).
        places, areas: of the points in the unloaded section, shapes (points, 2), mm, and (points,), mm².
        watches: each is notified of every new equilibrium.
        clock: hours since the start, temperature (K) and warm hours at the last equilibrium.
        parameters: the law over the next step, for the compiled loops.

    Raises:
        InputError: a section that reaches the coil's axis, or a temperature outside the material's table.
    """

    def __init__(self, section: SectionMesh, coil: Coil, law: Law, temperature: float | None = None):
        if not coil.radius + section.extent[0] > 0:
            raise InputError(
                f"the coil's axis is {coil.radius:g} mm away, but the section reaches "
                f"{-section.extent[0]:g} mm inwards",
                "spring.mean_diameter",
            )
        self.section, self.coil, self.law = section, coil, law
        self.forms = SliceForms(section)
        self.u = self.forms.u.x.array.reshape(-1, 3)
        self.forms.x.interpolate(lambda p: np.outer([1.0, 0, 0], coil.radius + p[0]) + np.outer(coil.up, p[1]))
        self.start = self.forms.x.x.array.reshape(-1, 3).copy()
        self.forms.old.value[:] = coil.rise, 1.0
        self.increment = self.forms.increment.value
        self.temperature = law.reference_temperature if temperature is None else temperature
        self._over_time = LawOverTime(law, law.parameters(temperature), temperature)
        self.clock = np.array([0.0, self.temperature, 0.0])
        self.pass_time(0.0)
        self.watches: list[Follower] = []
        n = len(self.forms.cells) * len(self.forms.points)
        self.state = self.unstressed(n)
        self.trial = self.state.copy()
        self._stress = self.forms.stress.x.array.reshape(n, 6)
        self._moduli = self.forms.moduli.x.array.reshape(n, 6, 6)
        self._strain, self._log = np.empty((n, 6)), np.empty((n, 3))
        self._axes, self._rotation, self._C = np.empty((n, 3, 3)), np.empty((n, 3, 3)), np.empty((n, 6, 6))
        self.places, self.areas = self._places()
        self.update()
        self._committed = self._stress.copy(), self._moduli.copy()

    def unstressed(self, points: int) -> np.ndarray:
        """History rows of unstressed points, shape (points, n_state)."""
        return np.tile(self._over_time.unstressed(6), (points, 1))

    def pass_time(self, hours: float, temperature: float | None = None) -> None:
        """Let the next step take some hours, in which the temperature changes linearly; commit and restore end this.

        Raises:
            ValueError: if the material does not depend on time.
        """
        self._end = self.clock
        if hours > 0.0:
            if self._over_time.in_time is None:
                raise ValueError(f"'{self.law.name}' does not depend on time")
            end = float(self.clock[1]) if temperature is None else temperature
            self._end = self._over_time.in_time.clock(float(self.clock[0]) + hours, end, self.clock)
        self.parameters = self._over_time.over({"clock": self.clock}, {"clock": self._end})

    @property
    def time_passes(self) -> bool:
        """Whether the next step takes time."""
        return self._end is not self.clock

    def _places(self) -> tuple[np.ndarray, np.ndarray]:
        """Positions of the points in the unloaded section, shape (points, 2), mm, and their areas, mm²."""
        mesh, element = self.section.mesh, self.section.mesh.ufl_domain().ufl_coordinate_element().basix_element
        nodes = mesh.geometry.x[geometry_dofs(mesh)][:, :, :2]
        tables = element.tabulate(1, self.forms.points)[:, :, :, 0]
        places = np.einsum("qb,cbi->cqi", tables[0], nodes).reshape(-1, 2)
        first, second = (np.einsum("qb,cbi->cqi", table, nodes) for table in tables[1:])
        jacobian = first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]
        return places, (np.abs(jacobian) * self.forms.weights).ravel()

    def axes(self) -> np.ndarray:
        """Current axes of the section as columns: along the wire, outward, upward.

        The plane of the section is that of its mean tangents x₀,ξ and x₀,η; within it, both are rotated equally.
        """
        mean = np.average(self.forms.evaluate_tangents(), axis=0, weights=self.areas)[:, :2]
        U, _, V = np.linalg.svd(mean, full_matrices=False)
        outward, upward = (U @ V).T  # the nearest pair of orthogonal unit vectors
        return np.stack([np.cross(upward, outward), outward, upward], axis=1)

    @property
    def x(self) -> np.ndarray:
        """Coefficients of the current x₀, shape (blocks, 3), mm."""
        return self.forms.x.x.array.reshape(-1, 3) + self.u

    @property
    def rise(self) -> float:
        """h̄ now, mm/rad."""
        return float(self.forms.old.value[RISE] + self.increment[RISE])

    @property
    def turn(self) -> float:
        """λ now."""
        return float(self.forms.old.value[TURN] + self.increment[TURN])

    def update(self) -> bool:
        """Update stresses, moduli and forces to the increment.

        Returns:
            False if it inverts the material at some point or the law finds no solution somewhere.
        """
        self.gradient = self.forms.evaluate_gradient()
        if stretches(self.gradient, self._strain, self._axes, self._rotation, self._log) != 0:
            return False
        if update_points(self.parameters, self.state, self._strain, self.trial, self._C) != 0:
            return False
        push_forward(self.trial, self._C, self._axes, self._rotation, self._log, self._stress, self._moduli, False)
        self.forces = assemble(self.forms["residual"]).reshape(-1, 3)
        return True

    def commit(self) -> None:
        """Make the increment of the last `update` the equilibrium; its moduli are kept to start the next step.

        Raises:
            SolveError: if the law finds no solution at a watched point; then nothing has changed.
        """
        for watch in self.watches:
            watch.evaluate()
        for watch in self.watches:
            watch.accept()
        self.forms.x.x.array[:] += self.forms.u.x.array
        self.forms.old.value[:] += self.increment
        self.state[:] = self.trial
        self.clock = self._end
        self.pass_time(0.0)
        self.u[:], self.increment[:] = 0.0, 0.0
        for kept, now in zip(self._committed, (self._stress, self._moduli), strict=True):
            kept[:] = now

    def restore(self) -> None:
        """Go back to the last equilibrium, including its stresses and moduli."""
        self.u[:], self.increment[:] = 0.0, 0.0
        for kept, now in zip(self._committed, (self._stress, self._moduli), strict=True):
            now[:] = kept
        self.trial[:] = self.state
        self.pass_time(0.0)
        self.forces = assemble(self.forms["residual"]).reshape(-1, 3)

    def start_elastic(self) -> None:
        """Start the next step with the elastic moduli, as is correct when the load reverses."""
        self.u[:], self.increment[:] = 0.0, 0.0
        self.update()

    def resultants(self) -> np.ndarray:
        """Axial force on the slice, tension positive, N, and torque about the coil's axis, N mm."""
        return np.array([fem.assemble_scalar(self.forms["resultant", k]) for k in (RISE, TURN)])
