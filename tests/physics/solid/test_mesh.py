import numpy as np
import pytest
import ufl
from dolfinx import fem
from mpi4py import MPI

from coilset.meshes.solids.solid import Helix, SectionGrid, coil_section, straight_wire
from coilset.model.core.base.errors import InputError
from coilset.model.physics.solid.configuration import Configuration


def sizes(wire):
    """Volume, and area of each named group."""
    mesh = wire.mesh
    one = fem.Constant(mesh, 1.0)
    ds = ufl.Measure("ds", domain=mesh, subdomain_data=wire.facet_tags)

    def total(measure):
        return mesh.comm.allreduce(fem.assemble_scalar(fem.form(one * measure)))

    return total(ufl.dx(domain=mesh)), {name: total(ds(tag)) for name, tag in wire.groups.items()}


@pytest.mark.mpi
def test_volume_and_areas_of_a_coil_section():
    # Pappus: a disk swept normal to its centre line has the volume πd²/4 L and the surface πd L; the surface elements
    # are parabolic, so the error falls with h⁴
    d, D, p, degrees = 5.0, 40.0, 12.0, 400.0
    length = np.radians(degrees) / (2 * np.pi) * np.hypot(np.pi * D, p)
    errors = []
    for n in (1, 2):
        wire = coil_section(d, D, p, degrees, 20 * n, MPI.COMM_WORLD, SectionGrid(2 * n, n))
        Configuration(wire.mesh)  # puts hexahedra into their 20-node form
        volume, areas = sizes(wire)
        exact = np.array([np.pi * d**2 / 4 * length, np.pi * d**2 / 4, np.pi * d**2 / 4, np.pi * d * length])
        errors.append(np.abs(np.array([volume, areas["bottom"], areas["top"], areas["surface"]]) / exact - 1))
    assert np.all(errors[1] < 3e-4)
    assert np.all(np.log2(errors[0] / errors[1]) > 3.5)


@pytest.mark.mpi
def test_volume_and_areas_of_a_tube():
    """Its parabolic edges are off by the fourth power of their angle: 5e-5 with 16 around."""
    d, hole, length, grid = 4.0, 0.6, 10.0, SectionGrid(4, 2, 0.6)
    wire = straight_wire(d, length, 3, MPI.COMM_WORLD, grid)
    Configuration(wire.mesh)
    volume, areas = sizes(wire)
    head = np.pi * d**2 / 4 * (1 - hole**2)
    found = [volume, areas["bottom"], areas["top"], areas["surface"]]
    np.testing.assert_allclose(found, [head * length, head, head, np.pi * d * (1 + hole) * length], rtol=1e-4)
    assert wire.mesh.topology.index_map(3).size_global == 3 * grid.cells


@pytest.mark.parametrize("hole", [-0.1, 1.0])
def test_a_hole_is_less_than_the_wire(hole):
    with pytest.raises(InputError, match="less than 1"):
        SectionGrid(hole=hole)


def test_frame_of_the_helix():
    helix = Helix(40.0, 12.0, 360.0)
    s = np.linspace(0, helix.length, 7)
    centre, outward, second, tangent = helix.frame(s)
    step = 1e-5
    assert np.allclose((helix.frame(s + step)[0] - helix.frame(s - step)[0]) / (2 * step), tangent, atol=1e-9)
    frame = np.stack([outward, second, tangent], axis=-1)
    assert np.allclose(np.swapaxes(frame, 1, 2) @ frame, np.eye(3), atol=1e-14)
    assert np.allclose(np.linalg.det(frame), 1.0)
    assert centre[-1] == pytest.approx([20.0, 0.0, 12.0])


def test_moving_the_mesh_is_exact_for_rigid_motion():
    wire = coil_section(5.0, 40.0, 12.0, 90.0, 4, MPI.COMM_WORLD, SectionGrid(2, 1))
    configuration = Configuration(wire.mesh)
    nodes = wire.mesh.geometry.x.copy()
    R = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    configuration.move(configuration.x @ R.T + [1.0, 2.0, 3.0])
    assert np.allclose(wire.mesh.geometry.x, nodes @ R.T + [1.0, 2.0, 3.0], atol=1e-12)


@pytest.mark.parametrize(
    ("call", "place"),
    [
        (lambda: coil_section(5.0, 4.0, 12.0, 90.0, 4, MPI.COMM_WORLD), "mean_diameter"),
        (lambda: coil_section(5.0, 40.0, 12.0, 0.0, 4, MPI.COMM_WORLD), "degrees"),
        (lambda: coil_section(5.0, 40.0, 12.0, np.inf, 4, MPI.COMM_WORLD), "degrees"),
        (lambda: coil_section(5.0, 40.0, np.nan, 90.0, 4, MPI.COMM_WORLD), "pitch"),
        (lambda: straight_wire(-5.0, 40.0, 4, MPI.COMM_WORLD), "diameter"),
        (lambda: straight_wire(5.0, 40.0, 0, MPI.COMM_WORLD), "layers"),
        (lambda: SectionGrid(0, 1), "grid"),
    ],
)
def test_impossible_meshes_are_refused(call, place):
    with pytest.raises(InputError, match=place):
        call()
