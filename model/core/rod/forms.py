"""The rod's updated-Lagrangian virtual work as UFL forms on the current configuration (4.3.4, Tables 5.1 and 5.2).

Every form is linear in the increments about the current mesh. Inside a cell the nodal values of a P1 function are
f1 = f − ξ d and f2 = f1 + d with d = f,ξ; ξ is a quadrature coefficient. Rotations enter through their chart: the
virtual rotation of node a is ω = Ta ψ, so that the residual is that of the chart: PETSc adds updates, and finite
rotations do not add.
"""

from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import basix.ufl
import numpy as np
import ufl
from dolfinx import fem
from dolfinx import mesh as dmesh
from ufl import as_matrix, as_vector, cross, dot, grad, inner, sqrt

from coilset.model.core.rod.elements import PER_LENGTH, Element, legendre


@dataclass
class Increment:
    """A linear increment of one element in the global frame: chord difference, nodal rotations, own unknowns."""

    d: ufl.core.expr.Expr
    rotation1: ufl.core.expr.Expr
    rotation2: ufl.core.expr.Expr
    own: ufl.core.expr.Expr


@cache
def rod_element(element: Element) -> Any:
    """Two nodes with displacement and rotation vector (P1, 6 values) and the element's own unknowns (DG0)."""
    nodal = basix.ufl.element("Lagrange", "interval", 1, shape=(6,))
    own = basix.ufl.element("DG", "interval", 0, shape=(element.own,))
    return basix.ufl.mixed_element([nodal, own])


def section_element(shape: tuple[int, ...], element: Element) -> Any:
    """Values at the sections of an element; `shape` of one value."""
    points, weights = element.xi[:, None], np.array(element.weights)
    return basix.ufl.quadrature_element("interval", value_shape=shape, points=points, weights=weights)


def at_sections(element: Element) -> dict[str, Any]:
    """Metadata of an integral that is a sum over the sections."""
    return {
        "quadrature_rule": "custom",
        "quadrature_points": tuple((xi,) for xi in element.abscissae),
        "quadrature_weights": element.weights,
    }


def cell_element(shape: tuple[int, ...]) -> Any:
    """One value per element."""
    return basix.ufl.element("DG", "interval", 0, shape=shape)


# The coefficients of RodForms by name, in the order of its arguments: what makes the finite element of each, for those
# at the sections from the Element.
FIELDS: dict[str, partial[Any]] = {
    "xi": partial(section_element, ()),
    "timoshenko_factor": partial(cell_element, ()),
    "E": partial(cell_element, (3, 3)),
    "T": partial(cell_element, (2, 3, 3)),
    "P": partial(cell_element, (2, 3, 3)),
    "W": partial(cell_element, (3, 3)),
    "e": partial(section_element, (6,)),
    "s": partial(section_element, (6,)),
    "predicted": partial(section_element, (6,)),
    "D": partial(section_element, (6, 6)),
}


def field_elements(element: Element) -> dict[str, Any]:
    """The finite elements of FIELDS."""
    return {name: make(element=element) if make.func is section_element else make() for name, make in FIELDS.items()}


def matrices(coefficient: Any) -> list[Any]:
    """The two 3×3 matrices of a coefficient of shape (2, 3, 3)."""
    return [as_matrix([[coefficient[a, i, j] for j in range(3)] for i in range(3)]) for a in range(2)]


def increment(mesh: dmesh.Mesh, function: Any, xi: Any, T: Any) -> Increment:
    """The increment of a test or trial function; `T` holds the charts' tangents of the two nodes, shape (2, 3, 3)."""
    f, own = ufl.split(function)
    d = dot(grad(f), ufl.Jacobian(mesh)[:, 0])  # f,ξ
    f1 = f - xi * d
    f2 = f1 + d
    chart1, chart2 = matrices(T)
    return Increment(
        as_vector([d[i] for i in range(3)]),
        chart1 * as_vector([f1[i] for i in range(3, 6)]),
        chart2 * as_vector([f2[i] for i in range(3, 6)]),
        own,
    )


def section_strains(
    increment: Increment,
    element: Element,
    E: Any,
    l: Any,
    xi: Any,
    timoshenko_factor: Any,
    P: Any = None,
    spin: Any = 0,
) -> Any:
    """ε, γ12, γ13, φ′, −w″, v″ of an increment in the triad E (columns), from (5.2.4).

    Rotations are relative to the triad, whose transverse spin is the chord's and whose spin about the chord is `spin`.
    `P`, shape (2, 3, 3), maps the relative spins to the exact rates of the rotations; without it the rotations are
    small, as in the thesis.

    The first two of the element's own unknowns are the shear angles in excess of those that its rotations produce in
    an elastic element, u = shear − c ½ (t1 + t2) with Timoshenko's c, `timoshenko_factor` (docs/theory/element.md says
    why). The chord's curve is H1 … H4 with the same bow b = u + ½ (t1 + t2) at both ends and ±(t2 − t1)/2 besides. The
    others are the modes of its strains, see coilset.model.core.rod.elements.
    """
    d = E.T * increment.d
    frame = as_vector([spin, -d[2] / l, d[1] / l])
    t1, t2 = E.T * increment.rotation1 - frame, E.T * increment.rotation2 - frame
    if P is not None:
        P1, P2 = matrices(P)
        t1, t2 = P1 * t1, P2 * t2
    m13, m14 = (t1[1] + t2[1]) / 2, (t1[2] + t2[2]) / 2
    u13, u14 = increment.own[0] - timoshenko_factor * m13, increment.own[1] - timoshenko_factor * m14
    b13, b14 = u13 + m13, u14 + m14
    H = (12 * xi - 6) / l  # H2″ + H4″, times l
    e = [d[0] / l, u14, -u13, (t2[0] - t1[0]) / l, (t2[1] - t1[1]) / l + H * b13, (t2[2] - t1[2]) / l + H * b14]
    for k, (strain, degree) in enumerate(element.modes):
        mode = legendre(degree, xi) * increment.own[2 + k]
        e[strain] += mode / l if strain >= PER_LENGTH else mode
    return as_vector(e)


def axial_spin(increment: Increment, W: Any) -> Any:
    """Spin of the element's triad about its chord; `W`, shape (3, 3), from `kinematics.mean_triad`."""
    return sum(dot(W[k, :], rate) for k, rate in enumerate((increment.d, increment.rotation1, increment.rotation2)))


def spun(increment: Increment, spin: Any) -> Increment:
    """The virtual increment as it appears from a spinning triad: δu → −spin × δu in the fixed frame."""
    d, rotation1, rotation2 = (-cross(spin, v) for v in (increment.d, increment.rotation1, increment.rotation2))
    return Increment(d, rotation1, rotation2, 0 * increment.own)


class RodForms:
    """Residual and tangents of the rod.

    Args:
        element: Element.
        mesh: the current configuration.
        V: space of rod_element.
        xi: abscissa ξ of the sections.
        timoshenko_factor: c of section_strains, one value per element.
        E: triad of the element (columns), shape (3, 3).
        T: tangents of the rotation charts of both nodes, shape (2, 3, 3).
        P: rates of the rotations for a relative spin, shape (2, 3, 3), see section_strains.
        W: for the triad's spin about its chord, shape (3, 3), see coilset.model.core.rod.kinematics.mean_triad.
        e: section strains ε, γ12, γ13, φ′, −w″, v″.
        s: section resultants N, Q2, Q3 in N and Mt, M2, M3 in N mm.
        predicted: section resultants that the frame stiffness is built with, see coilset.model.core.rod.prediction.
        D: section tangent ∂s/∂e, shape (6, 6).

    All are coefficients in the mesh's quadrature or cell spaces.
    """

    def __init__(
        self,
        element: Element,
        mesh: dmesh.Mesh,
        V: fem.FunctionSpace,
        xi: Any,
        timoshenko_factor: Any,
        E: Any,
        T: Any,
        P: Any,
        W: Any,
        e: Any,
        s: Any,
        predicted: Any,
        D: Any,
    ) -> None:
        self.test = increment(mesh, ufl.TestFunction(V), xi, T)
        self.trial = increment(mesh, ufl.TrialFunction(V), xi, T)
        J = ufl.Jacobian(mesh)[:, 0]
        self.element, self.xi, self.timoshenko_factor, self.E, self.P = element, xi, timoshenko_factor, E, P
        self.e, self.s, self.predicted, self.D = e, s, predicted, D
        self.l = sqrt(dot(J, J))
        self.stretch = dot(E[:, 0], self.trial.d) / self.l
        self.spin = axial_spin(self.trial, W)
        self.dx = ufl.dx(domain=mesh, metadata=at_sections(element))

    def strains(self, increment: Increment) -> Any:
        """Section strains of an increment in the current triad, for small rotations relative to it."""
        return section_strains(increment, self.element, self.E, self.l, self.xi, self.timoshenko_factor)

    @property
    def residual(self) -> Any:
        """∫ ¹σ : δΔE_l, the internal nodal forces (4.4.1)."""
        return inner(self.s, self.strains(self.test)) * self.dx

    @property
    def material_stiffness(self) -> Any:
        """K_l = ∫ δe · D Δe."""
        rates = section_strains(
            self.trial, self.element, self.E, self.l, self.xi, self.timoshenko_factor, self.P, self.spin
        )
        curvature = as_vector([0, 0, 0, self.e[3], self.e[4], self.e[5]])  # falls as the chord grows
        return inner(self.strains(self.test), self.D * (rates - self.stretch * curvature)) * self.dx

    @property
    def frame_stiffness(self) -> Any:
        """Change of the internal forces as the element's triad rotates and its chord changes length under the forces.

        With K_l it is the derivative of the residual if the predicted resultants are the true ones, except for the
        charts' curvature, which is proportional to the out-of-balance moments.
        """
        e1 = self.E[:, 0]
        rotated = spun(self.test, cross(e1, self.trial.d) / self.l + self.spin * e1)
        # l δe by the length l: rotations and own unknowns enter it in ε and γ with l, the chord in w″, v″ with 1/l
        test, nothing = self.test, 0 * self.test.d
        still = self.strains(Increment(nothing, test.rotation1, test.rotation2, test.own))
        moved = self.strains(Increment(test.d, nothing, nothing, 0 * test.own))
        s = self.predicted
        lengthened = sum(s[k] * still[k] for k in (0, 1, 2)) - sum(s[k] * moved[k] for k in (4, 5))
        return (inner(s, self.strains(rotated)) + self.stretch * lengthened) * self.dx
