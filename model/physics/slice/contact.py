"""Contact of adjacent coils: a unilateral elastic bedding between the section's surface and that of the next coil."""

import numpy as np

from coilset.model.core.contact.base import one_sided
from coilset.model.physics.slice.boundary import Boundary
from coilset.model.physics.slice.forms import RISE, TURN
from coilset.model.physics.slice.gap import Gaps, Sides, gaps
from coilset.model.physics.slice.pressure import Pressure
from coilset.model.physics.slice.slice import Slice

STIFFNESS = 10.0  # of the bedding over E/d: as stiff as the triangles at the surface
ONSET = 1e-4  # distance over which contact sets in, in equivalent wire diameters
STEEP = 0.3  # minimum component of the normal along the coil's axis for an edge that may touch
GAUSS = 4  # contact points per edge


class SelfContact:
    """Contact of a slice with the coil above it, and thus of the coil below with the slice.

    Attributes:
        blocks: blocks of degrees of freedom that may touch.
        stiffness: pressure per penetration, N/mm³.
    """

    def __init__(self, body: Slice):
        diameter = body.section.equivalent_diameter
        self.body, self.onset = body, ONSET * diameter
        self.stiffness = STIFFNESS * body.law.E / diameter
        self._edges = edges = Boundary.of(body)
        self._above = np.flatnonzero(edges.upward > STEEP)
        self._below = np.flatnonzero(edges.upward < -STEEP)
        self.blocks = np.unique(edges.blocks[np.concatenate([self._above, self._below])])
        t, w = np.polynomial.legendre.leggauss(GAUSS)
        self._gauss = 0.5 * (t + 1.0)
        self._areas = self._points_areas(0.5 * w)
        at_corners = edges.corners(body.forms.V.tabulate_dof_coordinates()[:, :2])
        self._corners = [np.intersect1d(found, self._above) for found in at_corners]
        points, size = self._areas.size, 6 * edges.blocks.shape[1] + 1
        self._sides = Sides(edges.blocks, edges.polynomials, self._above, self._below)
        self._gaps = Gaps(
            np.empty(self._areas.shape),
            np.empty((points, 3), np.int64),
            np.empty((points, size)),
            np.empty((points, size, size)),
        )

    def _points_areas(self, weights: np.ndarray) -> np.ndarray:
        """Surface of the unloaded wire that each point represents, per radian, mm²."""
        t, powers = self._gauss[:, None], np.arange(len(self._edges.polynomials))
        values = t**powers @ self._edges.polynomials.T
        slopes = powers * t ** np.maximum(powers - 1, 0) @ self._edges.polynomials.T
        nodes = self.body.start[self._edges.blocks[self._above]]
        length = np.linalg.norm(np.einsum("ka,eai->eki", slopes, nodes), axis=2)
        radius = np.einsum("ka,eai->eki", values, nodes)[..., 0]
        return length * weights * np.hypot(radius, self.body.coil.rise)

    def _corner_gap(self, κ: float) -> float:
        """Smallest gap of the corners on the upper side, which no Gauss point covers, mm; infinite without corners."""
        smallest = np.inf
        for above, t in zip(self._corners, (1.0, 0.0), strict=True):
            if len(above):
                gap = np.empty((len(above), 1))
                sides, out = self._sides._replace(above=above), self._gaps._replace(gap=gap)
                gaps(self.body.x, κ, sides, np.array([t]), -np.inf, out)
                smallest = min(smallest, float(gap.min()))
        return smallest

    def evaluate(self) -> Pressure:
        """Forces and stiffness at the body's increment."""
        body, edges = self.body, self._edges
        h, λ, x = body.rise, body.turn, body.x
        found = self._gaps
        count = gaps(x, h / λ, self._sides, self._gauss, 0.0, found)
        a, k, b = found.where[:count].T
        gradient, hessian = found.gradient[:count], found.hessian[:count]
        pressure, slope = one_sided(found.gap[a, k], self.stiffness * self._areas[a, k], self.onset)
        load = -pressure[:, None] * gradient
        K = slope[:, None, None] * gradient[:, :, None] * gradient[:, None, :] - pressure[:, None, None] * hessian
        # κ = h̄/λ: its contribution goes to both numbers
        first = np.array([1.0 / λ, -h / λ**2])
        second = np.array([[0.0, -1.0 / λ**2], [-1.0 / λ**2, 2.0 * h / λ**3]])
        onto = np.zeros((gradient.shape[1], gradient.shape[1] + 1))
        onto[:-1, :-2], onto[-1, -2:] = np.eye(gradient.shape[1] - 1), first
        K = onto.T @ K @ onto
        K[:, -2:, -2:] += load[:, -1, None, None] * second
        pair = np.hstack([edges.blocks[self._above[a]], edges.blocks[self._below[b]]])
        dofs = (3 * pair[:, :, None] + np.arange(3)).reshape(count, 6 * edges.blocks.shape[1])
        dofs = np.hstack([dofs, np.tile(x.size + np.array([RISE, TURN]), (count, 1))])
        forces = np.bincount(dofs.ravel(), (load @ onto).ravel(), x.size + 2)
        i, j = np.broadcast_arrays(dofs[:, :, None], dofs[:, None, :])
        free = float(found.gap.min())
        return Pressure(
            min(free, self._corner_gap(h / λ)),
            free,
            int(np.count_nonzero(pressure > 0)),
            2 * np.pi * float(pressure.sum()),
            forces[:-2].reshape(-1, 3),
            forces[-2:],
            i.ravel(),
            j.ravel(),
            K.ravel(),
        )
