"""The slice as a body: its position, the state of its points, its forces and their derivatives."""

import itertools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from dolfinx import fem
from petsc4py import PETSc

from coilset.meshes.sections.mesh import SectionMesh
from coilset.model.core.base.compat import geometry_dofs
from coilset.model.core.base.errors import InputError
from coilset.model.core.body.state import Field, Where
from coilset.model.core.material.law.law import Law
from coilset.model.physics.slice.bordered import BorderedMatrix
from coilset.model.physics.slice.forms import RISE, TURN, SliceForms, assemble
from coilset.model.physics.slice.pressure import NO_PRESSURE, SliceContact
from coilset.model.physics.solid.continuum import Continuum
from coilset.model.physics.solid.points import MaterialPoints, respond


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


class Slice(Continuum):
    """One section of a uniform coil, updated Lagrange: increments start at the last equilibrium.

    Its last unknowns are h̄ and λ times the coil's radius, so that all unknowns are in mm and all residuals in N.

    Args:
        law: `coilset.model.core.material.law.law.Law`.
        temperature: K; default is the law's reference temperature.

    Attributes:
        section, coil, law, forms: as given; SliceForms.
        u: increment of x₀, shape (blocks, 3), mm; a view.
        extra: the state's field of the two last unknowns, mm.
        start: coefficients of x₀ in the unloaded coil, shape (blocks, 3), mm.
        gradient: of the increment at the points in its final configuration, shape (points, 3, 3).
        places, areas: of the points in the unloaded section, shapes (points, 2), mm, and (points,), mm².
        turns: whether λ may change; else its derivatives are left out.
        contact: with the next coil, or None; pressure: its Pressure at the last evaluation.
        followers: called before a new equilibrium, to integrate the law at the points of a Watch.

    Raises:
        InputError: a section that reaches the coil's axis, or a temperature outside the material's table.
    """

    extra: Field

    def __init__(self, section: SectionMesh, coil: Coil, law: Law, temperature: float | None = None):
        if not coil.radius + section.extent[0] > 0:
            raise InputError(
                f"the coil's axis is {coil.radius:g} mm away, but the section reaches "
                f"{-section.extent[0]:g} mm inwards",
                "spring.mean_diameter",
            )
        self.section, self.coil, self.law = section, coil, law
        self.forms = SliceForms(section)
        self.V, self.increment = self.forms.V, self.forms.u
        self.u, self._scale = self.increment.x.array.reshape(-1, 3), np.array([1.0, coil.radius])
        self.forms.x.interpolate(lambda p: np.outer([1.0, 0, 0], coil.radius + p[0]) + np.outer(coil.up, p[1]))
        self.start = self.forms.x.x.array.reshape(-1, 3).copy()
        super().__init__(
            MaterialPoints(law, temperature), self.start, 1, len(self.forms.cells) * len(self.forms.points)
        )
        self.extra = self.state.add("rise_and_turn", np.array([coil.rise, coil.radius]), Where.SHARED)
        self._out = self.forms.stress.x.array.reshape(-1, 6), self.forms.moduli.x.array.reshape(-1, 6, 6)
        self.places, self.areas = self._places()
        self.turns, self.followers = True, list[Callable[[], object]]()
        self.contact: SliceContact | None = None
        self.pressure = NO_PRESSURE
        self.update()

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
        self._place()
        mean = np.average(self.forms.evaluate_tangents(), axis=0, weights=self.areas)[:, :2]
        U, _, V = np.linalg.svd(mean, full_matrices=False)
        outward, upward = (U @ V).T  # the nearest pair of orthogonal unit vectors
        return np.stack([np.cross(upward, outward), outward, upward], axis=1)

    @property
    def rows(self) -> np.ndarray:
        """Trial rows of the points, shape (points, n_state), in spatial axes."""
        return self.point_state[0]

    @property
    def rise(self) -> float:
        """h̄ now, mm/rad."""
        return float(self.extra.trial[RISE])

    @property
    def turn(self) -> float:
        """λ now."""
        return float(self.extra.trial[TURN] / self.coil.radius)

    # ---- Body ------------------------------------------------------------------------------------------------------

    def update(self) -> bool:
        """Update stresses, moduli and contact to the increment; see Body."""
        self._move()
        self._place()
        self.gradient, rows = self.forms.evaluate_gradient(), (self._rows.equilibrium[0], self._rows.trial[0])
        good = respond(self.points, self.gradient, rows, self._out)
        if good and self.contact is not None:
            self.pressure = self.contact.evaluate()
        return good

    def _place(self) -> None:
        """Give the forms the last equilibrium and the increments."""
        forms, extra = self.forms, self.extra
        forms.x.x.array[:] = self._x.equilibrium.ravel()
        forms.old.value[:] = extra.equilibrium / self._scale
        forms.increment.value[:] = extra.trial / self._scale - forms.old.value

    def advance(self) -> None:
        """Integrate the law at the watched points; see Body."""
        for follow in self.followers:
            follow()

    def resultants(self) -> np.ndarray:
        """Axial force on the slice, tension positive, N, and torque about the coil's axis, N mm, without contact."""
        return np.array([fem.assemble_scalar(self.forms["resultant", k]) for k in (RISE, TURN)])

    def internal_forces(self, vector: np.ndarray) -> None:
        """Add ∫ σ : δε and the forces of contact; see Body."""
        vector[:-2] += assemble(self.forms["residual"]) + self.pressure.forces.ravel()
        vector[-2:] += (self.resultants() + self.pressure.numbers) / self._scale

    def create_matrix(self, rows: int) -> PETSc.Mat:
        """A matrix with the rows and columns of h̄ and λ, and room for contact; see Body."""
        self._matrix = BorderedMatrix(self.forms["tangent"], None if self.contact is None else self.contact.blocks)
        return self._matrix.petsc

    def tangent(self, matrix: PETSc.Mat) -> None:
        """Write the derivatives of the internal forces; see Body."""
        forms, scale, n = self.forms, self._scale, self.u.size
        numbers = (RISE, TURN) if self.turns else (RISE,)
        columns, rows, corner = np.zeros((2, n)), np.zeros((2, n)), np.zeros((2, 2))
        for k in numbers:
            columns[k], rows[k] = (assemble(forms[kind, k]) / scale[k] for kind in ("column", "row"))
        for i, j in itertools.product(numbers, repeat=2):
            corner[i, j] = fem.assemble_scalar(forms["corner", i, j]) / (scale[i] * scale[j])
        contact, scales = self.pressure, np.append(np.ones(n), scale)
        values = contact.values / (scales[contact.rows] * scales[contact.columns])
        self._matrix.assemble(columns, rows, corner, (contact.rows, contact.columns, values))
        self._rounding = 0.5 * np.finfo(float).eps * np.linalg.norm(matrix.getDiagonal().array[:n] * self.x.ravel())

    def hold(self, matrix: PETSc.Mat, rows: np.ndarray) -> None:
        """Rows of prescribed increments become those of the identity; see Body."""
        matrix.zeroRows(rows.astype(PETSc.IntType), diag=self.constraint_weight)
