"""UFL forms of the solid on the current configuration: virtual work, its linearisation, displacement gradient."""

from collections.abc import Sequence
from typing import Any

import basix.ufl
import numpy as np
import ufl
from dolfinx import fem
from ufl.core.expr import Expr

from coilset.model.physics.solid.configuration import QUADRATURE_DEGREE, Configuration

# Order of the six components: 11, 22, 33, 12, 13, 23; shear strains are doubled.
PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


def strain_components(g: Expr) -> Expr:
    """Components of the symmetric part of a gradient, shear doubled."""
    return ufl.as_vector([g[i, i] if i == j else g[i, j] + g[j, i] for i, j in PAIRS])


def as_tensor(σ: Sequence[Any] | Expr) -> Expr:
    """Symmetric tensor of six components."""
    index = {pair: k for k, pair in enumerate(PAIRS)}
    return ufl.as_tensor([[σ[index[min(i, j), max(i, j)]] for j in range(3)] for i in range(3)])


class SolidForms:
    """Coefficients at the integration points and the compiled forms over them.

    Attributes:
        u: displacement increment since the last equilibrium, mm.
        stress: Cauchy stress, 6 components at each point, MPa.
        moduli: A in δσ-work = δd : A : d, 6 × 6 at each point, MPa; see `kinematics.push_forward`.
        points: reference points that carry the state, shape (n, 3).
        residual, tangent: compiled forms on the current configuration.
    """

    def __init__(self, configuration: Configuration) -> None:
        V, mesh, degree = configuration.V, configuration.mesh, QUADRATURE_DEGREE
        cell = mesh.basix_cell()
        points = lambda shape: fem.functionspace(  # noqa: E731
            mesh, basix.ufl.quadrature_element(cell.name, value_shape=shape, degree=degree)
        )
        self.u = fem.Function(V)
        self.stress = fem.Function(points((6,)))
        self.moduli = fem.Function(points((6, 6)))
        self.points = basix.make_quadrature(cell, degree)[0]
        self.dx = ufl.dx(domain=mesh, metadata={"quadrature_degree": degree, "quadrature_rule": "default"})
        v, du = ufl.TestFunction(V), ufl.TrialFunction(V)
        σ = as_tensor(self.stress)
        # (4.4.1) on the current volume, and its linearisation: material part and initial stress
        of_v, of_du = ufl.grad(v), ufl.grad(du)
        work = ufl.dot(self.stress, strain_components(of_v)) * self.dx
        material = ufl.dot(strain_components(of_v), ufl.dot(self.moduli, strain_components(of_du)))
        initial = ufl.inner(of_v, ufl.dot(of_du, σ))
        self.residual = fem.form(work)
        self.tangent = fem.form((material + initial) * self.dx)
        # ∂Δu/∂x in the current configuration, which gives the increment F = (1 − ∂Δu/∂x)⁻¹
        self.gradient = fem.Expression(ufl.grad(self.u), self.points)

    def evaluate_gradient(self, cells: np.ndarray) -> np.ndarray:
        """∂Δu/∂x at the points of the cells on the current mesh, shape (cells × points, 3, 3)."""
        return self.gradient.eval(self.u.function_space.mesh, np.asarray(cells, np.int32)).reshape(-1, 3, 3)
