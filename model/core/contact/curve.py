"""The wire's centre line for contact: a smooth curve through the stations, and points along it.

With chords, a coil that slides over another would catch on their corners. Between the stations a and a + 1 the curve is
a Hermite cubic, c(ξ) = H1 x_a + H2 m_a + H3 x_a+1 + H4 m_a+1; the slope m of a station is that of the parabola
through it and its two neighbours. So every point is a fixed linear combination of four stations, the slope is
continuous, and a circle of 16 chords is approximated within 5e-4 of its radius, against 2e-2 for the chords.

The four weights are cubics in ξ. They are evaluated in two ways: `station_weight` one by one in compiled loops,
`curve_weights` for many points at once.
"""

from functools import cached_property
from typing import NamedTuple

import numpy as np

from coilset.model.core.runtime.kernels import njit

STENCIL = 4  # stations that a point depends on
POINTS_PER_ELEMENT = 2  # points of the bedding in an element: its station and its middle


@njit(cache=True)
def station_weight(a: np.ndarray, xi: float, order: int) -> float:
    """Weight of a station at ξ (order 0), or its derivative by ξ (1, 2); `a` are its coefficients, shape (4,)."""
    if order == 0:
        return a[0] + xi * (a[1] + xi * (a[2] + xi * a[3]))
    if order == 1:
        return a[1] + xi * (2.0 * a[2] + xi * 3.0 * a[3])
    return 2.0 * a[2] + 6.0 * a[3] * xi


@njit(cache=True)
def point_on_curve(
    y: np.ndarray, first: np.ndarray, cubic: np.ndarray, e: int, xi: float, c: np.ndarray, order: int
) -> None:
    """Write into `c` the curve's point and radius (order 0) or their derivatives by ξ (1, 2) on element `e`.

    Args:
        y: stations with their radii, shape (n, 4), mm.
        first, cubic: of the CentreLine.
        c: written, shape (4,), mm.
    """
    for k in range(4):
        c[k] = 0.0
    for m in range(min(4, len(y))):
        w = station_weight(cubic[e, m], xi, order)
        for k in range(4):
            c[k] += w * y[first[e] + m, k]


@njit(cache=True)
def element_polynomials(y: np.ndarray, first: np.ndarray, cubic: np.ndarray, elements: np.ndarray) -> np.ndarray:
    """Coefficients of 1, ξ, ξ², ξ³ of the curve's point and radius on elements.

    Args:
        y, first, cubic: as in `point_on_curve`.
        elements: ranges of those that are requested, shape (k, 2).

    Returns:
        Shape (n − 1, 4, 4), by element, power and component, mm; only those that are requested have a meaning.
    """
    out = np.empty((len(first), 4, 4))
    for part in range(len(elements)):
        for e in range(elements[part, 0], elements[part, 1]):
            for power in range(4):
                for k in range(4):
                    out[e, power, k] = 0.0
                    for m in range(min(STENCIL, len(y))):
                        out[e, power, k] += cubic[e, m, power] * y[first[e] + m, k]
    return out


@njit(cache=True)
def points_on_wire(active: np.ndarray, weights: np.ndarray, stations: np.ndarray, y: np.ndarray, p: np.ndarray) -> None:
    """Write the positions of some of the m points of the wire.

    Args:
        active: their numbers.
        weights, stations: of all points, shape (m, 4).
        y: as in `point_on_curve`.
        p: written at the active points, shape (m, 3), mm.
    """
    for i in active:
        for k in range(3):
            p[i, k] = 0.0
            for a in range(STENCIL):
                p[i, k] += weights[i, a] * y[stations[i, a], k]


def curve_weights(cubic: np.ndarray, xi: np.ndarray, order: int = 0) -> np.ndarray:
    """Weights of the four stations, or their derivatives by ξ.

    Args:
        cubic: coefficients of the points' elements, shape (m, 4, 4).
        xi: shape (m,).
        order: of the derivative, 0, 1 or 2.

    Returns:
        shape (m, 4).
    """
    one, none = xi**0, 0.0 * xi
    powers = {
        0: [one, xi, xi**2, xi**3],
        1: [none, one, 2.0 * xi, 3.0 * xi**2],
        2: [none, none, 2.0 * one, 6.0 * xi],
    }[order]
    return np.einsum("mkp,pm->mk", cubic, np.array(powers))


def slopes(turns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Weights of three stations for the slope by the turn at each station: parabolas, one-sided at the ends.

    Args:
        turns: increasing turns of the stations, shape (n,), n ≥ 2.

    Returns:
        First station and weights of its three (or two) stations, shapes (n,) and (n, 3).
    """
    n = len(turns)
    if n == 2:
        return np.zeros(2, np.int64), np.tile([-1.0, 1.0, 0.0] / np.diff(turns), (2, 1))
    first = np.clip(np.arange(n) - 1, 0, n - 3)
    t = turns[first[:, None] + np.arange(3)]
    at = turns[:, None]
    weights = np.empty((n, 3))
    for k in range(3):  # derivative of Lagrange's polynomials
        i, j = (m for m in range(3) if m != k)
        weights[:, k] = (2 * at[:, 0] - t[:, i] - t[:, j]) / ((t[:, k] - t[:, i]) * (t[:, k] - t[:, j]))
    return first, weights


class Curve(NamedTuple):
    """A centre line in compiled loops.

    Attributes:
        y: stations with their radii, shape (n, 4), mm.
        turns: of the stations, shape (n,).
        first, cubic: of the CentreLine.
    """

    y: np.ndarray
    turns: np.ndarray
    first: np.ndarray
    cubic: np.ndarray


class CentreLine:
    """Smooth curve through the stations.

    Args:
        turns: increasing turns of the stations, shape (n,).
        radius: wire radius at the stations, shape (n,), mm.
        lengths: of the elements along the wire, shape (n − 1,), mm.

    Attributes:
        first: first of the four stations of each element's cubic, shape (n − 1,).
        cubic: coefficients of 1, ξ, ξ², ξ³ of each station's weight, shape (n − 1, 4, 4).
        stations, dofs: the four stations and the degrees of freedom of their displacements, shapes (n − 1, 4) and
            (n − 1, 12); if the wire has fewer stations some occur twice, without weight.
    """

    def __init__(self, turns: np.ndarray, radius: np.ndarray, lengths: np.ndarray):
        self.turns, self.radius = np.asarray(turns, float), np.asarray(radius, float)
        self.lengths = np.asarray(lengths, float)
        n = len(self.turns)
        hermite = np.array([[1, 0, -3, 2], [0, 1, -2, 1], [0, 0, 3, -2], [0, 0, -1, 1]], dtype=float)
        first, weights = slopes(self.turns)
        a = np.arange(n - 1)
        self.first = np.clip(a - 1, 0, max(n - STENCIL, 0))
        self.cubic = np.zeros((n - 1, STENCIL, 4))
        self.stations = np.minimum(self.first[:, None] + np.arange(STENCIL), n - 1)
        self.dofs = (3 * self.stations[:, :, None] + np.arange(3)).reshape(n - 1, 3 * STENCIL)
        step = np.diff(self.turns)
        for end in range(2):
            self.cubic[a, a + end - self.first] += hermite[2 * end]
            for k in range(min(3, n)):
                column = first[a + end] + k - self.first
                self.cubic[a, column] += (step * weights[a + end, k])[:, None] * hermite[2 * end + 1]

    def amplification(self) -> float:
        """How much farther than the stations a point can move: a bound of Σ |weight|, from Bernstein's form."""
        to_bernstein = np.array([[1, 0, 0, 0], [1, 1 / 3, 0, 0], [1, 2 / 3, 1 / 3, 0], [1, 1, 1, 1]])
        return float(np.abs(self.cubic @ to_bernstein.T).sum(axis=1).max())

    def points(self) -> "WirePoints":
        """Points that bear the bedding, POINTS_PER_ELEMENT in an element and one at the wire's end.

        Returns:
            WirePoints; their lengths add up to that of the wire (trapezoidal rule).
        """
        n = len(self.lengths)
        parts = POINTS_PER_ELEMENT
        element = np.append(np.repeat(np.arange(n), parts), n - 1)
        xi = np.append(np.tile(np.arange(parts) / parts, n), 1.0)
        part = np.repeat(self.lengths, parts) / parts
        return WirePoints(self, element, xi, 0.5 * (np.append(part, 0.0) + np.append(0.0, part)))


class WirePoints:
    """Points of the centre line, each with a length of wire.

    Args:
        line: CentreLine.
        element, xi: where they are, shape (m,).
        length: of wire assigned to each, shape (m,), mm.

    Attributes:
        turns, radius: shape (m,), radius in mm.
        weights: of the element's four stations, shape (m, 4).
    """

    def __init__(self, line: CentreLine, element: np.ndarray, xi: np.ndarray, length: np.ndarray):
        self.line, self.element, self.xi, self.length = line, element, xi, length
        self.turns = line.turns[element] + xi * (line.turns[element + 1] - line.turns[element])
        self.weights = curve_weights(line.cubic[element], xi)
        self.stations = line.stations[element]
        self.radius = self.at(line.radius)

    def __len__(self) -> int:
        return len(self.xi)

    @cached_property
    def numbers(self) -> np.ndarray:
        """Of all points, shape (m,)."""
        return np.arange(len(self))

    @cached_property
    def share_of_turns(self) -> np.ndarray:
        """Turns of wire assigned to each point, shape (m,)."""
        half = 0.5 * np.diff(self.turns)
        return np.append(half, 0.0) + np.append(0.0, half)

    def of(self, elements: np.ndarray) -> np.ndarray:
        """Numbers of the points of ranges of elements, shape (k, 2), ascending; at the wire's end with its last one."""
        last, parts = len(self.line.lengths), POINTS_PER_ELEMENT
        return np.concatenate(
            [np.empty(0, np.int64), *(np.arange(parts * a, parts * b + (b == last)) for a, b in elements)]
        )

    def dofs(self, points: np.ndarray | slice = slice(None)) -> np.ndarray:
        """Degrees of freedom of the stations' displacements, of all points or of the `points`, shape (m, 12)."""
        return self.line.dofs[self.element[points]]

    def tip(self, end: str) -> int:
        """Number of the point at the wire's tip of an end, `bottom` or `top`."""
        return 0 if end == "bottom" else len(self) - 1

    def at(self, values: np.ndarray, points: np.ndarray | slice = slice(None)) -> np.ndarray:
        """Values of the stations, shape (n, …), at all points or at the `points`, shape (m, …)."""
        return np.einsum("mk,mk...->m...", self.weights[points], values[self.stations[points]])
