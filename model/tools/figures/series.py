"""Time series for ParaView: the centre line, the wire as a closed tube, and the section points; each in two formats."""

import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator
from pathlib import Path

import meshio
import numpy as np

from coilset.model.core.results.files.folder import subfolder, whole
from coilset.model.core.results.files.opened import Run
from coilset.model.tools.figures.vtkhdf import write_vtkhdf
from coilset.model.tools.figures.wire_surface import frames, section_points, tubes

PER_ELEMENT = 2  # rings of the tube
Series = Iterable[tuple[float, meshio.Mesh]]


def write_series(run: Run) -> list[Path]:
    """Write line, wire and sections in fields/, each as .vtkhdf and as .pvd with a file for each of its times.

    Times are numbers of steps; the section points are known at the start and where phases end.

    Returns:
        The six files.

    Raises:
        CoilsetError: if one cannot be written.
    """
    run.require_steps()
    folder = subfolder(run.folder, "fields")
    parts = {"line": _lines(run), "wire": _wires(run), "sections": _sections(run)}
    files = []
    for name, meshes in parts.items():
        series = list(meshes)
        files += [_write(folder, name, series), write_vtkhdf(folder / f"{name}.vtkhdf", series)]
    return files


def _lines(run: Run) -> Iterator[tuple[float, meshio.Mesh]]:
    """The stations, with the greatest shear on the surface of each element."""
    shown, n = frames(run), run.data.sizes["station"] - 1
    cells = [("line", np.stack([np.arange(n), np.arange(1, n + 1)], axis=1))]
    for time, x, shear in zip(_times(run), shown.x, shown.shear, strict=True):
        data = {"surface_shear_max_MPa": [np.abs(shear).max(axis=1).astype(float)]}
        yield time, meshio.Mesh(x, cells, cell_data=data)


def _wires(run: Run) -> Iterator[tuple[float, meshio.Mesh]]:
    """A closed surface: quadrilaterals around the wire and triangles over its tips."""
    shown = frames(run)
    rings = PER_ELEMENT * (run.data.sizes["station"] - 1) + 1
    places, stress = tubes(run, shown, rings)
    cells = tube_cells(rings, places.shape[2] - 1)
    for time, place, value in zip(_times(run), places, stress, strict=True):
        data = {"shear_MPa": value[:, :-1].ravel().astype(float)}
        yield time, meshio.Mesh(place[:, :-1].reshape(-1, 3), cells, point_data=data)


def tube_cells(rings: int, around: int) -> list[tuple[str, np.ndarray]]:
    """Cells of a closed tube with its points by rings: quadrilaterals, and triangles over the tips."""
    number = np.arange(rings * around).reshape(rings, around)
    following = np.roll(number, -1, axis=1)
    sides = np.stack([number[:-1], following[:-1], following[1:], number[1:]], axis=-1).reshape(-1, 4)
    fan = np.stack([np.zeros(around - 2, int), np.arange(2, around), np.arange(1, around - 1)], axis=-1)
    return [("quad", sides), ("triangle", np.concatenate([number[0][fan], number[-1][fan[:, ::-1]]]))]


def _sections(run: Run) -> Iterator[tuple[float, meshio.Mesh]]:
    """All section points, with the components of their state."""
    names, phase = [str(name) for name in run.data["component"].values], run.data["phase"].values
    ends = np.append(np.flatnonzero(np.diff(phase)), len(phase) - 1) if len(phase) else np.empty(0, int)
    times = [0.0, *run.data["step"].values[ends].astype(float)]
    for snapshot, time in enumerate(times[: run.data.sizes["snapshot"]]):
        places = section_points(run, snapshot).reshape(-1, 3)
        state = run.data["point_state"].values[snapshot].reshape(-1, len(names))
        cells = [("vertex", np.arange(len(places))[:, None])]
        yield time, meshio.Mesh(places, cells, point_data=dict(zip(names, state.T, strict=True)))


def _times(run: Run) -> list[float]:
    return [0.0, *run.data["step"].values.astype(float)] if "step_position" in run.data else [0.0]


def _write(folder: Path, name: str, series: Series) -> Path:
    """A file for each time, and the collection that names them (ParaView's .pvd)."""
    top = ET.Element("VTKFile", type="Collection", version="0.1")
    collection = ET.SubElement(top, "Collection")
    for number, (time, mesh) in enumerate(series):
        file = f"{name}-{number:04d}.vtu"
        with whole(folder / file) as path:
            meshio.write(path, mesh)
        ET.SubElement(collection, "DataSet", timestep=f"{time:g}", part="0", file=file)
    with whole(folder / f"{name}.pvd") as path:
        ET.ElementTree(top).write(path, encoding="utf-8", xml_declaration=True)
    return folder / f"{name}.pvd"
