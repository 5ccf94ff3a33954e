"""Fields of the solid for ParaView, and pictures of them."""

from collections.abc import Mapping
from pathlib import Path

import basix
import dolfinx.plot
import numpy as np
import pyvista

from coilset.model.core.base.compat import geometry_dofs
from coilset.model.core.base.style import QUARTERED, colour_bar, round_end
from coilset.model.core.results.files.grid_file import write_grid
from coilset.model.core.results.files.png_file import write
from coilset.model.physics.solid.continuum import mises
from coilset.model.physics.solid.solid import Solid


def at_nodes(solid: Solid, values: np.ndarray) -> np.ndarray:
    """Extrapolate values of the integration points to the geometry nodes of this rank, averaged over its cells.

    A cell's nodal values stay within the range of its points: beyond it, the yield condition need not hold.

    Args:
        values: shape (owned cells, points, …).

    Returns:
        Shape (nodes, …).
    """
    mesh = solid.wire.mesh
    linear = basix.create_element(basix.ElementFamily.P, mesh.basix_cell(), 1)
    nodes = mesh.ufl_domain().ufl_coordinate_element().basix_element.points
    to_points, to_nodes = (linear.tabulate(0, at)[0, :, :, 0] for at in (solid.forms.points, nodes))
    carried = np.einsum("nq,cq...->cn...", to_nodes @ np.linalg.inv(to_points), values)
    carried = np.clip(carried, values.min(axis=1, keepdims=True), values.max(axis=1, keepdims=True))
    dofs = geometry_dofs(mesh)[: solid.n_cells]
    total = np.zeros((len(mesh.geometry.x), *values.shape[2:]))
    np.add.at(total, dofs, carried)
    count = np.bincount(dofs.ravel(), minlength=len(total))
    return total / np.maximum(count, 1).reshape(-1, *[1] * (values.ndim - 2))


def grid(solid: Solid) -> pyvista.UnstructuredGrid | None:
    """The deformed body with its fields, as a pyvista grid on the first rank and None on the others.

    Fields at the nodes: `displacement` (mm), `stress` (11, 22, 33, 12, 13, 23, MPa, axes of space), `von Mises stress`
    (MPa), `plastic work` b* (N/mm²).
    """
    mesh = solid.wire.mesh
    cells, kinds, x = dolfinx.plot.vtk_mesh(mesh)
    data = {
        "displacement": mesh.geometry.x - solid.configuration.start,
        "stress": at_nodes(solid, solid.point_state[..., :6]),
        "von Mises stress": at_nodes(solid, mises(solid.point_state[..., :6])),
        "plastic work": at_nodes(solid, solid.point_state[..., 12]),
    }
    parts = solid.comm.gather((cells, kinds, x.copy(), data))
    if parts is None:
        return None
    pieces = []
    for cells, kinds, x, data in parts:
        piece = pyvista.UnstructuredGrid(cells, kinds, x)
        for name, values in data.items():
            piece.point_data[name] = values
        pieces.append(piece)
    return pieces[0] if len(pieces) == 1 else pyvista.merge(pieces)


def write_fields(path: str | Path, solid: Solid) -> None:
    """Write the fields of `grid` to a .vtu file for ParaView; collective."""
    body = grid(solid)
    if body is not None:
        write_grid(path, body)


def picture(path: str | Path, bodies: Mapping[str, pyvista.DataSet], field: str, unit: str) -> None:
    """Draw the far halves (y > 0) of bodies side by side, coloured by a field; the cut shows their sections.

    Needs a display, see `coilset.model.tools.figures.display`.

    Args:
        path: PNG file.
        bodies: name → grid of `grid`.
        field, unit: name of the field, and its unit for the colour bar.
    """
    end = round_end(max(float(body.point_data[field].max()) for body in bodies.values()), QUARTERED)
    size = 720 * len(bodies), 470
    plotter = pyvista.Plotter(off_screen=True, shape=(1, len(bodies)), window_size=size, border=False)
    plotter.set_background("white")
    for column, (name, body) in enumerate(bodies.items()):
        plotter.subplot(0, column)
        half = body.tessellate(max_n_subdivide=2).clip(normal=(0, -1, 0), origin=(0, 1e-3, 0))
        half = half.connectivity("largest")  # without the part of the turn's other end on this side
        bar = colour_bar(f"{field} in {unit}", (22, 18), (0.2, 0.6), (0.02, 0.16))
        plotter.add_mesh(half, scalars=field, clim=(0.0, end), cmap="viridis", ambient=0.3, scalar_bar_args=bar)
        plotter.add_text(name, position=(0.42, 0.9), viewport=True, font_size=13, color="black")
        plotter.camera.parallel_projection = True
        plotter.view_vector((0.1, -1.0, 0.6), viewup=(0, 0, 1))
        plotter.camera.zoom(1.6)
    write(path, plotter.screenshot(return_img=True), "; ".join(bodies))
    plotter.close()
