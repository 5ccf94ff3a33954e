"""The wire's past: straight wire is bent and twisted beyond yield, and springs back to the shape of its spring.

A wire free of stress is brought along a straight path to the rotations θ (bend) and φ (twist) of a length of it, while
N, Q2, Q3 and M2 stay zero; then the moments are taken away. With the stretch λ of the axis, its curvature is θ/λ, and
its torsion φ/λ. θ and φ are sought for which both are those of the spring when all resultants are zero. Strains of the
fibres are logarithmic in the limit of many increments, since each increment divides by the length 1 − κ y of the fibre
half way through it.

What coiling machines do besides is left out: no temperature, no tension in the wire, no stress from drawing, and no
second bend where a pitch tool or another pin touches.
"""

import math
from dataclasses import dataclass

import numpy as np

from coilset.meshes.errors import SolveError
from coilset.model.section.integration import section
from coilset.model.section.rules import DiskRule, rim
from coilset.model.section.shape import SHAPE, curved_shape, straight_shape

LOADING, RELEASE = 40, 4  # increments
FREE = np.array([0, 1, 2, 4])  # ε, γ12, γ13, κ2 follow while the wire is bent and twisted
TWIST, BEND = 3, 5  # φ′ and κ3
CLOSE = 1e-10  # of the spring's curvature
ATTEMPTS, LOCAL = 30, 25


@dataclass(frozen=True)
class Coiled:
    """Sections of a wire that was coiled and sprang back.

    Attributes:
        points: states of the rule's points, shape (points, n_state), MPa; surface: of the points on the surface.
        curvature, torsion: of the axis before it sprang back, 1/mm.
        moments: M3 and Mt there, N mm.
        turned: θ and φ there, 1/mm.
    """

    points: np.ndarray
    surface: np.ndarray
    curvature: float
    torsion: float
    moments: tuple[float, float]
    turned: tuple[float, float]


class _Wire:
    """One section, on its way.

    Args:
        law: parameters of the material law.
        rule: quadrature of the disk.
        radius: of the wire, mm.
        curved: do the fibres get longer and shorter as the wire is bent, see `shape`?
        row: state of a virgin point, shape (1, n_state).
    """

    def __init__(self, law: np.ndarray, rule: DiskRule, radius: float, curved: bool, row: np.ndarray) -> None:
        self.law, self.curved, self.radius = law, curved, radius
        self.disk = np.ascontiguousarray(np.concatenate([rule.points, rim()]).T)
        self.y, self.z = radius * self.disk
        self.area = math.pi * radius**2 * np.concatenate([rule.weights, np.zeros(len(rim()))])
        self.states = np.tile(row, (len(self.area), 1))
        self.stretch = 1.0
        self.turned = np.zeros(2)  # θ and φ of a length of straight wire
        self.s, self.scale = np.zeros(6), np.array([1.0, 1.0, 1.0, radius, radius, radius])
        points = len(self.area)
        self._room = np.empty((3, points)), np.empty((9, points)), np.empty(points, np.int64)
        self._shape, self._tangent = np.empty((SHAPE, points)), np.empty((6, 6))

    @property
    def curvature(self) -> np.ndarray:
        """Curvature and torsion of the axis, 1/mm."""
        return self.turned / self.stretch

    def evaluate(self, d: np.ndarray, bend: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Resultants, their tangent and the points' states after the section strains d, fibres as at a curvature."""
        straight_shape(self._shape)
        if self.curved:
            curved_shape(*self.disk, bend * self.radius, self._shape)
        new, s, (strain, C, count) = np.empty_like(self.states), np.empty(6), self._room
        if not section(self.law, self.y, self.z, self.area, self._shape, d, self.states, new, strain, C, True, count, s,
                       self._tangent):  # fmt: skip
            raise SolveError("the law found no solution")
        return s, self._tangent, new

    def step(self, d: np.ndarray, free: np.ndarray, wanted: np.ndarray, bend: float) -> None:
        """Change the section strains by `d`; the `free` ones are sought that make their resultants `wanted`.

        Raises:
            SolveError: if there are none.
        """
        for _ in range(LOCAL):
            s, D, new = self.evaluate(d, bend)
            rest = (wanted - s)[free] / self.scale[free]
            if np.abs(rest).max() <= 1e-11 * (np.abs(s / self.scale).max() + self.area.sum()):
                break
            d = d.copy()
            d[free] += np.linalg.solve(D[np.ix_(free, free)], (wanted - s)[free])
        else:
            raise SolveError("the section finds no equilibrium")
        self.turned += self.stretch * d[[BEND, TWIST]]
        self.stretch *= math.exp(d[0]) if self.curved else 1.0
        self.states, self.s = new, s


def coil(
    law: np.ndarray,
    rule: DiskRule,
    radius: float,
    curvature: float,
    torsion: float,
    row: np.ndarray,
    curved: bool = True,
    guess: tuple[float, float] | None = None,
) -> Coiled:
    """The wire of a spring after coiling.

    Args:
        law: parameters of the material law, `Law.parameters()`.
        rule: quadrature of the disk.
        radius: of the wire, mm.
        curvature, torsion: of the spring's axis, 1/mm.
        row: state of a virgin point, shape (1, n_state).
        curved: logarithmic strains of fibres; else ε = −κ y.
        guess: θ and φ to begin with, 1/mm.

    Raises:
        SolveError: if no coiling ends at this shape, as of a wire that does not yield.
    """
    wanted = np.array([curvature, torsion])
    turned = np.array(guess if guess else 1.1 * wanted)
    before: tuple[np.ndarray, np.ndarray] | None = None
    slope = np.eye(2)
    for _ in range(ATTEMPTS):
        wire, tight, moments = _coiled(law, rule, radius, turned, row, curved, wanted[0])
        off = wire.curvature - wanted
        if np.abs(off).max() <= CLOSE * curvature:
            inside = len(rule.weights)
            return Coiled(wire.states[:inside], wire.states[inside:], *tight, moments, (turned[0], turned[1]))
        if before is not None:  # Broyden's update of the slope
            way = turned - before[0]
            slope += np.outer(off - before[1] - slope @ way, way) / (way @ way)
        before = turned, off
        turned = turned - np.linalg.solve(slope, off)
        if not np.abs(turned).max() < 1.0 / radius:
            break
    raise SolveError("it springs back to another shape, however it is bent")


def _coiled(
    law: np.ndarray, rule: DiskRule, radius: float, turned: np.ndarray, row: np.ndarray, curved: bool, end: float
) -> tuple[_Wire, tuple[float, float], tuple[float, float]]:
    """The wire after it was turned by θ and φ a length and let go; curvature and torsion, M3 and Mt before that."""
    wire, d = _Wire(law, rule, radius, curved, row), np.zeros(6)
    for _ in range(LOADING):
        d[[BEND, TWIST]] = turned / LOADING / wire.stretch
        wire.step(d, FREE, np.zeros(6), wire.curvature[0] + 0.5 * d[BEND])
    tight, moments = (float(wire.curvature[0]), float(wire.curvature[1])), (float(wire.s[BEND]), float(wire.s[TWIST]))
    loaded = wire.s.copy()
    for k in range(1, RELEASE + 1):
        bend = end if k == RELEASE else wire.curvature[0]  # it ends in balance as a section of the spring
        wire.step(np.zeros(6), np.arange(6), loaded * (1.0 - k / RELEASE), bend)
    return wire, tight, moments
