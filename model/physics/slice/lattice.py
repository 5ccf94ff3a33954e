"""Points all over the section, for pictures, files and the maximum stress: a lattice in each triangle of the mesh."""

import basix
import numpy as np

from coilset.model.core.base.compat import geometry_dofs
from coilset.model.physics.slice.slice import Slice

DIVISIONS = 4  # per side of a triangle of the mesh


class Lattice:
    """A refined triangulation of a slice's section; points on shared sides occur once for each triangle.

    Attributes:
        places: ξ, η, shape (n, 2), mm.
        triangles: three points each, shape (m, 3).
        surface: indices of the points on the surface; rim: the same by triangle sides, shape (sides, points).
    """

    def __init__(self, body: Slice):
        mesh, V = body.section.mesh, body.forms.V
        local = basix.create_lattice(basix.CellType.triangle, DIVISIONS, basix.LatticeType.equispaced, True)
        element = mesh.ufl_domain().ufl_coordinate_element().basix_element
        nodes = mesh.geometry.x[geometry_dofs(mesh)][:, :, :2]
        self.places = np.einsum("qb,cbi->cqi", element.tabulate(0, local)[0, :, :, 0], nodes).reshape(-1, 2)
        self._shape, self._dofs = V.element.basix_element.tabulate(0, local)[0, :, :, 0], V.dofmap.list
        first = len(local) * np.arange(len(nodes))  # point of each cell
        self.triangles = (_small_triangles() + first[:, None, None]).reshape(-1, 3)
        sides = [np.flatnonzero(np.isclose(value, 0.0)) for value in (1.0 - local.sum(axis=1), *local.T)]
        self.rim = np.array([cell * len(local) + sides[side] for cell, side in body.section.sides()])
        self.surface = np.unique(self.rim)

    def positions(self, x: np.ndarray) -> np.ndarray:
        """Positions of the points in space from coefficients of the position, shape (blocks, 3) → (n, 3), mm."""
        return np.einsum("qb,cbi->cqi", self._shape, x[self._dofs]).reshape(-1, 3)


def _small_triangles() -> np.ndarray:
    """The triangles of a cell's lattice, whose points are ordered by rows."""
    n = DIVISIONS
    first = np.cumsum([0] + [n + 1 - j for j in range(n)])  # index of the first point of each row
    up = [(first[j] + i, first[j] + i + 1, first[j + 1] + i) for j in range(n) for i in range(n - j)]
    down = [(first[j] + i + 1, first[j + 1] + i + 1, first[j + 1] + i) for j in range(n) for i in range(n - j - 1)]
    return np.array(up + down)
