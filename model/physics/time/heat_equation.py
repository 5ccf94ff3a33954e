"""Heat along the wire: conduction, convection to air, and what goes into the seats, as UFL forms on the line mesh.

    ρ c A Ṫ = (k A T′)′ − h U (T − T∞) + q,     k A T′ n = −g (T − T∞) at both tips,

with A = πr², or what grinding has left of it, U = 2πr, and q the heat that plastic work gives a length. Linear
elements, second order in their length; backward Euler in time. Lengths are those of the wire in the state the rod is
in.
"""

from dataclasses import dataclass

import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem.petsc import assemble_matrix, assemble_vector
from petsc4py import PETSc

from coilset.meshes.line import LineMesh
from coilset.model.core.base.agreement import sum_of_ranks
from coilset.model.core.base.compat import geometry_dofs
from coilset.model.core.rod import forms
from coilset.model.core.rod.elements import THESIS, Element


@dataclass(frozen=True)
class HeatConstants:
    """Of the wire and its surroundings.

    Attributes:
        capacity: ρ c, N/(mm² K).
        conductivity: k, N/(s K), which is W/(m K).
        convection: h, N/(mm s K), a thousandth of W/(m² K).
        tips: g of each tip, N mm/(s K), a thousand times W/K.
        surroundings: T∞ at the start, K.
    """

    capacity: float
    conductivity: float
    convection: float
    tips: float
    surroundings: float


class HeatEquation:
    """Temperature along the wire.

    Args:
        line: LineMesh; its mesh's coordinates are those of the moment.
        radius: of the wire, of all local cells, shape (local cells,), mm.
        start: temperature at the start, K.
        element: whose sections give heat.
        stretch: length of wire over length of chord at the sections of the local cells, shape (cells, sections);
            None: the wire is straight between the nodes.
        left: part of the round section that grinding has left there, shape (cells, sections); None: all.

    Attributes:
        temperature: function of the nodes, K.
        dofs: place of each local node in it, shape (local nodes,).
        surroundings: T∞ now, a constant of the forms, K.
        source: heat that a length got over the step, at the sections of the local cells, shape (cells, sections), N.
    """

    def __init__(
        self,
        line: LineMesh,
        radius: np.ndarray,
        constants: HeatConstants,
        start: float,
        element: Element = THESIS,
        stretch: np.ndarray | None = None,
        left: np.ndarray | None = None,
    ) -> None:
        self.line, mesh, self.constants = line, line.mesh, constants
        self.temperature = fem.Function(fem.functionspace(mesh, ("Lagrange", 1)))
        self.temperature.x.array[:] = start
        self.dofs = np.empty(len(line.node), dtype=np.int64)
        self.dofs[geometry_dofs(mesh)] = self.temperature.function_space.dofmap.list
        before = fem.Function(self.temperature.function_space)
        heat = fem.Function(fem.functionspace(mesh, forms.section_element((), element)))
        longer, whole = fem.Function(heat.function_space), fem.Function(heat.function_space)
        longer.x.array[:] = 1.0 if stretch is None else stretch.ravel()
        whole.x.array[:] = 1.0 if left is None else left.ravel()
        wire = fem.Function(fem.functionspace(mesh, ("DG", 0)))
        wire.x.array[:] = radius
        self.source, self._before = heat.x.array.reshape(-1, len(element.abscissae)), before
        self._seconds = fem.Constant(mesh, PETSc.ScalarType(1.0))
        area, around = np.pi * wire**2 * whole, 2.0 * np.pi * wire
        capacity, conductivity, convection, air, first = (
            fem.Constant(mesh, PETSc.ScalarType(getattr(constants, name)))
            for name in ("capacity", "conductivity", "convection", "surroundings", "surroundings")
        )
        self.surroundings = air
        tips = self._at_tips(constants.tips)
        dx, tip = ufl.dx(metadata=forms.at_sections(element)), ufl.ds
        T, v = ufl.TrialFunction(self.temperature.function_space), ufl.TestFunction(self.temperature.function_space)
        t, now = self._seconds, self.temperature

        def outwards(of: ufl.core.expr.Expr, test: ufl.core.expr.Expr) -> ufl.Form:
            return convection * around * of * test * longer * dx + tips * of * test * tip

        conducted = conductivity * area * ufl.inner(ufl.grad(T), ufl.grad(v)) / longer * dx
        self._left = fem.form(capacity * area * T * v * longer * dx + t * (conducted + outwards(T, v)))
        warm = (capacity * area * before + heat) * v * longer * dx
        self._right = fem.form(warm + t * outwards(air, v))
        self._loss = fem.form(outwards(now - air, fem.Constant(mesh, PETSc.ScalarType(1.0))))
        self._content = fem.form(capacity * area * (now - first) * longer * dx)

    def _at_tips(self, value: float) -> fem.Function:
        """A function of the nodes, zero but at both tips: between two ranks, too, DOLFINx sees an end of a line."""
        function, line = fem.Function(self.temperature.function_space), self.line
        function.x.array[self.dofs[np.isin(line.node, (0, len(line.stations) - 1))]] = value
        return function

    def advance(self, seconds: float) -> float:
        """Go on by some seconds, in which the lengths of wire get the heat `source`; collective.

        Returns:
            Heat that went into air and seats meanwhile, N mm; the same on every rank.
        """
        self._seconds.value = seconds
        self._before.x.array[:] = self.temperature.x.array
        matrix, vector = assemble_matrix(self._left), assemble_vector(self._right)
        matrix.assemble()
        vector.ghostUpdate(addv=PETSc.InsertMode.ADD, mode=PETSc.ScatterMode.REVERSE)
        solver = PETSc.KSP().create(self.line.mesh.comm)
        solver.setType(PETSc.KSP.Type.PREONLY)
        solver.pc.setType(PETSc.PC.Type.LU)
        solver.pc.setFactorSolverType(PETSc.Mat.SolverType.MUMPS)
        solver.setOperators(matrix)
        solution = matrix.createVecRight()
        solver.solve(vector, solution)
        owned = solution.getLocalSize()
        self.temperature.x.array[:owned] = solution.array
        self.temperature.x.scatter_forward()
        for part in (solver, matrix, vector, solution):
            part.destroy()
        return seconds * self._sum(self._loss)

    @property
    def content(self) -> float:
        """∫ ρ c (T − T∞) dV with T∞ at the start, N mm; collective."""
        return self._sum(self._content)

    def at_sections(self, abscissae: np.ndarray) -> np.ndarray:
        """Temperature at abscissae ξ (0 to 1) of the local cells, shape (cells, abscissae), K."""
        ends = self.temperature.x.array[self.temperature.function_space.dofmap.list]
        return ends[:, :1] + (ends[:, 1:] - ends[:, :1]) * abscissae

    def _sum(self, form: fem.Form) -> float:
        return sum_of_ranks(self.line.mesh.comm, fem.assemble_scalar(form))
