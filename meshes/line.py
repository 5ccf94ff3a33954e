"""The line mesh of a rod: a gmsh model of straight elements through given stations, distributed by DOLFINx."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import gmsh
import numpy as np
from dolfinx import mesh as dmesh
from mpi4py import MPI

from coilset.meshes.compat import geometry_dofs, mesh_from_gmsh, to_ranks


@dataclass
class LineMesh:
    """A distributed line mesh and the way back to the order of its stations, which no partition changes.

    Attributes:
        mesh: DOLFINx mesh of two-node intervals in space, mm.
        stations: all stations in their order, shape (n + 1, 3), mm; the same on every rank.
        node: station number of each local node, ghosts included, shape (local nodes,).
        element: element number (from station i to i + 1) of each local cell, ghosts included.
        owned_cells: number of cells that this rank owns; they come first.
    """

    mesh: dmesh.Mesh
    stations: np.ndarray
    node: np.ndarray
    element: np.ndarray
    owned_cells: int

    def in_order(self, values: np.ndarray) -> np.ndarray:
        """A copy of the owned cells' values in the order of the elements, on rank 0; elsewhere none; collective.

        Args:
            values: shape (owned cells, ...).
        """
        comm, element = self.mesh.comm, self.element[: self.owned_cells]
        if comm.size == 1:
            ordered = np.empty_like(values)
            ordered[element] = values
            return ordered
        parts = comm.gather((element, values))
        if comm.rank or parts is None:
            return values[:0].copy()
        order = np.argsort(np.concatenate([part[0] for part in parts]))
        return np.concatenate([part[1] for part in parts])[order]


def gmsh_line(stations: np.ndarray, groups: Mapping[str, int] | None = None, name: str = "wire") -> None:
    """Put the polygon through the stations into the current gmsh model; the caller initialises and finalises gmsh.

    Args:
        stations: node positions in their order along the wire, shape (n + 1, 3), mm.
        groups: name → station number of the points that get a physical group; default: both ends.
        name: physical group of the line.

    The nodes lie exactly where they are given (a discrete entity), not where a mesher would put them.
    """
    gmsh.model.add("coilset line")
    groups = {"bottom end": 0, "top end": len(stations) - 1} if groups is None else groups
    line = gmsh.model.addDiscreteEntity(1)
    tags = np.arange(1, len(stations) + 1)
    gmsh.model.mesh.addNodes(1, line, tags, np.asarray(stations, float).ravel())
    pairs = np.stack([tags[:-1], tags[1:]], axis=1)
    gmsh.model.mesh.addElementsByType(line, 1, tags[:-1], pairs.ravel())
    gmsh.model.addPhysicalGroup(1, [line], name=name)
    for number, (group, station) in enumerate(groups.items()):
        point = gmsh.model.addDiscreteEntity(0)
        gmsh.model.mesh.addElementsByType(point, 15, [len(stations) + number], [int(tags[station])])
        gmsh.model.addPhysicalGroup(0, [point], name=group)


def _pieces(elements: int) -> Callable[..., object]:
    """Partitioner that cuts the wire in contiguous pieces of as many elements each, the first for the first rank."""

    def partition(comm: MPI.Comm, ranks: int, kinds: Sequence[object], nodes: Sequence[np.ndarray]) -> object:
        element = nodes[0].reshape(-1, 2).min(axis=1)
        return to_ranks(element * ranks // elements)

    return partition


def line_mesh(stations: np.ndarray, comm: MPI.Comm) -> LineMesh:
    """Mesh the polygon through the stations with gmsh and distribute it over the ranks of `comm`.

    Args:
        stations: shape (n + 1, 3), mm; the same on every rank.
        comm: MPI communicator.

    Returns:
        LineMesh.
    """
    stations = np.ascontiguousarray(stations, dtype=float)
    gmsh.initialize(["coilset", "-v", "1"], readConfigFiles=False, interruptible=False)
    try:
        if comm.rank == 0:
            gmsh_line(stations)
        mesh = mesh_from_gmsh(gmsh.model, comm, partitioner=_pieces(len(stations) - 1))[0]
    finally:
        gmsh.finalize()
    node = np.asarray(mesh.geometry.input_global_indices, dtype=np.int64)
    cells = geometry_dofs(mesh)
    element = node[cells].min(axis=1)
    # gmsh may hand the stations over with rounding of its own; take them as they were given
    mesh.geometry.x[:] = stations[node]
    return LineMesh(mesh, stations, node, element, mesh.topology.index_map(1).size_local)
