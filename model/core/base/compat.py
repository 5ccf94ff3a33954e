"""Differences between DOLFINx 0.9 and 0.11 and their PETSc, probed once at import; all other code targets 0.9."""

import inspect
from collections.abc import Callable
from typing import Any

import dolfinx.graph
import dolfinx.io
import dolfinx.mesh
import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

# 0.10 renamed the module and returns a named tuple in place of a triple; both begin with mesh, cell tags, facet tags.
_gmsh = dolfinx.io.gmsh if hasattr(dolfinx.io, "gmsh") else dolfinx.io.gmshio
# 0.11 requires the number of cells that may meet at a facet.
_LINKS = (2,) if "max_facet_to_cell_links" in inspect.signature(dolfinx.mesh.create_cell_partitioner).parameters else ()
_Reason = PETSc.SNES.ConvergedReason

# Maximum length of a step of a line search: 3.24 renamed the option, and lowered its default from 1e8 to 1.
LONGEST_STEP = "snes_linesearch_maxlambda" if PETSc.Sys.getVersion() >= (3, 24) else "snes_linesearch_maxstep"
# PETSc 3.25 renamed the reason for a residual that is not a number.
NOT_A_NUMBER: int = getattr(_Reason, "DIVERGED_FNORM_NAN", None) or _Reason.DIVERGED_FUNCTION_NANORINF


def mesh_from_gmsh(
    model: Any, comm: MPI.Comm, rank: int = 0, gdim: int = 3, partitioner: Callable | None = None
) -> tuple[dolfinx.mesh.Mesh, dolfinx.mesh.MeshTags, dolfinx.mesh.MeshTags]:
    """Distribute the mesh of a gmsh model; returns mesh, cell tags, facet tags (of the `wire` of a line: its ends)."""
    data = _gmsh.model_to_mesh(model, comm, rank, gdim=gdim, partitioner=partitioner)
    if hasattr(data, "mesh"):
        return data.mesh, data.cell_tags, data.facet_tags
    return data[0], data[1], data[2]


def unghosted() -> Callable:
    """Partitioner for a mesh whose ranks share no cells."""
    return dolfinx.mesh.create_cell_partitioner(dolfinx.mesh.GhostMode.none, *_LINKS)


def to_ranks(ranks: np.ndarray) -> Any:
    """The result of a partitioner: the rank of each cell, shape (cells,); 0.10 renamed and wrapped it."""
    graph: Any = dolfinx.graph
    make = getattr(graph, "adjacencylist", None) or graph.adjacency_list
    found = make(ranks.astype(np.int32)[:, None])
    return getattr(found, "_cpp_object", found)


def geometry_dofs(mesh: dolfinx.mesh.Mesh) -> np.ndarray:
    """Nodes of the cells, shape (cells, nodes of a cell); 0.11 has one such array for each kind of cell."""
    geometry = mesh.geometry
    return geometry.dofmaps[0] if hasattr(geometry, "dofmaps") else geometry.dofmap


def interpolation_points(space: Any) -> np.ndarray:
    """Points of the reference cell where functions of this space are evaluated; a method up to 0.9, then a property."""
    points = space.element.interpolation_points
    return points() if callable(points) else points
