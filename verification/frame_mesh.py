"""Line meshes of frames: rods between any pairs of nodes, branches included."""

import basix.ufl
import numpy as np
import ufl
from dolfinx import mesh as dmesh
from mpi4py import MPI

from coilset.meshes.line import LineMesh
from coilset.model.core.base.errors import InputError


def frame_mesh(nodes: np.ndarray, pairs: np.ndarray, comm: MPI.Comm) -> LineMesh:
    """A LineMesh whose stations are `nodes` and whose elements are `pairs`.

    Args:
        nodes: positions, shape (n, 3), mm.
        pairs: node numbers of the elements' ends, shape (m, 2).
        comm: MPI communicator of one rank: DOLFINx splits no line meshes with branches over ranks.

    Raises:
        InputError: for more than one rank, an unknown node, a node without an element, or an element without length.
    """
    nodes, pairs = np.ascontiguousarray(nodes, dtype=float), np.ascontiguousarray(pairs, dtype=np.int64)
    if comm.size > 1:
        raise InputError(f"frames run on one rank, not on {comm.size}", "-n")
    if pairs.min() < 0 or not np.array_equal(np.unique(pairs), np.arange(len(nodes))):
        raise InputError(f"elements must join all nodes from 0 to {len(nodes) - 1} and no others", "pairs")
    if np.any(np.linalg.norm(nodes[pairs[:, 1]] - nodes[pairs[:, 0]], axis=1) == 0.0):
        raise InputError("an element has no length", "pairs")
    domain = ufl.Mesh(basix.ufl.element("Lagrange", "interval", 1, shape=(3,)))
    mesh = dmesh.create_mesh(comm, pairs, x=nodes, e=domain)  # by name: 0.10 changed the order of the arguments
    node = np.asarray(mesh.geometry.input_global_indices, dtype=np.int64)
    element = np.asarray(mesh.topology.original_cell_index, dtype=np.int64)
    return LineMesh(mesh, nodes, node, element, len(pairs), comm)
