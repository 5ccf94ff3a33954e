"""Consistent mass of a rod with rotary inertia, as a UFL form on the current configuration.

A section of the true centre line is tied rigidly to the section of the chord at the same ξ by the offset o
(coilset.meshes.springs.placement), so that with the nodes' displacements u and small rotations ω, both linear along the
chord c, it moves by

    v = u + ω × o + ½ ξ (1 − ξ) c × (ω2 − ω1),

the last part being the bow of a beam whose ends rotate. With the density ρ, area A and polar moment J = ½ A r² of round
wire with the tangent t

    δW = ∫ ρ [A δv · v̈ + δω · ½ J (1 + t tᵀ) ω̈] ds,    1 + t tᵀ: J about the wire, J/2 across it.

Shear angles and strain modes of the elements have no mass. A rigid motion has the exact kinetic energy of the sections;
frequencies of stretching and twisting have errors of second order in the length of an element, (π h/λ)²/6 at the wave
length λ, those of bending of fourth order.
"""

from typing import Any, NamedTuple

import numpy as np
import ufl
from dolfinx import fem
from petsc4py import PETSc
from ufl import cross, dot, grad, inner

from coilset.model.core.equilibrium.system.layout import LineLayout
from coilset.model.core.rod.forms import at_sections, section_element
from coilset.model.core.rod.rod import Rod

TONNE = 1e-3  # per kg: with N, mm and s masses are in t


class SectionMass(NamedTuple):
    """Mass of a rod at its sections, per length of the current chord.

    Attributes:
        offset: o in space, shape (cells, sections, 3), mm.
        mass: shape (cells, sections), t/mm.
        inertia: rotary inertia in space, shape (cells, sections, 3, 3), t mm.
    """

    offset: np.ndarray
    mass: np.ndarray
    inertia: np.ndarray


def section_mass(rod: Rod, density: float) -> SectionMass:
    """Mass at the sections of a rod in its trial state.

    What grinding has taken off the ends is counted as if it were there. Of wire that is not round, ∫ z² dA and ∫ y² dA
    are in the place of ½ J; its centre of gravity counts as being on the axis.

    Args:
        density: kg/mm³.
    """
    place, triads = rod.placement, rod.coefficients.E
    rotation = place.matrices[..., :3, :3] * place.stretch[..., None, None]  # Qᵀ
    spin = np.swapaxes(rotation, -1, -2) @ place.matrices[..., :3, 3:] * place.stretch[..., None, None]  # K ↦ K × o
    offset = np.stack([spin[..., 1, 2], spin[..., 2, 0], spin[..., 0, 1]], axis=-1)
    length = np.linalg.norm(rod.x[rod.cells[:, 1]] - rod.x[rod.cells[:, 0]], axis=1)
    area = np.pi * rod.radius[:, None] ** 2
    mass = TONNE * density * area * place.stretch * (rod.l0 / length)[:, None]
    tangent = np.einsum("cij,cgj->cgi", triads, rotation[..., 0, :])
    polar = 0.5 * mass * rod.radius[:, None] ** 2
    inertia = 0.5 * polar[..., None, None] * (np.eye(3) + tangent[..., :, None] * tangent[..., None, :])
    if rod.rule.outline is not None:
        (y, z), share = rod.rule.points.T, rod.rule.weights.sum()
        second = rod.rule.weights @ np.stack([y**2 + z**2, z**2, y**2], axis=1) / share
        mass = mass * share
        axes = np.einsum("cij,cgkj->cgki", triads, rotation)  # t, n, b in space
        inertia = np.einsum("cg,k,cgki,cgkj->cgij", mass * rod.radius[:, None] ** 2, second, axes, axes)
    return SectionMass(np.einsum("cij,cgj->cgi", triads, offset), mass, inertia)


class Mass:
    """Consistent mass of a layout's rod, in t and t mm².

    Heads have no mass; a station that is fixed to a head moves with the head's unknowns.

    Args:
        density: kg/mm³.
    """

    def __init__(self, layout: LineLayout, density: float) -> None:
        self.layout, self.rod, self.density = layout, layout.rod, density
        self._at = [self._field(values) for values in section_mass(self.rod, density)]
        self._form = fem.form(self._virtual_work(self._field(self.rod.coefficients.xi), *self._at))

    def _field(self, values: np.ndarray) -> fem.Function:
        space = fem.functionspace(self.rod.mesh, section_element(values.shape[2:], self.rod.element))
        function = fem.Function(space)
        self._fill(function, values)
        return function

    @staticmethod
    def _fill(function: fem.Function, values: np.ndarray) -> None:
        cells, size = len(values), int(np.prod(values.shape[2:]))
        places = function.function_space.dofmap.list[:cells].ravel()
        function.x.array.reshape(-1, size)[places] = values.reshape(-1, size)

    def _virtual_work(self, ξ: Any, offset: Any, mass: Any, inertia: Any) -> ufl.Form:
        """That of inertia at the trial state, for a unit acceleration of the unknowns."""
        rod = self.rod
        chord = ufl.Jacobian(rod.mesh)[:, 0]

        def motion(function: Any) -> tuple[Any, Any]:
            nodal, _ = ufl.split(function)
            across = dot(grad(nodal), chord)  # nodal values at the second node less those at the first
            u, ω = (ufl.as_vector([nodal[i] for i in range(first, first + 3)]) for first in (0, 3))
            bend = ufl.as_vector([across[i] for i in range(3, 6)])
            return u + cross(ω, offset) + 0.5 * ξ * (1 - ξ) * cross(chord, bend), ω

        (v, turn), (u, ω) = motion(ufl.TestFunction(rod.V)), motion(ufl.TrialFunction(rod.V))
        return (mass * inner(v, u) + inner(turn, dot(inertia, ω))) * ufl.dx(rod.mesh, metadata=at_sections(rod.element))

    def matrix(self) -> PETSc.Mat:
        """At the rod's last equilibrium, all increments zero; collective."""
        for function, values in zip(self._at, section_mass(self.rod, self.density), strict=True):
            self._fill(function, values)
        layout, matrix = self.layout, fem.assemble_matrix(self._form)
        matrix.scatter_reverse()
        owned = matrix.index_map(0).size_local
        indptr = np.concatenate(
            [matrix.indptr[: owned + 1], np.full(layout.size_local - owned, matrix.indptr[owned])]
        ).astype(PETSc.IntType)
        columns = matrix.index_map(1).local_to_global(matrix.indices[: indptr[-1]].astype(np.int32))
        sizes = ((layout.size_local, None), (layout.size_local, None))
        entries = indptr, columns.astype(PETSc.IntType), matrix.data[: indptr[-1]]
        mass = PETSc.Mat().createAIJ(sizes, csr=entries, comm=layout.comm)
        return mass.ptap(_of_levers(layout, sizes)) if self.rod.arms else mass


def _of_levers(layout: LineLayout, sizes: Any) -> PETSc.Mat:
    """From the unknowns, among them those of heads, to the motion of the nodes: u = d + X ψ."""
    matrix = PETSc.Mat().createAIJ(sizes, nnz=4, comm=layout.comm)
    for row in range(layout.start, layout.stop):
        matrix.setValue(row, row, 1.0)
    for lever in layout.rod.levers:
        if lever.u.max() < layout.owned:
            pair = (layout.index_map.local_to_global(dofs.astype(np.int32)) for dofs in (lever.u, lever.rotations))
            rows, columns = (dofs.astype(PETSc.IntType) for dofs in pair)
            matrix.setValues(rows, columns, np.ascontiguousarray(lever.swing.first))
    matrix.assemble()
    return matrix
