"""The line mesh of a spring as a file: gmsh's own format with named groups, and every format that meshio writes."""

import errno
import os
from pathlib import Path

import gmsh
import meshio
import numpy as np

from coilset.meshes.measured.measured import WIRE_DIAMETER
from coilset.meshes.springs.geometry import Spring
from coilset.model.core.base.errors import InputError

SURFACES = (".stl",)  # formats of surfaces, which hold no line elements


def check_format(path: str | Path) -> None:
    """Reject a file whose suffix names no mesh format, or one for surfaces, before anything is written.

    Raises:
        InputError: with a list of formats that can hold a wire.
    """
    suffix = Path(path).suffix.lower()
    if suffix != ".msh" and suffix not in meshio.extension_to_filetypes:
        named = f"'{suffix}' is no format of a mesh" if suffix else "has no suffix that gives its format"
        raise InputError(f"{named}; use .vtu, .msh, .inp or .xdmf", "--write", path)
    if suffix == ".msh" != Path(path).suffix:
        raise InputError("gmsh accepts lower-case suffixes only; give .msh", "--write", path)
    if suffix in SURFACES:
        raise InputError(f"{suffix} files hold no line elements; use .vtu, .msh, .inp or .xdmf", "--write", path)


def write_mesh(spring: Spring, turns: np.ndarray, path: str | Path) -> None:
    """Write the nodes on the centre line and the elements between them.

    If its format can hold data, the file contains the turn and the wire diameter of every node; if it can hold groups,
    it contains wire, bottom end, top end and end coils (the elements whose middle is in an end turn).

    Args:
        spring: `Spring`.
        turns: increasing turns of the nodes, shape (n + 1,).
        path: the file; its suffix determines the format.

    Raises:
        InputError: a suffix unknown to meshio, or a format without line elements.
        OSError: if the file cannot be written.
    """
    path = Path(path)
    points, data = spring.centre_line(turns), {"turn": turns, WIRE_DIAMETER: spring.wire_diameter(turns)}
    middle = 0.5 * (turns[1:] + turns[:-1])
    coil = np.where(middle < spring.bottom.end_turns, 0, np.where(middle > spring.turns - spring.top.end_turns, 2, 1))
    if path.suffix == ".msh":
        _write_gmsh(points, coil, data, path)
    else:
        _write_meshio(points, coil, data, path)


def _write_meshio(points: np.ndarray, coil: np.ndarray, data: dict[str, np.ndarray], path: Path) -> None:
    nodes = np.arange(len(points))
    lines = np.stack([nodes[:-1], nodes[1:]], axis=1)
    mesh = meshio.Mesh(points, [("line", lines)], point_data=data, cell_data={"end_coil": [(coil != 1).astype(int)]})
    options = {"data_format": "XML"} if path.suffix.lower() == ".xdmf" else {}
    if path.suffix.lower() == ".inp":  # Abaqus has sets instead of data, with names without spaces
        elements = {"wire": [nodes[:-1]], "end_coils": [nodes[:-1][coil != 1]]}
        mesh = meshio.Mesh(
            points, [("line", lines)], cell_sets=elements, point_sets={"bottom_end": nodes[:1], "top_end": nodes[-1:]}
        )
    try:
        mesh.write(path, **options)
        kept = sum(len(block.data) for block in meshio.read(path).cells if block.type == "line")
    except (
        meshio.WriteError,
        meshio.ReadError,
        KeyError,
        ValueError,
        AssertionError,
        ImportError,
        SystemExit,
    ) as error:
        path.unlink(missing_ok=True)
        reason = " ".join(str(error).split()) or type(error).__name__
        raise InputError(
            f"meshio cannot write the wire in this format: {reason}; use .vtu, .msh, .inp or .xdmf", "", path
        ) from None
    if kept != len(lines):
        path.unlink()
        raise InputError(f"{path.suffix} files hold no line elements; use .vtu, .msh, .inp or .xdmf", "", path)


def _write_gmsh(points: np.ndarray, coil: np.ndarray, data: dict[str, np.ndarray], path: Path) -> None:
    """The model has one curve for the body and one for each closed end; the group wire comprises them all."""
    started = gmsh.isInitialized()
    if not started:
        gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("PostProcessing.SaveMesh", 0)  # the data are appended to a file that has the mesh already
        gmsh.model.add("spring")
        tags = np.arange(1, len(points) + 1)
        curves = {part: gmsh.model.addDiscreteEntity(1) for part in np.unique(coil).tolist()}
        gmsh.model.mesh.addNodes(1, curves[1], tags, points.ravel())
        for part, curve in curves.items():
            elements = tags[:-1][coil == part]
            gmsh.model.mesh.addElementsByType(curve, 1, elements, np.stack([elements, elements + 1], axis=1).ravel())
        gmsh.model.addPhysicalGroup(1, list(curves.values()), name="wire")
        ends = [curve for part, curve in curves.items() if part != 1]
        if ends:
            gmsh.model.addPhysicalGroup(1, ends, name="end coils")
        for name, node in (("bottom end", tags[0]), ("top end", tags[-1])):
            point = gmsh.model.addDiscreteEntity(0)
            gmsh.model.mesh.addElementsByType(point, 15, [tags[-1] + point], [node])
            gmsh.model.addPhysicalGroup(0, [point], name=name)
        with open(path, "wb"):  # where a file cannot be written, gmsh raises an exception without the reason
            pass
        gmsh.write(str(path))
        for name, values in data.items():
            view = gmsh.view.add(name)
            gmsh.view.addModelData(view, 0, "spring", "NodeData", tags, values[:, None].tolist())
            gmsh.view.write(view, str(path), append=True)
            gmsh.view.remove(view)
        _check_end(path)
    finally:
        gmsh.model.remove()
        if not started:
            gmsh.finalize()


def _check_end(path: Path) -> None:
    """Reject a truncated file: gmsh reports nothing if the disk is full."""
    with open(path, "rb") as file:
        end = file.seek(0, os.SEEK_END)
        file.seek(max(end - 32, 0))
        if not file.read().rstrip().endswith(b"$EndNodeData"):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
