"""What differs between DOLFINx 0.9 and 0.11, probed once at import; everything else is written against 0.9."""

import dolfinx.io

# 0.10 renamed the module and returns a named tuple in place of a triple; both begin with mesh, cell tags, facet tags.
_gmsh = dolfinx.io.gmsh if hasattr(dolfinx.io, "gmsh") else dolfinx.io.gmshio


def mesh_from_gmsh(model, comm, rank=0, gdim=3, partitioner=None):
    """Distribute the mesh of a gmsh model; returns mesh, cell tags, facet tags (of the `wire` of a line: its ends)."""
    data = _gmsh.model_to_mesh(model, comm, rank, gdim=gdim, partitioner=partitioner)
    if hasattr(data, "mesh"):
        return data.mesh, data.cell_tags, data.facet_tags
    return data[0], data[1], data[2]
