"""One section of a wire on its way from straight to coiled: the equilibrium that its points find, step by step."""

import math

import numpy as np

from coilset.model.core.base.errors import SolveError
from coilset.model.core.material.law.loop import AnyLaw
from coilset.model.core.material.point.loops import advance_points, with_loop
from coilset.model.core.section.integration import section
from coilset.model.core.section.rules import DiskRule, rim
from coilset.model.core.section.sections import BEND, TWIST
from coilset.model.core.section.shape import SHAPE, curved_shape, straight_shape

LOCAL = 25


class Wire:
    """One section, on its way.

    Args:
        law: of its points, with its loop or without.
        fibres: y, z, u, v and areas of its points, see `integration`.
        radius: of the wire, mm.
        curved: do the fibres get longer and shorter as the wire is bent, see `shape`?
        states: of the points, shape (points, n_state), or a virgin one of shape (1, n_state) for all.
        own_shape: g and the a of the points, if they are not those of a disk, see `shape`.
    """

    def __init__(
        self,
        law: AnyLaw,
        fibres: np.ndarray,
        radius: float,
        curved: bool,
        states: np.ndarray,
        own_shape: np.ndarray | None = None,
    ) -> None:
        self.law, self.radius, self.curved = with_loop(law, 3), radius, curved
        self.fibres, self.area = fibres, fibres[4]
        self.disk, self._own_shape = np.ascontiguousarray(fibres[:2] / radius), own_shape
        self.states = np.tile(states, (len(self.area) // len(states), 1))
        self.stretch = 1.0
        self.turned = np.zeros(2)  # θ and φ of a length of straight wire
        self.s, self.scale = np.zeros(6), np.array([1.0, 1.0, 1.0, radius, radius, radius])
        points = len(self.area)
        self._room = np.empty((3, points)), np.empty((9, points)), np.empty(points, np.int64)
        self._shape, self._tangent = np.empty((SHAPE, points)), np.empty((6, 6))

    @classmethod
    def of_disk(
        cls,
        law: AnyLaw,
        rule: DiskRule,
        radius: float,
        curved: bool,
        states: np.ndarray,
        surface: np.ndarray | None = None,
    ) -> "Wire":
        """A round one; other arguments as above.

        Args:
            rule: quadrature of the disk; its points are the first.
            surface: points without weight behind them, on the unit disk, shape (n, 2); None: those of the rim.
        """
        further = rim() if surface is None else surface
        y, z = radius * np.concatenate([rule.points, further]).T
        area = math.pi * radius**2 * np.concatenate([rule.weights, np.zeros(len(further))])
        return cls(law, np.array([y, z, y, z, area]), radius, curved, states)

    @property
    def curvature(self) -> np.ndarray:
        """Curvature and torsion of the axis, 1/mm."""
        return self.turned / self.stretch

    def evaluate(self, d: np.ndarray, bend: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Resultants, their tangent and the points' states after the section strains d, fibres as at a curvature."""
        if self._own_shape is not None:
            self._shape[:] = self._own_shape
        elif self.curved:
            curved_shape(*self.disk, bend * self.radius, self._shape)
        else:
            straight_shape(self._shape)
        new, s, (strain, C, count) = np.empty_like(self.states), np.empty(6), self._room
        if not section(
            self.law, self.fibres, self._shape, d, self.states, new, strain, C, True, count, s, self._tangent
        ):
            raise SolveError("the law found no solution")
        return s, self._tangent, new

    def step(self, d: np.ndarray, free: np.ndarray, wanted: np.ndarray, bend: float) -> np.ndarray:
        """Change the section strains by `d`; the `free` ones are sought that make their resultants `wanted`.

        Returns:
            The change, with the free ones as found: where the next of equal steps may begin.

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
        return d

    def grow(self, strain: np.ndarray) -> None:
        """Let the points' own length grow by axial strains, shape (points,), while the section's strains stay.

        Raises:
            SolveError: if the law finds no solution.
        """
        held, C, count = self._room
        held[:], new = 0.0, np.empty_like(self.states)
        held[0] = -strain
        if not advance_points(self.law, 3, self.states, held, new, C, False, count):
            raise SolveError("the law found no solution")
        self.states = new
