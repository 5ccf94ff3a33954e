"""The height at which a spring is solid, from its geometry: coils that lie on each other, pass each other, or stack.

Two wires of diameters d₁, d₂ that one meridian cuts at radii r₁, r₂ touch where the upper one stands
s = √(d² − (r₂ − r₁)²) above the lower one, d = ½ (d₁ + d₂); where |r₂ − r₁| ≥ d they pass each other. Of wire that is
not round, s is the height of the difference of its section with itself (`Boundary.touching`). The block height is the
greater of two:

- **each coil on the next**: from the turn t to t + 1 the wire rises by s(t). A pitch p with ∫ p = s over each turn is
  s(t − ½) at t, to second order; over the first and the last half turn it is constant. So n turns rise by
  ∫ s dt + ½ (s(0) + s(n − 1)). The ends contribute what the wire and its grinding contribute to the free length.
- **the highest stack**: on each meridian the wires stand above each other between the seats, each at least s above
  every one below it, its neighbour or not. No spring whose coils keep their radii goes below the highest of these
  stacks. It is the greater of the two where coils of both flanks of a double cone or a barrel, which pass their
  neighbours, come to rest on each other.
"""

from typing import Any, Protocol

import numpy as np

from coilset.meshes.springs import functions
from coilset.meshes.springs.ends import touching_pitch
from coilset.meshes.springs.piecewise import PiecewisePolynomial

MERIDIANS = 64
TOUCH = 0.01  # tolerance over the wire diameter: tables and the pitch of closed ends make touching inexact


class Coil(Protocol):
    """The properties of a spring that determine where it is solid; see `coilset.meshes.springs.geometry.Spring`."""

    @property
    def section(self) -> Any:
        """Boundary of wire that is not round; None of round wire."""

    @property
    def turns(self) -> float:
        """Number of turns."""

    @property
    def breaks(self) -> np.ndarray:
        """Turns between which its functions are single polynomials."""

    @property
    def body_length(self) -> float:
        """Distance between two planes that touch it, mm."""

    @property
    def height(self) -> PiecewisePolynomial:
        """Of the centre line over the turn, mm."""

    def mean_radius(self, turn: np.ndarray | float) -> np.ndarray:
        """Of the centre line, mm."""

    def wire_diameter(self, turn: np.ndarray | float) -> np.ndarray:
        """Or height of the wire, mm."""

    def aside(self, low: np.ndarray | float, up: np.ndarray | float) -> np.ndarray:
        """By how much the coil at turns `up` is farther from the axis than that at `low`, mm."""

    def seat_distance(self, turn: np.ndarray | float, end: str) -> np.ndarray:
        """From the centre line to the surface that faces the `bottom` or `top` seat, mm."""


def block_height(spring: Coil) -> float:
    """Distance between the seats at which a spring is solid, mm."""
    return max(_each_on_the_next(spring), _highest_stack(spring))


def _each_on_the_next(spring: Coil) -> float:
    ends = spring.body_length - (spring.height(spring.turns) - spring.height(0.0))
    n = spring.turns
    if n <= 1.0:  # no coil has a next one; the pitch of a coil that goes on
        mean = 0.5 * (spring.wire_diameter(0.0) + spring.wire_diameter(n))
        return float(
            n * touching_pitch(mean, (spring.mean_radius(n) - spring.mean_radius(0.0)) / n, spring.section) + ends
        )

    def rise(turn: np.ndarray | float) -> np.ndarray:
        """From each turn t ≤ n − 1 to the next where the two touch, mm."""
        t = np.asarray(turn, dtype=float)
        wire = 0.5 * (spring.wire_diameter(t) + spring.wire_diameter(t + 1.0))
        return touching_pitch(wire, spring.aside(t, t + 1.0), spring.section)

    marks = np.unique(np.concatenate([spring.breaks, spring.breaks - 1.0]))  # of r and d at t, and at t + 1
    inside = marks[(marks > 0.0) & (marks < n - 1.0)]
    within = functions.integral(rise, np.concatenate([[0.0], inside, [n - 1.0]])).sum()
    return float(within + 0.5 * (rise(0.0) + rise(n - 1.0)) + ends)


def _highest_stack(spring: Coil) -> float:
    """Greatest height of the wires that lie above each other on any meridian, mm."""
    meridians = np.append(np.arange(MERIDIANS) / MERIDIANS, spring.turns % 1.0)  # the last one: of the top tip
    t = np.arange(int(spring.turns) + 1)[:, None] + meridians
    there = t <= spring.turns
    t = np.minimum(t, spring.turns)
    d = spring.wire_diameter(t)
    level = spring.seat_distance(t, "bottom")
    for i in range(1, len(t)):
        rise = touching_pitch(0.5 * (d[:i] + d[i]), spring.aside(t[:i], t[i]), spring.section)
        resting = np.where(rise > 0.0, level[:i] + rise, -np.inf)
        level[i] = np.maximum(level[i], resting.max(axis=0))
    return float(np.where(there, level + spring.seat_distance(t, "top"), 0.0).max())
