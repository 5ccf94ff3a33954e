"""A rod structure: state of its nodes and section points, and the forms assembled from them.

The unknowns are the increments since the last equilibrium configuration; `update` brings the trial state to them
without touching the equilibrium, `commit` makes the trial state the equilibrium, so that a failed step leaves no trace.
"""

import numpy as np
from dolfinx import fem

from coilset.meshes.placement import Placement, straight
from coilset.model.frames.rotations import triads, turn_nodes
from coilset.model.rod import forms
from coilset.model.rod.kinematics import GAUSS, section_strains
from coilset.model.section.kinds import make_sections


class CellField:
    """A coefficient of the forms, its values reached as an array in the order of the cells."""

    def __init__(self, mesh, element, shape, cells):
        self.function = fem.Function(fem.functionspace(mesh, element))
        dofs = self.function.function_space.dofmap.list[:cells]
        if not np.array_equal(dofs.ravel(), np.arange(dofs.size)):
            raise RuntimeError("DOLFINx numbers the values of cells out of their order; CellField needs them in order")
        size = int(np.prod(shape))
        self.values = self.function.x.array[: cells * size].reshape(cells, *shape)


class Rod:
    """Straight elasto-plastic rods along a line mesh.

    Args:
        line: LineMesh.
        radius: wire radius of every element in the order of the elements, shape (elements,), mm.
        law: material law (`coilset.model.material.library.load`).
        rule: quadrature of the wire's disk, DiskRule.
        placement: Placement of the true sections in relation to the chords, in the order of the elements; None for
            straight rods.
        temperature: of the rod, K; where plastic work heats it, at the start. None: the material's first.
        kind: of the sections, see `coilset.model.section.kinds`, and `degree` of those that warp.

    Raises:
        InputError: if the temperature lies outside the material's table.

    Attributes:
        x, chord, R, shear, strain: trial state of the local nodes and owned cells; x in mm, strain shape (cells, 2, 6).
        points: trial state of the sections, a dict of arrays of shape (cells, 2, ...); `point_state`, shape
            (cells, 2, points, n_state), is always among them.
        equilibrium: the same at the last equilibrium, a dict.
    """

    def __init__(self, line, radius, law, rule, placement=None, temperature=None, kind="plane", degree=3):
        self.line, self.law, self.rule = line, law, rule
        mesh, n = line.mesh, line.owned_cells
        self.mesh, self.parameters = mesh, law.parameters(temperature)
        element = line.element[:n]
        self.radius = np.ascontiguousarray(np.asarray(radius, float)[element])
        self.placement = straight(n)
        if placement is not None:
            self.placement = Placement(*(np.ascontiguousarray(part[element]) for part in placement))
        self.sections = make_sections(
            kind, law, self.parameters, rule, self.radius, self.placement, temperature, degree
        )

        self.V = fem.functionspace(mesh, forms.rod_element())
        self.increment = fem.Function(self.V)
        self._number_dofs()
        self.cells = np.ascontiguousarray(mesh.geometry.dofmap[:n])
        x = mesh.geometry.x
        chords = x[self.cells[:, 1]] - x[self.cells[:, 0]]
        self.l0, self.E0 = np.linalg.norm(chords, axis=1), triads(chords)

        self.xi = CellField(mesh, forms.section_element(()), (2,), n)
        self.xi.values[:] = GAUSS
        self.share = CellField(mesh, forms.cell_element(()), (1,), n)
        Φ = 3.0 * law.E * self.radius**2 / (law.G * self.l0**2)  # 12 E I/(G A l²)
        self.share.values[:, 0] = Φ / (1.0 + Φ)
        self.E = CellField(mesh, forms.cell_element((3, 3)), (3, 3), n)
        self.T = CellField(mesh, forms.cell_element((2, 3, 3)), (2, 3, 3), n)
        self.P = CellField(mesh, forms.cell_element((2, 3, 3)), (2, 3, 3), n)
        self.W = CellField(mesh, forms.cell_element((3, 3)), (3, 3), n)
        self.e = CellField(mesh, forms.section_element((6,)), (2, 6), n)
        self.s = CellField(mesh, forms.section_element((6,)), (2, 6), n)
        self.D = CellField(mesh, forms.section_element((6, 6)), (2, 6, 6), n)
        fields = (self.xi, self.share, self.E, self.T, self.P, self.W, self.e, self.s, self.D)
        self.forms = forms.RodForms(mesh, self.V, *(field.function for field in fields))
        self._residual = fem.form(self.forms.residual)
        self._tangent = fem.form(self.forms.material_stiffness + self.forms.frame_stiffness)
        self._start(x)

    def _number_dofs(self):
        """Local dofs of the nodes' displacements and turns, shape (nodes, 3), and of the cells' shear angles."""
        geometry = self.mesh.geometry
        self.u_dofs, self.turn_dofs = np.empty((2, len(geometry.x), 3), dtype=np.int32)
        nodal, shear = self.V.sub(0), self.V.sub(1)
        for i in range(3):
            self.u_dofs[geometry.dofmap, i] = nodal.sub(i).dofmap.list
            self.turn_dofs[geometry.dofmap, i] = nodal.sub(i + 3).dofmap.list
        self.shear_dofs = np.stack([shear.sub(i).dofmap.list[: self.line.owned_cells, 0] for i in range(2)], axis=1)

    @property
    def history(self):
        """Trial state of the section points, shape (cells, 2, points, n_state)."""
        return self.points["point_state"]

    def _start(self, x):
        """The stress-free state."""
        n = len(self.cells)
        self.x = x  # the mesh's own coordinates: the forms are integrated on the current configuration
        self.chord = x[self.cells[:, 1]] - x[self.cells[:, 0]]
        self.R = np.tile(np.eye(3), (len(x), 1, 1))
        self.chart = np.tile(np.eye(3), (len(x), 1, 1))
        self.shear = np.zeros((n, 2))
        self.strain = self.e.values
        self.points = self.sections.initial_state()
        self.equilibrium = {}
        self._keep()
        self.update()

    def update(self):
        """Bring the trial state to the increments in `self.increment` (ghosts up to date).

        Returns:
            True, or False if the law found no solution at some section point of this rank.
        """
        increment, start = self.increment.x.array, self.equilibrium
        # Chords are carried on by differences of the increments: those of the positions would lose digits in l/L.
        moved = increment[self.u_dofs]
        np.add(start["x"], moved, out=self.x)
        self.chord = start["chord"] + (moved[self.cells[:, 1]] - moved[self.cells[:, 0]])
        turn_nodes(increment[self.turn_dofs], start["R"], self.R, self.chart)
        self.shear = start["shear"] + increment[self.shear_dofs]
        section_strains(
            self.cells, self.chord, self.R, self.E0, self.l0, self.shear, self.share.values[:, 0], GAUSS,
            self.E.values, self.P.values, self.W.values, self.strain,
        )  # fmt: skip
        self.T.values[:] = self.chart[self.cells]
        return self.sections.update(self.strain, start, self.points, self.s.values, self.D.values)

    def commit(self):
        """Make the trial state the equilibrium and set the increments to zero."""
        self.sections.update_surface(self.strain, self.equilibrium, self.points)
        self._keep()

    def _keep(self):
        self.equilibrium = {name: getattr(self, name).copy() for name in ("x", "chord", "R", "shear", "strain")}
        self.equilibrium |= {name: rows.copy() for name, rows in self.points.items()}
        self.increment.x.array[:] = 0.0

    def restore(self):
        """Go back to the last equilibrium."""
        self.points["surface_state"][:] = self.equilibrium["surface_state"]
        self.increment.x.array[:] = 0.0
        return self.update()

    def assemble_forces(self, vector):
        """Add the internal nodal forces ∫ ¹σ : δΔE_l of the owned cells to a local array (owned and ghost dofs)."""
        fem.assemble_vector(vector, self._residual)

    def assemble_tangent(self, matrix):
        """Add K_l and the stiffness of the turning frame to a PETSc matrix; values stay unassembled."""
        fem.petsc.assemble_matrix(matrix, self._tangent)
