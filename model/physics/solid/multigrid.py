"""Multigrid for the solid: quadratic elements, the same elements with vertices only, then smoothed aggregation.

Smoothed aggregation directly on the quadratic basis needs more iterations, with aggregates too small for six rigid
modes. The vertex space is nested in the quadratic one: a function that is linear along the edges has, on each edge, a
mean of half the sum of its values at the ends of the edge.
"""

import basix
import numpy as np
from dolfinx import fem, la
from petsc4py import PETSc

from coilset.model.physics.solid.configuration import Configuration


class VertexMultigrid:
    """Two levels of PCMG; the coarse one is solved by one cycle of GAMG with the rigid modes of the vertices.

    Args:
        held: blocks with prescribed displacement; the coarse space vanishes there, so that the heads are not corrected.
        pc: PETSc PC to set up; its further options come from the options database.
    """

    def __init__(self, configuration: Configuration, held: np.ndarray, pc: PETSc.PC) -> None:
        self.configuration, self.pc = configuration, pc
        number, self._mine = _number_vertices(configuration.V, held)
        self.P = _prolongation(configuration.V, held, number, len(self._mine))
        self.coarse: PETSc.Mat = None
        pc.setType("mg")
        pc.setMGLevels(2)
        pc.setMGInterpolation(1, self.P)

    def update(self, A: PETSc.Mat, x: np.ndarray) -> None:
        """Form the coarse operator of the tangent A at the position coefficients x.

        The rigid modes are those at the vertices, whose coefficients are values.
        """
        first = self.coarse is None
        self.coarse = A.ptap(self.P, result=self.coarse)
        if first:
            self.coarse.setBlockSize(3)
            self.pc.getMGCoarseSolve().setOperators(self.coarse)
            self.pc.getMGSmoother(1).setOperators(A)
        self.coarse.setNearNullSpace(self._near_nullspace(x[self._mine]))

    def _near_nullspace(self, x: np.ndarray) -> PETSc.NullSpace:
        """Orthonormal basis of the six rigid modes at the coarse vertices."""
        comm = self.configuration.mesh.comm
        centre = comm.allreduce(x.sum(axis=0)) / comm.allreduce(len(x))
        modes = self.configuration.rigid_modes(x - centre).reshape(6, -1)
        basis = np.linalg.solve(np.linalg.cholesky(comm.allreduce(modes @ modes.T)), modes)
        vectors = [PETSc.Vec().createWithArray(b.copy(), bsize=3, comm=comm) for b in basis]
        return PETSc.NullSpace().create(vectors=vectors, comm=comm)


def any_free_vertex(V: fem.FunctionSpace, held: np.ndarray) -> bool:
    """Whether any rank has a vertex that is not held; collective.

    Args:
        V: function space of quadratic elements.
        held: blocks with prescribed displacement.
    """
    _number, mine = _number_vertices(V, held)
    return bool(V.mesh.comm.allreduce(len(mine)))


def _number_vertices(V: fem.FunctionSpace, held: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Global numbers of the vertices that are not held, -1 for other blocks, and those owned by this rank."""
    index_map, comm = V.dofmap.index_map, V.mesh.comm
    n = index_map.size_local
    n_vertices = len(basix.topology(V.mesh.basix_cell())[0])
    vertex = np.zeros(n + index_map.num_ghosts, dtype=bool)
    vertex[V.dofmap.list[:, :n_vertices]] = True
    vertex[held] = False
    # whether a block at the edge of this rank's part is a vertex may be known only from another rank's cells
    marks = la.vector(index_map, 1, dtype=np.int64)
    marks.array[:] = vertex
    marks.scatter_reverse(la.InsertMode.add)
    mine = np.flatnonzero(marks.array[:n])
    numbers = la.vector(index_map, 1, dtype=np.int64)
    numbers.array[:] = -1
    numbers.array[mine] = (comm.exscan(len(mine)) or 0) + np.arange(len(mine))
    numbers.scatter_forward()
    return numbers.array, mine


def _prolongation(V: fem.FunctionSpace, held: np.ndarray, number: np.ndarray, n_mine: int) -> PETSc.Mat:
    """Matrix from vertex displacements to all degrees of freedom."""
    index_map, cells = V.dofmap.index_map, V.dofmap.list
    topology = basix.topology(V.mesh.basix_cell())
    n, n_vertices, edges = index_map.size_local, len(topology[0]), topology[1]
    ends = np.full((len(number), 2), -1)
    ends[cells[:, :n_vertices], 0] = number[cells[:, :n_vertices]]
    for edge, (a, b) in enumerate(edges):
        block = cells[:, n_vertices + edge]
        ends[block, 0], ends[block, 1] = number[cells[:, a]], number[cells[:, b]]
    is_edge = np.zeros(len(number), dtype=bool)
    is_edge[cells[:, n_vertices:]] = True
    ends[held] = -1
    P = PETSc.Mat().createAIJ(((3 * n, None), (3 * n_mine, None)), nnz=(2, 2), bsize=3, comm=V.mesh.comm)
    for side in range(2):
        blocks = np.flatnonzero(ends[:n, side] >= 0)
        values = np.where(is_edge[blocks], 0.5, 1.0)
        for k in range(3):
            rows = 3 * (index_map.local_range[0] + blocks) + k
            columns = 3 * ends[blocks, side] + k
            P.setValuesRCV(*(a.astype(PETSc.IntType)[:, None] for a in (rows, columns)), values[:, None])
    P.assemble()
    return P
