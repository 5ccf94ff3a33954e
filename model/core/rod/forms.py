"""The rod's virtual work as UFL forms: the variation of the strains that its sections see, and its derivative.

The rod of the program has internal forces ∫ s · δe dx₀ over the stress-free length, with the variation δe of the very
strains that its sections see (`kinematics.section_strains`), so that an elastic rod has a potential. The thesis's
element takes the strains of small rotations, (4.3.4) and Table 5.2, on the current length. The unknowns are increments
about the current configuration. Rotations enter through their chart: the virtual rotation of node a is ω = Ta ψ, so
that the residual is that of the chart: PETSc adds updates, and finite rotations do not add.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import basix.ufl
import numpy as np
import ufl
from dolfinx import fem
from dolfinx import mesh as dmesh

from coilset.model.core.rod.elements import PER_LENGTH, STRAINS, Element, legendre

LOCAL = 9  # values of a chord difference and two spins


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
    "l0": partial(cell_element, ()),
    "l": partial(cell_element, ()),
    "E": partial(cell_element, (3, 3)),
    "T": partial(cell_element, (2, 3, 3)),
    "theta": partial(cell_element, (2, 3)),
    "factors": partial(cell_element, (2, 2)),
    "mean": partial(cell_element, (2, 3)),
    "e": partial(section_element, (6,)),
    "s": partial(section_element, (6,)),
    "predicted": partial(section_element, (6,)),
    "D": partial(section_element, (6, 6)),
}


def field_elements(element: Element) -> dict[str, Any]:
    """The finite elements of FIELDS."""
    return {name: make(element=element) if make.func is section_element else make() for name, make in FIELDS.items()}


Vector = Sequence[Any]  # of scalar expressions and numbers: FFCx needs minutes for tensors with so many components


def dot(a: Vector, b: Vector) -> Any:
    """a · b."""
    return sum(x * y for x, y in zip(a, b, strict=True))


def cross(a: Vector, b: Vector) -> Vector:
    """a × b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def plus(a: Vector, b: Vector, factor: Any = 1) -> Vector:
    """a + factor b."""
    return tuple(x + factor * y for x, y in zip(a, b, strict=True))


@dataclass
class Increment:
    """A local increment of one element, in its triad: chord difference, spins of its nodes, own unknowns."""

    d: Vector
    spins: tuple[Vector, Vector]
    own: Vector

    @classmethod
    def unit(cls, number: int, element: Element) -> "Increment":
        """With one value 1 and all others 0, in the order of the unknowns."""
        values = [float(k == number) for k in range(LOCAL + element.own)]
        return cls(values[0:3], (values[3:6], values[6:9]), values[LOCAL:])


class State:
    """What the virtual strains of an element depend on, in its triad.

    Args:
        l, theta, factors, mean: as in RodForms.

    Attributes:
        variables: its numbers one after the other, by which expressions can be differentiated.
    """

    def __init__(self, l: Any, theta: Any, factors: Any, mean: Any) -> None:
        self.l = ufl.variable(l)
        self.theta, self.mean = ([[ufl.variable(v[a, i]) for i in range(3)] for a in range(2)] for v in (theta, mean))
        self.c, self.c_rate = [ufl.variable(factors[a, 0]) for a in range(2)], [factors[a, 1] for a in range(2)]
        self.variables = [self.l, *self.theta[0], *self.theta[1], *self.c, *self.mean[0], *self.mean[1]]


class RodForms:
    """Residual and tangent of the rod.

    Both are set up in the triad of an element, in which its strains depend on few numbers, and are turned to its
    unknowns q by the local increments R q that these make: Rᵀ g and Rᵀ K R.

    Args:
        element: Element.
        mesh: line mesh of the rod.
        V: space of the unknowns of an element, cell_element((unknowns,)).
        xi: abscissa ξ of the sections.
        timoshenko_factor: c of `strains`, one value per element.
        l0, l: length of the chord in the stress-free state and now.
        E: triad of the element (columns), shape (3, 3).
        T: tangents of the rotation charts of both nodes, shape (2, 3, 3).
        theta: rotation vectors θ of the nodes against the triad, shape (2, 3).
        factors: of each θ, c and ζ of coilset.model.core.rotations.kernels.inverse_chart_tangent, shape (2, 2).
        mean: t and p of the nodes' mean triad, shape (2, 3), see coilset.model.core.rod.kinematics.mean_triad.
        e: section strains ε, γ12, γ13, φ′, −w″, v″.
        s: section resultants N, Q2, Q3 in N and Mt, M2, M3 in N mm.
        predicted: section resultants that the geometric stiffness is built with, see coilset.model.core.rod.prediction.
        D: section tangent ∂s/∂e, shape (6, 6).

    All but the first three are coefficients in the mesh's quadrature or cell spaces.
    """

    def __init__(
        self,
        element: Element,
        mesh: dmesh.Mesh,
        V: fem.FunctionSpace,
        xi: Any,
        timoshenko_factor: Any,
        l0: Any,
        l: Any,
        E: Any,
        T: Any,
        theta: Any,
        factors: Any,
        mean: Any,
        e: Any,
        s: Any,
        predicted: Any,
        D: Any,
    ) -> None:
        self.element, self.V, self.xi, self.timoshenko_factor = element, V, xi, timoshenko_factor
        self.E, self.T, self.e, self.s, self.predicted, self.D = E, T, e, s, predicted, D
        self.state = State(l, theta, factors, mean)
        J = [ufl.Jacobian(mesh)[i, 0] for i in range(3)]
        self.length = self.state.l if element.small_rotations else l0  # to which twist and curvatures refer, too
        self.per_mesh = 1 / ufl.sqrt(dot(J, J))  # FFCx multiplies by the length in the mesh
        self.dx = ufl.dx(domain=mesh, metadata=at_sections(element))
        self.units = [Increment.unit(k, element) for k in range(LOCAL + element.own)]

    @property
    def residual(self) -> Any:
        """The internal nodal forces (4.4.1)."""
        return dot(self._local(ufl.TestFunction(self.V)), self._works(self.s)) * self.dx

    @property
    def tangent(self) -> Any:
        """Derivative of the residual, if the predicted resultants are the true ones, with the charts held.

        The charts' curvature is left out: it is proportional to the out-of-balance moments.
        """
        test, trial = self._local(ufl.TestFunction(self.V)), self._local(ufl.TrialFunction(self.V))
        return dot(test, [dot(row, trial) for row in zip(*self._stiffness_columns(), strict=True)]) * self.dx

    def _local(self, function: Any) -> Vector:
        """R q: in the triad, of displacements and rotation vectors of both nodes, and of the element's own unknowns."""
        u1, turn1, u2, turn2 = ([function[first + i] for i in range(3)] for first in (0, 3, 6, 9))
        spin1, spin2 = (
            [dot([self.T[a, i, j] for j in range(3)], turn) for i in range(3)] for a, turn in enumerate((turn1, turn2))
        )
        of_nodes = [
            dot([self.E[j, i] for j in range(3)], v) for v in (plus(u2, u1, -1), spin1, spin2) for i in range(3)
        ]
        return of_nodes + [function[12 + k] for k in range(self.element.own)]

    def _works(self, s: Any) -> Vector:
        """g: what section resultants do on the virtual strains of each local increment."""
        length = self.length * self.per_mesh
        return [dot([s[k] for k in range(STRAINS)], self.virtual_strains(unit)) * length for unit in self.units]

    def _stiffness_columns(self) -> Iterator[Vector]:
        """K: changes of g by the section resultants, by the state of the element, and as its triad turns."""
        g = self._works(self.predicted)
        slopes = [[ufl.diff(work, x) for x in self.state.variables] for work in g]
        for unit in self.units:
            strains, rates, spin = self.variation(unit), self._rates(unit), self._spin(unit)
            stressed = self._works([dot([self.D[k, m] for m in range(STRAINS)], strains) for k in range(STRAINS)])
            turned = [v for first in range(0, LOCAL, 3) for v in cross(spin, g[first : first + 3])]  # g · (−Ω × d), …
            turned += [0] * self.element.own
            yield [a + dot(slope, rates) + b for a, slope, b in zip(stressed, slopes, turned, strict=True)]

    def virtual_strains(self, increment: Increment) -> Vector:
        """δe: the variation of the strains, or in the thesis that for small rotations."""
        if not self.element.small_rotations:
            return self.variation(increment)
        frame = 0, *self._spin(increment)[1:]
        return self.strains(increment, *(plus(spin, frame, -1) for spin in increment.spins))

    def variation(self, increment: Increment) -> Vector:
        """Of the section strains by an increment: the derivative of `kinematics.section_strains`."""
        found = self.strains(increment, *self._relative(increment))
        if not self.element.small_rotations:
            return found
        angles = 0, 0, 0, *(self.e[k] for k in range(PER_LENGTH, STRAINS))  # fall as the chord grows
        return plus(found, angles, -increment.d[0] / self.state.l)

    def strains(self, increment: Increment, t1: Vector, t2: Vector) -> Vector:
        """ε, γ12, γ13, φ′, −w″, v″ from (5.2.4), with the nodes' rotations relative to the triad.

        The first two of the element's own unknowns are the shear angles in excess of those that its rotations produce
        in an elastic element, u = shear − c ½ (t1 + t2) with Timoshenko's c, `timoshenko_factor`
        (docs/theory/element.md says why). The chord's curve is H1 … H4 with the same bow b = u + ½ (t1 + t2) at both
        ends and ±(t2 − t1)/2 besides. The others are the modes of its strains, see coilset.model.core.rod.elements.
        """
        l, own = self.length, increment.own
        m13, m14 = (t1[1] + t2[1]) / 2, (t1[2] + t2[2]) / 2
        u13, u14 = own[0] - self.timoshenko_factor * m13, own[1] - self.timoshenko_factor * m14
        b13, b14 = u13 + m13, u14 + m14
        H = (12 * self.xi - 6) / l  # H2″ + H4″, times l
        e = [increment.d[0] / self.state.l, u14, -u13, *((b - a) / l for a, b in zip(t1, t2, strict=True))]
        e[4], e[5] = e[4] + H * b13, e[5] + H * b14
        for k, (strain, degree) in enumerate(self.element.modes):
            mode = legendre(degree, self.xi) * own[2 + k]
            e[strain] += mode / l if strain >= PER_LENGTH else mode
        return e

    def _relative(self, increment: Increment) -> tuple[Vector, Vector]:
        """Rates of both θ: by the nodes' spins relative to the triad's, θ̇ = P ω, P = 1 − ½ [θ] + c [θ]²."""
        triad, found = self._spin(increment), []
        for spin, theta, c in zip(increment.spins, self.state.theta, self.state.c, strict=True):
            relative = plus(spin, triad, -1)
            turned = cross(theta, relative)
            found.append(plus(plus(relative, turned, -0.5), cross(theta, turned), c))
        return found[0], found[1]

    def _spin(self, increment: Increment) -> Vector:
        """Of the element's triad, see coilset.model.core.rod.kinematics.mean_triad."""
        (t, p), d, (first, second), l = self.state.mean, increment.d, increment.spins, self.state.l
        w = 1, t[1] / (1 + t[0]), t[2] / (1 + t[0])
        nodes = plus(plus(first, second), cross(p, plus(second, first, -1)), -1)
        return (w[1] * d[2] - w[2] * d[1]) / l + dot(w, nodes) / 2, -d[2] / l, d[1] / l

    def _rates(self, increment: Increment) -> Vector:
        """Of the state's variables."""
        state, (t, p) = self.state, self.state.mean
        triad, theta = self._spin(increment), self._relative(increment)
        both, apart = plus(*increment.spins), plus(increment.spins[1], increment.spins[0], -1)
        both = plus(both, triad, -2)
        t_rate = cross(plus(both, cross(p, apart), -1), t)
        p_rate = plus(plus(cross(both, p), apart, (1 - dot(p, p)) / 2), p, dot(p, apart))
        mean = [x / 2 for x in (*t_rate, *p_rate)]
        c = [state.c_rate[a] * dot(state.theta[a], theta[a]) for a in range(2)]
        return [increment.d[0], *theta[0], *theta[1], *c, *mean]
