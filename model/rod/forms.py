"""The rod's updated-Lagrangian virtual work as UFL forms on the current configuration (4.3.4, Tables 5.1 and 5.2).

Every form is linear in the increments about the current mesh. Inside a cell the nodal values of a P1 function are
f1 = f − ξ d and f2 = f1 + d with d = f,ξ; ξ is a quadrature coefficient. Rotations enter through their chart: the
virtual turn of node a is ω = Ta ψ, so that the residual is the one of the chart (PETSc adds updates, turns do not add).
"""

from dataclasses import dataclass

import basix.ufl
import ufl
from ufl import as_matrix, as_vector, cross, dot, grad, inner, sqrt

QUADRATURE = {"quadrature_degree": 3, "quadrature_rule": "default"}  # two Gauss sections (5.2.43)


@dataclass
class Increment:
    """A linear increment of one element in the global frame: chord difference, nodal turns, bows."""

    d: ufl.core.expr.Expr
    turn1: ufl.core.expr.Expr
    turn2: ufl.core.expr.Expr
    bow: ufl.core.expr.Expr


def rod_element():
    """Two nodes with displacement and rotation vector (P1, 6 values) and two bows per element (DG0)."""
    nodal = basix.ufl.element("Lagrange", "interval", 1, shape=(6,))
    bow = basix.ufl.element("DG", "interval", 0, shape=(2,))
    return basix.ufl.mixed_element([nodal, bow])


def section_element(shape):
    """Values at the two Gauss sections of an element; `shape` of one value."""
    return basix.ufl.quadrature_element("interval", value_shape=shape, degree=3)


def cell_element(shape):
    """One value per element."""
    return basix.ufl.element("DG", "interval", 0, shape=shape)


def matrices(coefficient):
    """The two 3×3 matrices of a coefficient of shape (2, 3, 3)."""
    return [as_matrix([[coefficient[a, i, j] for j in range(3)] for i in range(3)]) for a in range(2)]


def increment(mesh, function, xi, T):
    """The increment of a test or trial function; `T` holds the charts' tangents of the two nodes, shape (2, 3, 3)."""
    f, bow = ufl.split(function)
    d = dot(grad(f), ufl.Jacobian(mesh)[:, 0])  # f,ξ
    f1 = f - xi * d
    f2 = f1 + d
    chart1, chart2 = matrices(T)
    return Increment(
        as_vector([d[i] for i in range(3)]),
        chart1 * as_vector([f1[i] for i in range(3, 6)]),
        chart2 * as_vector([f2[i] for i in range(3, 6)]),
        bow,
    )


def section_strains(increment, E, l, xi, P=None):
    """ε, γ12, γ13, φ′, −w″, v″ of an increment in the triad E (columns), from (5.2.4).

    Turns count against the triad, whose transverse spin is the chord's. `P`, shape (2, 3, 3), makes of the relative
    spins the exact rates of the turns; without it the turns are small, as in the thesis.

    The element's own unknowns are the bows b = u + (t1 + t2)/2 in the place of the shear angles u13, u14: the chord's
    curve is H1 … H4 with the same b at both ends and ±(t2 − t1)/2 besides. The solution is the same, but a finite turn
    within an iteration then ends as a small shear angle, not as a curvature 6/l times as large, which would ask for
    more iterations the shorter the elements are, and the matrix has no entries 12 E I/l³ that cancel.
    """
    d = E.T * increment.d
    chord = as_vector([0, -d[2] / l, d[1] / l])
    t1, t2 = E.T * increment.turn1 - chord, E.T * increment.turn2 - chord
    if P is not None:
        mean = as_vector([0.5 * (t1[0] + t2[0]), 0, 0])
        P1, P2 = matrices(P)
        t1, t2 = P1 * (t1 - mean), P2 * (t2 - mean)
    b13, b14 = increment.bow[0], increment.bow[1]
    u13, u14 = b13 - (t1[1] + t2[1]) / 2, b14 - (t1[2] + t2[2]) / 2
    H = (12 * xi - 6) / l  # H2″ + H4″, times l
    return as_vector(
        [d[0] / l, u14, -u13, (t2[0] - t1[0]) / l, (t2[1] - t1[1]) / l + H * b13, (t2[2] - t1[2]) / l + H * b14]
    )


def frame_spin(increment, E, l):
    """Spin of the element's triad: that of the chord, and the mean of the nodes' about it."""
    e1 = E[:, 0]
    return cross(e1, increment.d) / l + 0.5 * dot(e1, increment.turn1 + increment.turn2) * e1


def spun(increment, spin):
    """The virtual increment as seen when the triad turns under it: δu → −spin × δu in the fixed frame."""
    return Increment(*(-cross(spin, v) for v in (increment.d, increment.turn1, increment.turn2)), 0 * increment.bow)


class RodForms:
    """Residual and tangents of the rod.

    Args:
        mesh: the current configuration.
        V: space of rod_element.
        xi, E, T, P, s, D: abscissa, triad, chart tangents, rates of the turns, section resultants, section tangent.
    """

    def __init__(self, mesh, V, xi, E, T, P, s, D):
        self.test = increment(mesh, ufl.TestFunction(V), xi, T)
        self.trial = increment(mesh, ufl.TrialFunction(V), xi, T)
        J = ufl.Jacobian(mesh)[:, 0]
        self.xi, self.E, self.P, self.l, self.s, self.D = xi, E, P, sqrt(dot(J, J)), s, D
        self.dx = ufl.dx(domain=mesh, metadata=QUADRATURE)

    def strains(self, increment, P=None):
        """Section strains of an increment in the current triad."""
        return section_strains(increment, self.E, self.l, self.xi, P)

    @property
    def residual(self):
        """∫ ¹σ : δΔE_l, the internal nodal forces (4.4.1)."""
        return inner(self.s, self.strains(self.test)) * self.dx

    @property
    def material_stiffness(self):
        """K_l = ∫ δe · D Δe."""
        return inner(self.strains(self.test), self.D * self.strains(self.trial, self.P)) * self.dx

    @property
    def frame_stiffness(self):
        """Change of the internal forces as the element's triad turns and its chord changes length under the forces.

        With K_l it is the derivative of the residual, but for products of a turn against the triad and a strain.
        """
        turned = spun(self.test, frame_spin(self.trial, self.E, self.l))
        stretch = dot(self.E[:, 0], self.trial.d) / self.l
        still = self.strains(Increment(0 * self.test.d, self.test.turn1, self.test.turn2, self.test.bow))
        lengthened = self.s[1] * still[1] + self.s[2] * still[2]
        return (inner(self.s, self.strains(turned)) + stretch * lengthened) * self.dx
