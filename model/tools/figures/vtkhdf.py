"""Time series as one VTKHDF file, which ParaView 5.12 and VTK 9.3 read (VTKHDF 2.0, UnstructuredGrid with Steps)."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import h5py
import meshio
import numpy as np

from coilset.model.core.results.files.folder import whole

CELLS = {"vertex": 1, "line": 3, "triangle": 5, "quad": 9}  # numbers of VTK


def write_vtkhdf(path: Path, series: Sequence[tuple[float, meshio.Mesh]]) -> Path:
    """Write meshes with the same cells, each with its time; points and data may change.

    Args:
        path: of the file, `.vtkhdf`.
        series: times and meshes; all have data of the same names.

    Raises:
        CoilsetError: if it cannot be written.
    """
    times, meshes = [time for time, _ in series], [mesh for _, mesh in series]
    first, steps = meshes[0], len(meshes)
    connectivity = np.concatenate([block.data.ravel() for block in first.cells])
    sizes = np.concatenate([np.full(len(block.data), block.data.shape[1]) for block in first.cells])
    types = np.concatenate([np.full(len(block.data), CELLS[block.type], np.uint8) for block in first.cells])
    with whole(path) as partial, h5py.File(partial, "w") as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = [2, 0]
        root.attrs.create("Type", b"UnstructuredGrid", dtype=h5py.string_dtype("ascii", len("UnstructuredGrid")))
        root["NumberOfPoints"], root["NumberOfCells"] = [len(first.points)], [len(types)]
        root["NumberOfConnectivityIds"] = [len(connectivity)]
        root["Connectivity"], root["Types"] = connectivity.astype(np.int64), types
        root["Offsets"] = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
        root["Points"] = np.concatenate([mesh.points for mesh in meshes])
        places = root.create_group("Steps")  # where the values of each time begin; cells are those of all
        places.attrs["NSteps"] = steps
        places["Values"] = np.array(times, float)
        nothing, along = np.zeros(steps, np.int64), np.arange(steps, dtype=np.int64)
        places["NumberOfParts"], places["PartOffsets"] = nothing + 1, nothing
        places["PointOffsets"] = along * len(first.points)
        places["CellOffsets"] = places["ConnectivityIdOffsets"] = nothing[:, None]
        for kind, names in (("Point", first.point_data), ("Cell", first.cell_data)):
            data, offsets = root.create_group(f"{kind}Data"), places.create_group(f"{kind}DataOffsets")
            for name in names:
                values = [_values(mesh, kind, name) for mesh in meshes]
                data[name], offsets[name] = np.concatenate(values), along * len(values[0])
    return path


def _values(mesh: meshio.Mesh, kind: str, name: str) -> Any:
    return mesh.point_data[name] if kind == "Point" else np.concatenate(mesh.cell_data[name])
