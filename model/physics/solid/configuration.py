"""The moving mesh: current positions as coefficients of the displacement space, and its rigid modes."""

import basix.ufl
import numpy as np
import scipy.sparse
from dolfinx import fem
from dolfinx import mesh as dmesh

from coilset.model.core.base.compat import geometry_dofs

# The elements: 20-node hexahedra with 2 x 2 x 2 points, which neither lock in plastic flow nor have zero-energy modes
# in any patch of 2 x 2 x 2 elements or more.
FAMILY, QUADRATURE_DEGREE = "S", 3


class Configuration:
    """Position of the body, a function of the displacement space, and the DOLFINx mesh that follows it.

    Positions belong to the displacement space itself (the element is isoparametric), so that every rigid motion is in
    the space. A hexahedron's face and interior nodes follow from its edges; the initial mesh is built accordingly.

    Attributes:
        mesh: the mesh that moves.
        V: vector displacement space of second order.
        x: coefficients of the position at the last equilibrium, shape (blocks with ghosts, 3), mm.
        start: positions of the geometry's nodes at the start, shape (nodes, 3), mm.
    """

    def __init__(self, mesh: dmesh.Mesh) -> None:
        self.mesh = mesh
        self.V = fem.functionspace(mesh, basix.ufl.element(FAMILY, "hexahedron", 2, shape=(3,)))
        self._nodes = _node_matrix(mesh, self.V)
        position = fem.Function(self.V)
        position.interpolate(lambda x: x)
        self.x = position.x.array.reshape(-1, 3).copy()
        self.move(self.x)
        self.start = mesh.geometry.x.copy()

    @property
    def owned(self) -> int:
        """Number of blocks of three degrees of freedom that this rank owns; they come first."""
        return self.V.dofmap.index_map.size_local

    def move(self, x: np.ndarray) -> None:
        """Move the mesh to the position coefficients x, shape (blocks with ghosts, 3), mm."""
        self.mesh.geometry.x[:] = self._nodes @ x

    def rigid_modes(self, x: np.ndarray) -> np.ndarray:
        """Coefficients of the unit translations along, and the rotations about, the axes through the origin.

        Degrees of freedom are linear in the function, so those of e × x are e × those of x.

        Args:
            x: position coefficients, shape (blocks, 3), mm.

        Returns:
            Shape (6, blocks, 3); the rotations are in mm.
        """
        modes = np.zeros((6, *x.shape))
        for i, e in enumerate(np.eye(3)):
            modes[i] = e
            modes[3 + i] = np.cross(e, x)
        return modes


def _node_matrix(mesh: dmesh.Mesh, V: fem.FunctionSpace) -> scipy.sparse.csr_matrix:
    """Matrix from position coefficients to geometry nodes, shape (nodes, blocks): row i evaluates node i."""
    nodes, dofs = geometry_dofs(mesh), V.dofmap.list
    points = mesh.ufl_domain().ufl_coordinate_element().basix_element.points
    shape = V.element.basix_element.tabulate(0, points)[0, :, :, 0]  # (nodes of a cell, blocks of a cell)
    shape[np.abs(shape) < 1e-14] = 0.0
    node, first = np.unique(nodes, return_index=True)
    cell, local = np.unravel_index(first, nodes.shape)
    columns = dofs[cell]
    rows = np.repeat(node, columns.shape[1])
    n_blocks = V.dofmap.index_map.size_local + V.dofmap.index_map.num_ghosts
    matrix = scipy.sparse.csr_matrix(
        (shape[local].ravel(), (rows, columns.ravel())), shape=(len(mesh.geometry.x), n_blocks)
    )
    matrix.eliminate_zeros()
    return matrix
