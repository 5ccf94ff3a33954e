"""UFL forms of the helical slice on the mesh of its section; docs/slice.md derives them.

A point of the coil is x = Q(λt) x₀(ξ, η) + h̄ t e_z: Q rotates about the coil's axis e_z, x₀ is the position of the
slice t = 0, h̄ the rise and λ the rotation per radian of the unloaded coil. With Ω v = e_z × v its tangents at t = 0
are

    F̂ = [ x₀,ξ | x₀,η | λ Ω x₀ + h̄ e_z ]

and a variation (v, μ, χ) of (x₀, λ, h̄) has the spatial gradient L = Ĝ F̂⁻¹,

    Ĝ(v, μ, χ) = [ v,ξ | v,η | λ Ω v + μ Ω x₀ + χ e_z ].

The virtual work per radian is ∫ σ : L |det F̂| dξ dη; the factor of χ is the axial force, that of μ the torque.
"""

from functools import cached_property
from typing import Any

import basix.ufl
import numpy as np
import ufl
from dolfinx import fem

from coilset.meshes.sections.mesh import SectionMesh
from coilset.model.physics.solid.forms import as_tensor, strain_components

# The points that carry the state integrate products of gradients exactly on a triangle with straight sides.
QUADRATURE_DEGREE = {2: 2, 3: 4}
RISE, TURN = 0, 1  # the two numbers h̄ and λ


def about_axis(v: Any) -> Any:
    """Ω v = e_z × v."""
    return ufl.as_vector([-v[1], v[0], 0.0])


def along_axis(χ: Any) -> Any:
    """χ e_z."""
    return ufl.as_vector([0.0, 0.0, χ])


def tangents(v: Any, third: Any) -> Any:
    """The matrix [ v,ξ | v,η | third ]."""
    return ufl.as_matrix([[v[i].dx(0), v[i].dx(1), third[i]] for i in range(3)])


def last_column(third: Any) -> Any:
    """The matrix [ 0 | 0 | third ]."""
    return ufl.as_matrix([[0.0, 0.0, third[i]] for i in range(3)])


class SliceForms:
    """Coefficients of the slice and the compiled forms over them.

    Attributes:
        V: vector space of positions and displacements on the section.
        x: x₀ at the last equilibrium, mm; u: its increment since then, mm.
        old: h̄ in mm/rad and λ at the last equilibrium; increment: their change since; each a Constant of shape (2,).
        stress: Cauchy stress at the points, 6 components, MPa; moduli: A of `solid.kinematics.push_forward`, 6 × 6.
        points: reference points that carry the state, shape (n, 2); weights: of the quadrature, shape (n,).
        cells: all cells of the mesh.
    """

    def __init__(self, section: SectionMesh):
        mesh = section.mesh
        degree = QUADRATURE_DEGREE[section.degree]
        at_points = lambda shape: fem.functionspace(  # noqa: E731
            mesh, basix.ufl.quadrature_element(mesh.basix_cell(), value_shape=shape, degree=degree)
        )
        self.mesh = mesh
        self.V = fem.functionspace(mesh, ("P", section.degree, (3,)))
        self.x, self.u = fem.Function(self.V), fem.Function(self.V)
        self.old, self.increment = (fem.Constant(mesh, np.zeros(2)) for _ in range(2))
        self.stress, self.moduli = fem.Function(at_points((6,))), fem.Function(at_points((6, 6)))
        self.points, self.weights = basix.make_quadrature(mesh.basix_cell(), degree)
        dx = ufl.dx(domain=mesh, metadata={"quadrature_degree": degree, "quadrature_rule": "default"})

        x, λ, h = self.x + self.u, self.old[TURN] + self.increment[TURN], self.old[RISE] + self.increment[RISE]
        F = tangents(x, λ * about_axis(x) + along_axis(h))
        inverse, volume = ufl.inv(F), abs(ufl.det(F))
        σ = as_tensor(self.stress)
        v, du = ufl.TestFunction(self.V), ufl.TrialFunction(self.V)
        variation = {
            "u": lambda v: tangents(v, λ * about_axis(v)),
            RISE: last_column(along_axis(1.0)),
            TURN: last_column(about_axis(x)),
        }

        def work(G: Any) -> Any:
            """Virtual work of a variation."""
            return ufl.inner(σ, G * inverse) * volume * dx

        def change(G: Any, dG: Any, second: Any = None) -> Any:
            """Change of the work of the variation G due to the motion dG, including its effect on G itself."""
            L, dL = G * inverse, dG * inverse
            material = ufl.dot(strain_components(L), ufl.dot(self.moduli, strain_components(dL)))
            form = (material + ufl.inner(L, dL * σ)) * volume * dx
            return form if second is None else form + work(second)

        of_u, with_du = variation["u"](v), variation["u"](du)
        turned = last_column(about_axis(v))  # ∂Ĝ(v)/∂λ, and the same for the torque's derivative by u
        self._expressions = {
            "residual": lambda: work(of_u),
            "tangent": lambda: change(of_u, with_du),
            ("column", RISE): lambda: change(of_u, variation[RISE]),
            ("column", TURN): lambda: change(of_u, variation[TURN], turned),
            ("row", RISE): lambda: change(variation[RISE], of_u),
            ("row", TURN): lambda: change(variation[TURN], of_u, turned),
            ("resultant", RISE): lambda: work(variation[RISE]),
            ("resultant", TURN): lambda: work(variation[TURN]),
        } | {
            ("corner", i, j): lambda i=i, j=j: change(variation[i], variation[j])
            for i in (RISE, TURN)
            for j in (RISE, TURN)
        }
        self._compiled: dict[str | tuple, fem.Form] = {}
        self._motion(F, inverse)
        self.cells = np.arange(mesh.topology.index_map(2).size_local, dtype=np.int32)

    def __getitem__(self, name: str | tuple) -> fem.Form:
        """A form, compiled on first use.

        Args:
            name: ``residual``, virtual work of v per radian, N; ``tangent``, its derivative by u; ``("column", k)``,
                its derivative by h̄ or λ; ``("row", k)``, derivative of force or torque by u; ``("corner", k, m)``, by
                h̄ or λ; ``("resultant", k)``, axial force (tension positive, N) or torque (N mm). k is RISE or TURN.
        """
        if name not in self._compiled:
            self._compiled[name] = fem.form(self._expressions[name]())
        return self._compiled[name]

    def _motion(self, F: Any, inverse: Any) -> None:
        """1 − F̂_old F̂⁻¹ = ΔF̂ F̂⁻¹, the gradient of the increment in its final configuration, and F̂ itself."""
        x, u, old, new = self.x, self.u, self.old, self.increment
        third = new[TURN] * about_axis(x + u) + old[TURN] * about_axis(u) + along_axis(new[RISE])
        self._gradient = fem.Expression(tangents(u, third) * inverse, self.points)
        self._tangents = F

    def evaluate_gradient(self) -> np.ndarray:
        """ΔF̂ F̂⁻¹ at the points, the input of `solid.kinematics.stretches`, shape (cells × points, 3, 3)."""
        return self._gradient.eval(self.mesh, self.cells).reshape(-1, 3, 3)

    def evaluate_tangents(self) -> np.ndarray:
        """F̂ at the points, shape (cells × points, 3, 3)."""
        return self._placed_tangents.eval(self.mesh, self.cells).reshape(-1, 3, 3)

    @cached_property
    def _placed_tangents(self) -> fem.Expression:
        return fem.Expression(self._tangents, self.points)


def assemble(form: fem.Form) -> np.ndarray:
    """A linear form assembled to an array over the space."""
    return fem.assemble_vector(form).array
