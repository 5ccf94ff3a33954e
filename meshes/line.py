"""The line mesh of a rod: straight elements through given stations, distributed by DOLFINx."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import basix.ufl
import numpy as np
from dolfinx import mesh as dmesh
from mpi4py import MPI

from coilset.model.core.base.compat import geometry_dofs, to_ranks


@dataclass
class LineMesh:
    """A distributed line mesh with the mapping back to the order of its stations, whatever the partition.

    Attributes:
        mesh: DOLFINx mesh of two-node intervals in space, mm.
        stations: all stations in their order, shape (n + 1, 3), mm; the same on every rank.
        node: station number of each local node, ghosts included, shape (local nodes,).
        element: element number (from station i to i + 1) of each local cell, ghosts included.
        owned_cells: number of cells that this rank owns; they come first.
        comm: MPI communicator, of which the mesh has a duplicate of its own.
    """

    mesh: dmesh.Mesh
    stations: np.ndarray
    node: np.ndarray
    element: np.ndarray
    owned_cells: int
    comm: MPI.Comm

    def in_order(self, values: np.ndarray) -> np.ndarray:
        """A copy of the owned cells' values in the order of the elements on rank 0, empty elsewhere; collective.

        Args:
            values: shape (owned cells, ...).
        """
        comm, element = self.comm, self.element[: self.owned_cells]
        if comm.size == 1:
            ordered = np.empty_like(values)
            ordered[element] = values
            return ordered
        parts = comm.gather((element, values))
        if comm.rank or parts is None:
            return values[:0].copy()
        order = np.argsort(np.concatenate([part[0] for part in parts]))
        return np.concatenate([part[1] for part in parts])[order]


def _pieces(elements: int) -> Callable[..., object]:
    """Partitioner that cuts the wire into contiguous pieces of equally many elements, the first for the first rank."""

    def partition(comm: MPI.Comm, ranks: int, kinds: Sequence[object], nodes: Sequence[np.ndarray]) -> object:
        element = nodes[0].reshape(-1, 2).min(axis=1)
        return to_ranks(element * ranks // elements)

    return partition


def line_mesh(stations: np.ndarray, comm: MPI.Comm) -> LineMesh:
    """Distribute the polygon through the stations over the ranks of `comm`.

    No mesh generator is needed: DOLFINx takes the stations and the pairs of neighbours as they are.

    Args:
        stations: shape (n + 1, 3), mm; the same on every rank.
        comm: MPI communicator.

    Returns:
        LineMesh.
    """
    stations = np.ascontiguousarray(stations, dtype=float)
    first = np.arange(len(stations) - 1 if comm.rank == 0 else 0, dtype=np.int64)
    nodes = stations if comm.rank == 0 else stations[:0]
    element = basix.ufl.element("Lagrange", "interval", 1, shape=(3,))
    mesh = dmesh.create_mesh(
        comm=comm,
        cells=np.stack([first, first + 1], axis=1),
        x=nodes,
        e=element,
        partitioner=_pieces(len(stations) - 1),
    )
    node = np.asarray(mesh.geometry.input_global_indices, dtype=np.int64)
    elements = node[geometry_dofs(mesh)].min(axis=1)
    return LineMesh(mesh, stations, node, elements, mesh.topology.index_map(1).size_local, comm)
